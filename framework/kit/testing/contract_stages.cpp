// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/contract_stages.hpp"

#include <atomic>
#include <chrono>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "host/calling/hashing.hpp"
#include "kit/testing/contract_outputs.hpp"

namespace weft::testing {
namespace {

constexpr double kLongestWait_s = 10.0;

std::vector<std::uint64_t> contents_of(const std::vector<Input>& inputs) {
  std::vector<std::uint64_t> contents;
  for (const Input& given : inputs) contents.push_back(host::content_revision(*given.record));
  return contents;
}

Answer ask(Performer& performer, const Case& given) {
  return performer.call(kRunStage, given.inputs, 7);
}

void check_status(const Subject& subject, const Case& given, const Answer& answer, Checks& checks) {
  check_answer(answer, checks);
  if (given.expect == Expect::answer && !answer.is_usable()) {
    checks.fail("reports " + to_text(answer) + ", not ok or degenerate");
  }
  if (answer.status != WEFT_OK) return;
  if (given.expect != Expect::answer && is_nothing(answer))
    checks.fail("reports ok without an output");
  const RoleRules& rules = subject.rules();
  const bool needs_evidence = rules.marks || rules.samples || rules.solves;
  if (given.expect == Expect::warning && needs_evidence) {
    checks.fail("reports ok without evidence");
  }
}

/// All cases, each on a new instance.
std::vector<Answer> ask_fresh(const Subject& subject, const std::vector<Case>& cases,
                              Checks& checks) {
  std::vector<Answer> answers;
  for (const Case& given : cases) {
    checks.begin(given.name);
    Performer performer(subject);
    Answer answer;
    if (auto ready = performer.begin(given.scene.templ, given.scene.camera); !ready) {
      answer = {WEFT_ERROR, ready.error().code, ready.error().message, {}};
    } else {
      const auto before = contents_of(given.inputs);
      answer = ask(performer, given);
      checks.expect(contents_of(given.inputs) == before, "it changes its input");
    }
    check_status(subject, given, answer, checks);
    if (answer.is_usable()) check_outputs(subject, given, answer, checks);
    answers.push_back(std::move(answer));
  }
  return answers;
}

/// The same cases in two other orders, all on one instance.
void check_history(const Subject& subject, const std::vector<Case>& cases,
                   const std::vector<Answer>& fresh, Checks& checks) {
  checks.begin("after other calls");
  Performer performer(subject);
  if (!performer.begin(cases.front().scene.templ, cases.front().scene.camera)) return;
  std::vector<std::size_t> order(cases.size());
  std::iota(order.begin(), order.end(), 0);
  Rng rng(subject.seed);
  for (int round = 0; round < 2; ++round) {
    rng.shuffle(order);
    for (const std::size_t i : order) {
      const std::string how = difference(ask(performer, cases[i]), fresh[i]);
      if (!how.empty())
        checks.fail(cases[i].name + ", " + how + " from the answer of a new instance");
    }
  }
}

}  // namespace

void check_cancelling(const Subject& subject, const Scene& scene, const AskFor& begin,
                      const AskFor& asked, Checks& checks) {
  checks.begin("when it is told to stop");
  using Clock = std::chrono::steady_clock;
  const auto fresh_answer = [&](Performer& performer) {
    if (auto ready = performer.begin(scene.templ, scene.camera); !ready) {
      return Answer{WEFT_ERROR, ready.error().code, ready.error().message, {}};
    }
    return begin ? begin(performer) : Answer{};
  };
  Performer first(subject);
  if (!fresh_answer(first).is_usable()) return;
  const Answer whole = asked(first);
  for (const int times : {0, 1, 3, 30}) {
    Performer performer(subject);
    if (!fresh_answer(performer).is_usable()) return checks.fail("cannot begin again");
    std::atomic<int> left = times;
    if (times == 0) performer.cancel() = true;
    performer.watch([&] { return left-- <= 0; });
    const auto start = Clock::now();
    const Answer stopped = asked(performer);
    const double took_s = std::chrono::duration<double>(Clock::now() - start).count();
    checks.expect(took_s < kLongestWait_s, "it goes on for more than 10 s");
    const bool finished = stopped.status == whole.status &&
                          (!subject.is_exact() || difference(stopped, whole).empty());
    if (stopped.status != WEFT_CANCELLED && !finished) {
      checks.fail("it reports " + to_text(stopped) + " and neither stops nor ends its work");
    }
    performer.cancel() = false;
    performer.watch({});
    const Answer after = asked(performer);
    const std::string how = subject.is_exact() ? difference(after, whole) : "";
    if (!how.empty()) checks.fail("called again, " + how + " from the answer of a new instance");
  }
}

void check_stage(const Subject& subject, Checks& checks) {
  const std::vector<Case> cases = cases_of(subject);
  const std::vector<Answer> fresh = ask_fresh(subject, cases, checks);
  if (subject.is_exact()) check_history(subject, cases, fresh, checks);
  const Case& usual = cases.front();
  check_cancelling(
      subject, usual.scene, {}, [&](Performer& p) { return ask(p, usual); }, checks);
}

}  // namespace weft::testing
