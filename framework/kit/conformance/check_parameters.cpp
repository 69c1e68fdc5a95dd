// SPDX-License-Identifier: Apache-2.0
// Values of parameters: those that are declared, those that are not, and many at once.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "host/calling/hashing.hpp"
#include "kit/conformance/check_in_child.hpp"
#include "kit/conformance/groups.hpp"
#include "kit/conformance/probes/parameter_values.hpp"
#include "kit/conformance/probes/processor_time.hpp"

namespace weft::conformance {
namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

// CPU time.
constexpr Milliseconds kLongestCalls{300.0};  ///< with one choice of values
constexpr Milliseconds kLongestPairs{20'000.0}, kLongestEnds{30'000.0};
constexpr int kPairs = 200, kLive = 3;

/// The answers of a component with these parameters, or their refusal. Calls are cancelled after a
/// while, because some values cause much work.
struct Tried {
  std::vector<Answer> answers;
  std::string mistake;  ///< description of the first illegal answer; empty if there is none
};

Tried try_out(const Setting& setting, const yaml::Node& params) {
  Tried tried;
  const auto play = Play::of(setting, &params);
  if (!play) return tried;  // refused, with a reason
  Performer performer((*play)->subject());
  const Budget budget(kLongestCalls);
  performer.watch([&] { return budget.is_over(); });
  const Answer begun = (*play)->begin(performer);
  tried.answers.push_back(begun);
  if (begun.is_usable() && !budget.is_over()) tried.answers.push_back((*play)->frame(performer, 0));
  for (const Answer& answer : tried.answers) {
    const bool stopped = answer.status == WEFT_CANCELLED || answer.code == Errc::cancelled;
    if (stopped) continue;
    const std::string mistake = (*play)->mistake_in(answer, 0);
    if (!mistake.empty()) tried.mistake = mistake;
  }
  return tried;
}

void check_defaults(const host::ComponentManifest& manifest, Page& page) {
  for (const host::ParameterSpec& parameter : manifest.parameters) {
    const std::string mistake = default_mistake(parameter);
    if (!mistake.empty()) page.fail(parameter.name + ": " + mistake);
  }
}

void check_ends(const Setting& setting, const yaml::Node& base, double effort, Page& page) {
  const auto& parameters = setting.candidate.installed()->component.parameters;
  const Budget budget(effort * kLongestEnds);
  int made = 0, left = 0;
  for (const host::ParameterSpec& parameter : parameters) {
    for (const yaml::Node& value : end_values(parameter)) {
      if (budget.is_over()) {
        ++left;
        continue;
      }
      ++made;
      const Tried tried = try_out(setting, with(base, parameter.name, value));
      if (!tried.mistake.empty()) {
        page.fail(fmt::format("with {}: {}, {}", parameter.name, value.scalar, tried.mistake));
      }
    }
  }
  if (made == 0) return page.skip("no parameter is a number with ends, a flag or a choice");
  page.note_count(made, made + left, "values");
}

/// Checks the answer of create to values that the host would never pass on.
void check_refusal(const weft_component& component, const Illegal& illegal, Page& page) {
  void* self = nullptr;
  weft_error error = kNoError;
  const weft_create create = host::made_from(illegal.arguments.values());
  const std::int32_t status = component.create(&create, &self, &error);
  if (status == WEFT_OK && self != nullptr) component.destroy(self);
  page.expect(status == WEFT_ERROR,
              fmt::format("{} = {} is accepted: read it by Params, or compare it with its range",
                          illegal.parameter, illegal.what));
  if (status != WEFT_ERROR) return;
  page.expect(error.subject == illegal.parameter,
              fmt::format("{} = {} is refused and weft_error.subject is '{}', not its name",
                          illegal.parameter, illegal.what, error.subject));
}

void check_unknown(const Setting& setting, const weft_component& component, Page& page) {
  const auto play = Play::of(setting);
  if (!play) return page.skip("its parameters are refused");
  if (!(*play)->subject().spec().nested.empty()) return page.skip("it holds other components");
  host::Arguments more;
  more.add_number("x_no_such_parameter", 1.0);
  std::vector<weft_value> values = (*play)->subject().spec().arguments.values();
  values.insert(values.begin(), more.values().begin(), more.values().end());
  void* self = nullptr;
  weft_error error = kNoError;
  const weft_create create = host::made_from(values);
  const std::int32_t status = component.create(&create, &self, &error);
  if (status == WEFT_OK && self != nullptr) component.destroy(self);
  const bool named = std::strstr(error.message, "x_no_such_parameter") != nullptr ||
                     std::strstr(error.subject, "x_no_such_parameter") != nullptr;
  page.expect(status == WEFT_OK || named,
              fmt::format("a value of a name that it does not know makes it fail ({}): ignore it",
                          error.message));
}

void check_pairs(const Setting& setting, const yaml::Node& base, double effort, Page& page) {
  std::vector<const host::ParameterSpec*> open;
  for (const auto& parameter : setting.candidate.installed()->component.parameters) {
    if (can_draw(parameter)) open.push_back(&parameter);
  }
  if (open.empty()) return page.skip("no parameter is a number, a flag or a choice");
  Rng rng(setting.candidate.seed);
  const Budget budget(effort * kLongestPairs);
  int made = 0;
  for (; made < kPairs && !budget.is_over(); ++made) {
    yaml::Node params = base;
    std::string text;
    for (int which = 0; which < 2; ++which) {
      const auto& parameter = *open[rng.below(static_cast<std::uint32_t>(open.size()))];
      const yaml::Node value = draw(parameter, rng);
      params = with(params, parameter.name, value);
      text += (text.empty() ? "" : ", ") + parameter.name + ": " + value.scalar;
    }
    const Tried tried = try_out(setting, params);
    if (!tried.mistake.empty()) page.fail("with {" + text + "}: " + tried.mistake);
  }
  page.note_count(made, kPairs, "pairs");
}

/// A short text of an answer, such that two can be compared.
std::string digest(const Answer& answer) {
  std::string text = fmt::format("reports {}", to_text(answer));
  for (const auto& [slot, record] : answer.outputs) {
    text += fmt::format(", {} {:x}", slot, host::content_revision(*record));
  }
  return text;
}

/// The digest of an answer in a fresh process, without earlier calls; empty if that is unknown.
std::string digest_in_child(const std::function<Answer()>& ask) {
  const auto findings =
      check_in_child("digest", {}, std::chrono::seconds(60), [&](Notebook& notebook) {
        notebook.check("digest", [&](Page& page) {
          const Answer answer = ask();
          if (answer.status != WEFT_CANCELLED) page.note(digest(answer));
        });
      });
  const bool holds = findings.size() == 1 && findings.front().verdict == Verdict::holds;
  return holds ? findings.front().seen : "";
}

/// One parameter that is set between two frames, against an instance that was made with it.
void check_set(const Setting& setting, const yaml::Node& base, const host::ParameterSpec& parameter,
               Rng& rng, Page& page) {
  const yaml::Node params = with(base, parameter.name, draw(parameter, rng));
  const auto before = Play::of(setting), after = Play::of(setting, &params);
  if (!before || !after || !(*after)->subject().is_exact()) return;
  const auto watched = [](Performer& performer) {
    performer.watch([budget = Budget(kLongestCalls)] { return budget.is_over(); });
  };
  const auto stopped = [] { return Answer{WEFT_CANCELLED, Errc::cancelled, "", {}}; };
  const std::string expected = digest_in_child([&] {
    Performer fresh((*after)->subject());
    watched(fresh);
    const Answer ready = (*after)->begin(fresh);
    return ready.is_usable() ? (*after)->frame(fresh, 1) : stopped();
  });
  const std::string given = digest_in_child([&] {
    Performer set((*before)->subject());
    watched(set);
    if (!(*before)->begin(set).is_usable()) return stopped();
    (*before)->frame(set, 0);
    const Scene& scene = (*after)->scene();
    if (!set.replace((*after)->subject(), scene.templ, scene.camera)) return stopped();
    return (*after)->open(set).is_usable() ? (*after)->frame(set, 1) : stopped();
  });
  page.expect(expected.empty() || given.empty() || given == expected,
              fmt::format("{} set between two frames: it {}, and a new instance {}; keep nothing "
                          "outside the instance",
                          parameter.name, given, expected));
}

void check_live(const Setting& setting, const yaml::Node& base, Page& page) {
  const auto& component = setting.candidate.installed()->component;
  if (component.determinism != "exact") return page.skip("its answers differ by rounding");
  Rng rng(setting.candidate.seed);
  int tried = 0;
  for (const host::ParameterSpec& parameter : component.parameters) {
    if (!can_draw(parameter) || tried == kLive) continue;
    ++tried;
    check_set(setting, base, parameter, rng, page);
  }
  if (tried == 0) page.skip("no parameter is a number, a flag or a choice");
}

}  // namespace

void check_parameters(const Setting& setting, Notebook& notebook) {
  const host::Installed& entry = *setting.candidate.installed();
  const auto loaded = host::load(entry);
  const auto base = parsed_params(setting.candidate.params);
  if (!loaded || !base) return;  // reported by another check
  const double effort = notebook.choice().effort;
  // The first one, for it wants a process in which nothing has been called.
  notebook.check("parameters/live", [&](Page& page) { check_live(setting, *base, page); });
  notebook.check("parameters/defaults", [&](Page& page) { check_defaults(entry.component, page); });
  notebook.check("parameters/beyond", [&](Page& page) {
    const std::vector<Illegal> all = beyond_range(entry.component);
    for (const Illegal& illegal : all) check_refusal(**loaded, illegal, page);
    if (all.empty()) page.skip("no parameter has a range or choices");
  });
  notebook.check("parameters/wrong_type", [&](Page& page) {
    const std::vector<Illegal> all = wrong_types(entry.component);
    for (const Illegal& illegal : all) check_refusal(**loaded, illegal, page);
    if (all.empty()) page.skip("it has no parameter");
  });
  notebook.check("parameters/unknown", [&](Page& page) { check_unknown(setting, **loaded, page); });
  notebook.check("parameters/ends", [&](Page& page) { check_ends(setting, *base, effort, page); });
  notebook.check("parameters/pairs",
                 [&](Page& page) { check_pairs(setting, *base, effort, page); });
}

}  // namespace weft::conformance
