// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/check_in_child.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <stdexcept>
#include <weft/testing/role_contract.hpp>

#include "kit/conformance/probes/processor_time.hpp"
#include "kit/conformance/probes/sealed_host.hpp"
#include "process/child.hpp"

namespace weft::conformance {
namespace {

constexpr std::chrono::milliseconds kUntilNextLook{200};
constexpr double kSleeping = 0.02;  ///< most CPU time, as a part of wall-clock time
constexpr int kWhole = 86;          ///< exit code of a process that came to the end of its checks

/// Data for a signal handler.
int remarks_to = -1;

/// A component that writes what it must only read gets a remark; the signal's effect does not
/// change. If several threads fault, the first one writes its remark and ends the process.
void on_fault(int signal, siginfo_t* info, void* /*context*/) {
  static std::atomic_flag has_faulted;
  while (has_faulted.test_and_set()) pause();
  const testing::SpoiltInput spoilt = testing::spoilt_input_at(info->si_addr);
  if (spoilt.input != nullptr) {
    remark_on_end("it ");
    remark_on_end(spoilt.access);
    remark_on_end(spoilt.input);
    remark_on_end(": ");
  } else if (const SealedPlace place = sealed_place(info->si_addr); place.what != nullptr) {
    remark_on_end(place.is_left ? "after a call had returned it used " : "it wrote into ");
    remark_on_end(place.what);
    remark_on_end(": ");
  }
  std::signal(signal, SIG_DFL);
  if (info->si_code <= 0) raise(signal);  // a fault comes again by itself
}

/// The exit code.
int make_checks(int notes, const Choice& choice, const std::function<void(Notebook&)>& make) {
  remarks_to = notes;
  for (const int deadly : {SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(deadly, SIG_DFL);
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSEGV, &action, nullptr);
  Notebook notebook(notes, choice);
  make(notebook);
  return kWhole;
}

std::string how_it_ended(const process::Ending& ending) {
  if (ending.too_many) return "it " + process::too_many_processes();
  if (ending.signal != 0) return "ended by " + process::signal_text(ending.signal);
  return fmt::format("it ended its process with exit code {}", ending.exit_code);
}

/// The end of a process that did not come to the end of its checks.
Finding failure(const Notes& notes, const std::string& first, const std::string& how,
                const std::string& printed) {
  const std::string check = !notes.unfinished.empty() ? notes.unfinished
                            : !notes.findings.empty() ? notes.findings.back().check
                                                      : first;
  return {check, Verdict::fails,
          fmt::format("{}{}{}; what comes after it in its group was not checked", notes.remarks,
                      how, printed.empty() ? "" : ", having printed '" + printed + "'")};
}

}  // namespace

void remark_on_end(const char* text) { Notebook::remark(remarks_to, text); }

bool Deadline::is_over(const std::string& written) {
  const auto now = Clock::now();
  if (written.size() > size_) {
    begun_ = looked_ = window_ = now;
    window_used_ms_ = 0.0;
  }
  size_ = written.size();
  if (now - begun_ <= longest_ || now - looked_ <= kUntilNextLook) return false;
  looked_ = now;
  const std::chrono::duration<double, std::milli> longest = longest_, waited = now - window_;
  const double used_ms = descendants_processor_ms() - read_notes(written).begun_ms;
  if (used_ms > longest.count()) return true;
  if (waited < longest) return false;
  const bool is_asleep = used_ms - window_used_ms_ < kSleeping * waited.count();
  window_ = now;
  window_used_ms_ = used_ms;
  return is_asleep;
}

std::vector<Finding> check_in_child(const std::string& first, const Choice& choice,
                                    std::chrono::seconds longest,
                                    const std::function<void(Notebook&)>& make) {
  const auto started = process::Child::start(
      process::Copy{.work = [&](int notes) { return make_checks(notes, choice, make); },
                    .out = process::kMemory,
                    .err = process::kMemory});
  if (!started) throw std::runtime_error(started.error().message);
  process::Child& child = **started;
  Deadline deadline(longest);
  child.listen([&] { return !deadline.is_over(child.out()); });
  const bool late = !child.ending();
  const process::Ending ending = child.end();
  child.read();
  Notes notes = read_notes(child.out());
  if (ending.exit_code == kWhole) return std::move(notes.findings);
  const std::string how = late && ending.signal != 0
                              ? fmt::format("not done after {} s", longest.count())
                              : how_it_ended(ending);
  const Finding last_one = failure(notes, first, how, child.last_line());
  if (!notes.findings.empty() && notes.findings.back().check == last_one.check) {
    notes.findings.pop_back();
  }
  notes.findings.push_back(last_one);
  return std::move(notes.findings);
}

}  // namespace weft::conformance
