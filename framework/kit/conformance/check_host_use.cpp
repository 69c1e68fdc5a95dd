// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/check_host_use.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "kit/conformance/check_in_child.hpp"
#include "kit/conformance/probes/passages.hpp"
#include "kit/conformance/probes/process_state.hpp"
#include "kit/conformance/probes/sealed_host.hpp"
#include "kit/conformance/probes/utf8_text.hpp"
#include "process/child.hpp"

namespace weft::conformance {
namespace {

using std::chrono::milliseconds;

// The limits of weft_host.log in abi.h.
constexpr int kMostTexts = 100;
constexpr std::size_t kLongestText_bytes = 4096;
constexpr milliseconds kLateUse{200};  ///< given to threads that outlive their instance
constexpr std::chrono::seconds kLongestExit{10};
constexpr int kEndedByItself = 87;  ///< exit code of a process that ended by itself

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

/// The error of a text for the log; empty if there is none.
std::string mistake_in(const char* text) {
  if (text == nullptr) return "it logs a null pointer";
  const std::size_t length = strnlen(text, kLongestText_bytes + 1);
  if (length > kLongestText_bytes) {
    return fmt::format("it logs a text of more than {} bytes, which the host cuts",
                       kLongestText_bytes);
  }
  const std::string_view all(text, length);
  if (!is_utf8(all)) return "it logs a text that is no UTF-8";
  const auto control = std::find_if(all.begin(), all.end(), is_control);
  if (control == all.end()) return "";
  return fmt::format(
      "it logs a text with the control character {:#04x}, which the host escapes: "
      "log one line of plain text",
      static_cast<unsigned char>(*control));
}

/// Reads what a component logs and invokes.
class HeardHost final : public OtherHost {
 public:
  std::string mistake() const {
    const std::lock_guard guard(lock_);
    return mistake_;
  }

 protected:
  void logged(const char* text) override {
    const int before = texts_++;
    if (before == kMostTexts) {
      // Explains the end too, where it logs without end.
      remark_on_end("it logs more than 100 texts in a call: ");
      note(fmt::format("it logs more than {} texts in a call, and the host drops the others",
                       kMostTexts));
    }
    if (before < kMostTexts) note(mistake_in(text));
  }
  void invoked(std::uint64_t component, std::int32_t status, const weft_error& error) override {
    const std::string_view message = error.message;
    const bool is_refused =
        status == WEFT_ERROR && (message.find("component has the handle") != message.npos ||
                                 message.find("not nested in it") != message.npos);
    if (!is_refused) return;
    note(
        fmt::format("it invokes the handle {}, which it was not given: invoke components of its "
                    "parameters and producers of its warps alone",
                    component));
  }
  void left(std::int32_t /*status*/) override { texts_ = 0; }

 private:
  void note(const std::string& mistake) {
    const std::lock_guard guard(lock_);
    if (mistake_.empty()) mistake_ = mistake;
  }

  std::atomic<int> texts_ = 0;
  mutable std::mutex lock_;
  std::string mistake_;
};

void check_heard(Play& play, bool (*is_meant)(std::string_view), Page& page) {
  HeardHost host;
  play.whole({.passage = &host});
  const std::string mistake = host.mistake();
  if (!mistake.empty() && is_meant(mistake)) page.fail(mistake);
}

}  // namespace

void check_structs(Play& play) {
  const std::size_t threads = count_threads();
  SealedHost host;
  play.whole({.passage = &host});
  if (count_threads() > threads) std::this_thread::sleep_for(kLateUse);  // one may use the host
}

void check_log(Play& play, Page& page) {
  check_heard(
      play, [](std::string_view text) { return text.starts_with("it logs"); }, page);
}

void check_invocations(Play& play, Page& page) {
  check_heard(
      play, [](std::string_view text) { return text.starts_with("it invokes"); }, page);
}

void check_exit(Play& play, Page& page) {
  const auto started = process::Child::start(
      process::Copy{.work = [&](int pipe) -> int {
                      play.whole();
                      std::fflush(nullptr);
                      static_cast<void>(!ftruncate(STDOUT_FILENO, 0));  // drops the output of calls
                      static_cast<void>(!write(pipe, "e", 1));
                      std::exit(kEndedByItself);
                    },
                    .out = process::kMemory,
                    .err = process::kMemory});
  if (!started) throw std::runtime_error(started.error().message);
  process::Child& child = **started;
  Deadline deadline(kLongestExit);
  child.listen([&] { return !deadline.is_over(child.out()); });
  const bool is_late = !child.ending();
  const process::Ending ending = child.end();
  child.read();
  if (child.out().empty()) return page.skip("its calls do not return, which other checks report");
  const std::string printed = child.last_line();
  constexpr const char* kFix = "leave atexit() and destructors of static objects without effect";
  if (is_late) {
    page.fail(fmt::format("the program does not end after its calls: {}", kFix));
  } else if (ending.signal != 0) {
    page.fail(fmt::format("the end of the program is ended by {}: {}",
                          process::signal_text(ending.signal), kFix));
  } else if (ending.exit_code != kEndedByItself) {
    page.fail(
        fmt::format("it changes the exit code of the program to {}: {}", ending.exit_code, kFix));
  }
  page.expect(printed.empty(),
              fmt::format("it prints '{}' when the program ends: {}", printed, kFix));
}

}  // namespace weft::conformance
