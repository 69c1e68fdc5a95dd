// SPDX-License-Identifier: Apache-2.0
// Checks of several components at once.
#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>

#include "kit/conformance/check_in_child.hpp"
#include "kit/conformance/conformance.hpp"
#include "process/child.hpp"

namespace weft::conformance {
namespace {

constexpr const char* kSkipped = "skipped";  ///< the name of no check, for Report::skipped

std::unique_ptr<process::Child> start(const Candidate& candidate, const Choice& choice) {
  auto started = process::Child::start(
      process::Copy{.work =
                        [&](int notes) {
                          Notebook notebook(notes, choice);
                          const Report report = check(candidate, choice);
                          notebook.add({kSkipped, Verdict::does_not_apply, report.skipped});
                          for (const Finding& finding : report.findings) notebook.add(finding);
                          return 0;
                        },
                    .out = process::kMemory,
                    .err = process::kMemory});
  if (!started) throw std::runtime_error(started.error().message);
  return *std::move(started);
}

/// The report that an ended process has written.
Report report_of(const Candidate& candidate, process::Child& child) {
  child.read();
  Report report{candidate.id, candidate.id, "", {}};
  if (const host::Installed* installed = candidate.installed(); installed != nullptr) {
    report.library = installed->library->library;
  }
  for (Finding& finding : read_notes(child.out()).findings) {
    if (finding.check == kSkipped) {
      report.skipped = finding.seen;
    } else {
      report.findings.push_back(std::move(finding));
    }
  }
  const process::Ending ending = child.end();
  if (ending.signal != 0 || ending.exit_code != 0) {
    report.findings.push_back(
        {"load/binds_now", Verdict::fails, "its checks ended early: " + child.last_line()});
  }
  return report;
}

}  // namespace

void check_all(const std::vector<Candidate>& candidates, const Choice& choice, int jobs,
               const std::function<void(const Report&)>& done) {
  std::map<std::size_t, std::unique_ptr<process::Child>> running;
  std::map<std::size_t, Report> waiting;  ///< reports for those before them
  std::size_t started = 0, reported = 0;
  while (reported < candidates.size()) {
    for (; started < candidates.size() && running.size() < static_cast<std::size_t>(jobs);
         ++started) {
      running.emplace(started, start(candidates[started], choice));
    }
    for (auto at = running.begin(); at != running.end();) {
      process::Child& child = *at->second;
      child.read();
      const bool has_ended = child.ending(std::chrono::milliseconds(10)).has_value();
      if (has_ended) waiting.emplace(at->first, report_of(candidates[at->first], child));
      at = has_ended ? running.erase(at) : std::next(at);
    }
    for (auto next = waiting.begin(); next != waiting.end() && next->first == reported;
         next = waiting.erase(next), ++reported) {
      done(next->second);
    }
  }
}

}  // namespace weft::conformance
