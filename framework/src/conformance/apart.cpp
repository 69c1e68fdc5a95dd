// SPDX-License-Identifier: Apache-2.0
#include "conformance/apart.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <weft/testing/role_contract.hpp>

#include "host/supervising/supervisor.hpp"

namespace weft::conformance {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWhole = 86;  ///< exit code of a process that came to the end of its checks
constexpr std::size_t kMostPrinted = 300;  ///< [bytes] of it that are told

/// What a handler reaches.
int remarks_to = -1;

/// A component that spoils an input is told so; what becomes of it does not change.
void on_fault(int signal, siginfo_t* info, void* /*context*/) {
  const testing::SpoiltInput spoilt = testing::spoilt_input_at(info->si_addr);
  if (spoilt.input != nullptr) {
    Notebook::remark(remarks_to, "it ");
    Notebook::remark(remarks_to, spoilt.deed);
    Notebook::remark(remarks_to, spoilt.input);
    Notebook::remark(remarks_to, ": ");
  }
  std::signal(signal, SIG_DFL);
  if (info->si_code <= 0) raise(signal);  // a fault comes again by itself
}

struct Pipe {
  int read_end = -1, write_end = -1;

  Pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe can be made");
    read_end = ends[0];
    write_end = ends[1];
  }
  ~Pipe() {
    close_writing();
    close(read_end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_writing() {
    if (write_end >= 0) close(write_end);
    write_end = -1;
  }
};

[[noreturn]] void work(const Pipe& notes, int printed, const Choice& choice,
                       const std::function<void(Notebook&)>& make) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  host::go_on_supervised(printed);
  dup2(printed, STDOUT_FILENO);
  dup2(printed, STDERR_FILENO);
  remarks_to = notes.write_end;
  for (const int deadly : {SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(deadly, SIG_DFL);
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSEGV, &action, nullptr);
  Notebook notebook(notes.write_end, choice);
  make(notebook);
  _exit(kWhole);
}

/// Adds what can be read within so many ms; false at its end.
bool read_some(int file, int wait_ms, std::string& written) {
  std::array<char, 4096> part{};
  pollfd readable{file, POLLIN, 0};
  while (poll(&readable, 1, wait_ms) > 0) {
    const ssize_t got = read(file, part.data(), part.size());
    if (got <= 0) return false;
    written.append(part.data(), static_cast<std::size_t>(got));
  }
  return true;
}

struct Heard {
  std::string written;
  int status = 0;     ///< as waitpid() tells it
  bool late = false;  ///< it wrote nothing for too long, and was ended
};

/// All that it writes until it ends, or is silent for `longest`. Others may hold the pipe open
/// after its end, and it may close the pipe before.
Heard listen(const Pipe& notes, pid_t child, std::chrono::seconds longest) {
  constexpr int kWait_ms = 20;
  Heard heard;
  auto last = Clock::now();
  for (bool is_open = true; waitpid(child, &heard.status, WNOHANG) != child;) {
    const std::size_t before = heard.written.size();
    if (is_open) is_open = read_some(notes.read_end, kWait_ms, heard.written);
    if (!is_open) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (heard.written.size() > before) last = Clock::now();
    heard.late = Clock::now() - last > longest;
    if (!heard.late) continue;
    heard.status = host::end_supervised(child);
    break;
  }
  read_some(notes.read_end, 0, heard.written);
  heard.late = heard.late && WIFSIGNALED(heard.status);
  return heard;
}

/// The last line that it printed, in quotes.
std::string last_line(int printed) {
  const off_t size = lseek(printed, 0, SEEK_END);
  const auto bytes = std::min<off_t>(size, kMostPrinted);
  std::string text(static_cast<std::size_t>(std::max<off_t>(bytes, 0)), '\0');
  if (pread(printed, text.data(), text.size(), size - bytes) != bytes) return "";
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t line = text.rfind('\n');
  if (line != std::string::npos) text = text.substr(line + 1);
  return text.empty() ? "" : ", having printed '" + text + "'";
}

std::string how_it_ended(const Heard& heard, std::chrono::seconds longest) {
  if (heard.late) return fmt::format("not done after {} s", longest.count());
  if (host::had_too_many_processes(heard.status)) return "it " + host::too_many_processes();
  if (WIFEXITED(heard.status)) {
    return fmt::format("it ended its process with exit code {}", WEXITSTATUS(heard.status));
  }
  const int signal = WTERMSIG(heard.status);
  return fmt::format("ended by signal {} ({})", signal, strsignal(signal));
}

}  // namespace

std::vector<Finding> checked_apart(const std::string& first, const Choice& choice,
                                   std::chrono::seconds longest,
                                   const std::function<void(Notebook&)>& make) {
  Pipe notes;
  const int printed = memfd_create("printed", MFD_CLOEXEC);
  if (printed < 0) throw std::runtime_error("there is no memory");
  std::fflush(nullptr);  // or both would write what is left
  const pid_t child = fork();
  if (child == 0) work(notes, printed, choice, make);
  if (child < 0) throw std::runtime_error("no process can be made");
  notes.close_writing();
  const Heard heard = listen(notes, child, longest);
  Notes read = read_notes(heard.written);
  const bool whole = WIFEXITED(heard.status) && WEXITSTATUS(heard.status) == kWhole;
  if (!whole) {
    const std::string check = !read.unfinished.empty() ? read.unfinished
                              : !read.findings.empty() ? read.findings.back().check
                                                       : first;
    if (!read.findings.empty() && read.findings.back().check == check) read.findings.pop_back();
    read.findings.push_back(
        {check, Verdict::fails,
         fmt::format("{}{}{}; what comes after it in its group was not checked", read.remarks,
                     how_it_ended(heard, longest), last_line(printed))});
  }
  close(printed);
  return std::move(read.findings);
}

}  // namespace weft::conformance
