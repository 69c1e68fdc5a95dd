// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/conformance.hpp"

#include <algorithm>

#include "kit/conformance/check_in_child.hpp"
#include "kit/conformance/check_list.hpp"
#include "kit/conformance/groups.hpp"

namespace weft::conformance {
namespace {

constexpr std::string_view kGeometry = "geometry";  ///< for components that owe it, or by name
constexpr const char* kSkips = "skips";  ///< the name of no check, for why there are none

/// The first check of a group.
std::string first_of(const std::string& group) {
  for (const CheckInfo& info : all_checks()) {
    if (info.name.starts_with(group + "/")) return info.name;
  }
  return group;
}

/// True if any of its checks is requested.
bool is_asked_for(const Group& group, const Candidate& candidate, const Choice& choice) {
  const std::string prefix = std::string(group.name) + "/";
  if (!choice.only.empty()) return choice.only == group.name || choice.only.starts_with(prefix);
  if (group.name == kGeometry && !candidate.geometry) return false;
  const auto& all = all_checks();
  return !choice.brief || std::any_of(all.begin(), all.end(), [&](const CheckInfo& info) {
    return info.brief && info.name.starts_with(prefix);
  });
}

/// The reason why it can be loaded but not called: it lacks a device. Queried in a separate
/// process, because only the library can detect its device.
std::string lack_of_device(const Setting& setting) {
  const auto& extensions = setting.candidate.installed()->component.extensions;
  if (std::find(extensions.begin(), extensions.end(), WEFT_DEVICES) == extensions.end()) return "";
  const auto findings =
      check_in_child(kSkips, {}, std::chrono::seconds(60), [&](Notebook& notebook) {
        notebook.check(kSkips, [&](Page& page) {
          const auto play = Play::of(setting);
          if (!play) return;
          const std::string lack = testing::lacks_device((*play)->subject());
          if (!lack.empty()) page.skip(lack);
        });
      });
  const bool lacks = !findings.empty() && findings.front().verdict == Verdict::does_not_apply;
  return lacks ? findings.front().seen : "";
}

/// True if a required parameter is missing.
bool lacks_parameters(const Candidate& candidate) {
  if (candidate.params != "{}") return false;
  const auto& parameters = candidate.installed()->component.parameters;
  return std::any_of(parameters.begin(), parameters.end(),
                     [](const host::ParameterSpec& each) { return each.required; });
}

/// A failing check that the page lists is a deviation. A listed check that holds is a failure, and
/// so is a listed name that is no check.
void apply_deviations(const std::vector<std::string>& known, std::vector<Finding>& findings) {
  for (const std::string& deviation : known) {
    const std::string name = as_name(deviation);
    const auto is_it = [&](const std::string& check) {
      return check == name || check.ends_with("/" + name);
    };
    const auto& all = all_checks();
    const bool is_check = name.starts_with("without_") ||
                          std::any_of(all.begin(), all.end(),
                                      [&](const CheckInfo& info) { return is_it(info.name); });
    if (!is_check) {
      findings.push_back(
          {name, Verdict::fails, "is declared as a deviation, and there is no such check"});
    }
    for (Finding& finding : findings) {
      if (!is_it(finding.check) || !is_check) continue;
      const bool occurs = finding.verdict == Verdict::fails;
      finding.verdict = occurs ? Verdict::deviates : Verdict::fails;
      if (!occurs) finding.seen = "is declared as a deviation, and passes";
    }
  }
}

}  // namespace

const std::vector<Group>& all_groups() {
  using std::chrono::seconds;
  static const std::vector<Group> all = {
      {"load", "the library as a file, and what loading it does", &check_load, seconds(60), false},
      {"table", "the component's own description, and other hosts", &check_table, seconds(60)},
      {"parameters", "legal and illegal values", &check_parameters, seconds(120)},
      {"contract", "the contract of its role", &check_contract, seconds(120)},
      {"geometry", "the laws of geometry", &check_geometry, seconds(240)},
      {"calls", "the same answers, however it is called", &check_calls, seconds(120)},
      {"limits", "what it takes, and what it leaves as it was", &check_limits, seconds(120)},
  };
  return all;
}

std::size_t Report::count(Verdict verdict) const {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(),
                    [&](const Finding& finding) { return finding.verdict == verdict; }));
}

Report check(const Candidate& candidate, const Choice& choice) {
  Report report{candidate.id, candidate.id, candidate.skipped, {}};
  if (!candidate.refusal.empty()) {
    report.findings.push_back({"load/binds_now", Verdict::fails, candidate.refusal});
    return report;
  }
  report.library = candidate.installed()->library->library;
  const Setting setting(candidate);
  if (report.skipped.empty() && lacks_parameters(candidate)) {
    report.skipped = "needs parameters, such as --params \"{" +
                     candidate.installed()->component.parameters.front().name + ": VALUE}\"";
  }
  if (report.skipped.empty()) report.skipped = lack_of_device(setting);
  for (const Group& group : all_groups()) {
    if (!is_asked_for(group, candidate, choice) || (group.calls && !report.skipped.empty()))
      continue;
    auto findings = check_in_child(first_of(group.name), choice, group.longest,
                                   [&](Notebook& notebook) { group.make(setting, notebook); });
    std::move(findings.begin(), findings.end(), std::back_inserter(report.findings));
  }
  apply_deviations(candidate.deviations, report.findings);
  return report;
}

bool is_known(const std::string& group_or_check) {
  const auto& groups = all_groups();
  return find_check(group_or_check) != nullptr ||
         std::any_of(groups.begin(), groups.end(),
                     [&](const Group& group) { return group.name == group_or_check; });
}

}  // namespace weft::conformance
