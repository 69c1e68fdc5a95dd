// SPDX-License-Identifier: Apache-2.0
#include "process/child.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <string_view>
#include <weft/core/index.hpp>

#include "process/descendants.hpp"
#include "process/supervisor.hpp"

namespace weft::process {
namespace {

using Clock = std::chrono::steady_clock;

/// The settings, and of this process's environment what they do not set.
std::vector<std::string> environment_with(const std::vector<std::string>& settings) {
  std::vector<std::string> all = settings;
  for (char** each = environ; *each != nullptr; ++each) {
    const std::string_view variable = *each;
    const auto sets_it = [&](const std::string& setting) {
      return setting.starts_with(variable.substr(0, variable.find('=') + 1));
    };
    if (std::none_of(settings.begin(), settings.end(), sets_it)) all.emplace_back(variable);
  }
  return all;
}

/// A list as C functions take it.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// 0, or the error number.
int spawn(const Program& program, std::array<int, 2> outputs, pid_t& id) {
  std::vector<std::string> words = program.words;
  std::vector<std::string> variables = environment_with(program.settings);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, outputs[0], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, outputs[1], STDERR_FILENO);
  // To itself: the number stays and the descriptor outlives the start of the program.
  for (const int file : program.files) posix_spawn_file_actions_adddup2(&files, file, file);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  if (program.own_group) {
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(
        &attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  const int failure = posix_spawnp(&id, words.front().c_str(), &files, &attributes,
                                   pointers_to(words).data(), pointers_to(variables).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return failure;
}

void lower_limit(__rlimit_resource which, rlim_t most) {
  rlimit limit{};
  if (getrlimit(which, &limit) != 0) return;
  limit.rlim_cur = std::min(limit.rlim_cur, most);
  setrlimit(which, &limit);
}

/// Memory and files of third-party code in a copy. The sizes are far beyond what a library needs,
/// and keep the machine usable. Devices reserve addresses without end, but not writable private
/// memory. The runtimes of sanitizers do, also where they are preloaded for a library alone.
void bound_resources() {
  constexpr rlim_t kLargestFile_bytes = rlim_t{16} << 30U;
  lower_limit(RLIMIT_FSIZE, kLargestFile_bytes);
  for (const char* runtime : {"__asan_init", "__tsan_init"})
    if (dlsym(RTLD_DEFAULT, runtime) != nullptr) return;
  const auto pages = static_cast<rlim_t>(std::max(sysconf(_SC_PHYS_PAGES), 0L));
  if (pages > 0) lower_limit(RLIMIT_DATA, pages / 4 * 3 * to_index(sysconf(_SC_PAGESIZE)));
}

/// Never returns to the caller of fork(), which goes on in the other process.
[[noreturn]] void run_copy(const Copy& copy, pid_t parent, std::array<int, 2> outputs, int memory,
                           int pipe) noexcept {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
  go_on_supervised(memory);
  bound_resources();
  for (const int signal : {SIGINT, SIGTERM}) ::signal(signal, SIG_DFL);
  dup2(outputs[0], STDOUT_FILENO);
  dup2(outputs[1], STDERR_FILENO);
  _exit(copy.work(pipe));
}

Ending ending_of(int status) {
  if (WIFSIGNALED(status)) return {0, WTERMSIG(status)};
  return {WEXITSTATUS(status), 0, WEXITSTATUS(status) == kTooManyProcesses};
}

}  // namespace

std::string signal_text(int signal) {
  const char* name = sigdescr_np(signal);
  return "signal " + std::to_string(signal) + " (" + (name != nullptr ? name : "?") + ")";
}

std::string too_many_processes() {
  return "started more than " + std::to_string(kMostProcesses) +
         " processes, and was ended with them";
}

Result<OpenFile> Child::open_pipe(Pipe& pipe) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return Error{Errc::io, "cannot open a pipe"};
  pipe.file = OpenFile(ends[0]);
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return OpenFile(ends[1]);
}

Result<Child::Streams> Child::open_streams(std::array<int, 2> wanted) {
  Streams streams{wanted};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i] == kPipe) {
      auto end = open_pipe(pipes_[i]);
      if (!end) return end.error();
      streams.own[i] = *std::move(end);
    } else if (wanted[i] == kNowhere) {
      streams.own[i] = OpenFile(open("/dev/null", O_WRONLY | O_CLOEXEC));
    } else if (wanted[i] == kMemory && memory_.get() < 0) {
      memory_ = OpenFile(memfd_create("output", MFD_CLOEXEC));
      fcntl(memory_.get(), F_SETFL, O_APPEND);
    }
    if (wanted[i] < 0) {
      streams.files[i] = wanted[i] == kMemory ? memory_.get() : streams.own[i].get();
    }
    if (streams.files[i] < 0) return Error{Errc::io, "cannot open a file for its output"};
  }
  return streams;
}

Result<std::unique_ptr<Child>> Child::start(const Program& program) {
  std::unique_ptr<Child> child(new Child);
  const auto streams = child->open_streams({program.out, program.err});
  if (!streams) return streams.error();
  if (const int failure = spawn(program, streams->files, child->id_); failure != 0) {
    child->id_ = 0;
    return Error{failure == ENOENT ? Errc::not_found : Errc::io,
                 std::string("cannot be started: ") + strerror(failure), program.words.front()};
  }
  return child;
}

Result<std::unique_ptr<Child>> Child::start(const Copy& copy) {
  std::unique_ptr<Child> child(new Child);
  child->most_bytes_ = copy.most_bytes;
  const auto streams = child->open_streams({copy.out, copy.err});
  if (!streams) return streams.error();
  const auto pipe = child->open_pipe(child->pipes_[0]);
  if (!pipe) return pipe.error();
  std::fflush(nullptr);  // or what waits to be printed is printed twice
  const pid_t parent = getpid(), id = fork();
  if (id < 0) return Error{Errc::io, std::string("cannot start a process: ") + strerror(errno)};
  if (id == 0) {
    child->pipes_[0].file = OpenFile();
    run_copy(copy, parent, streams->files, child->memory_.get(), pipe->get());
  }
  child->id_ = id;
  return child;
}

Child::~Child() {
  if (id_ != 0) end();
}

void Child::listen(const std::function<bool()>& goes_on) {
  constexpr int kSlice_ms = 20, kSliceWithoutPipes_ms = 1;
  while (goes_on()) {
    const bool ended = ending().has_value();
    std::array<pollfd, 2> files{
        {{pipes_[0].file.get(), POLLIN, 0}, {pipes_[1].file.get(), POLLIN, 0}}};
    const bool is_open = files[0].fd >= 0 || files[1].fd >= 0;
    poll(files.data(), files.size(), ended ? 0 : is_open ? kSlice_ms : kSliceWithoutPipes_ms);
    read();
    if (ended) return;
  }
}

bool Child::read() {
  constexpr int kMostReads = 64;  // limits the reads to the size of a pipe, since writers may go on
  bool is_new = false;
  for (Pipe& pipe : pipes_) {
    std::array<char, 4096> bytes;
    for (int reads = 0; reads < kMostReads && pipe.file.get() >= 0; ++reads) {
      const ssize_t count = ::read(pipe.file.get(), bytes.data(), bytes.size());
      if (count < 0 && (errno == EINTR || errno == EAGAIN)) break;
      is_new = true;
      if (count <= 0) pipe.file = OpenFile();
      if (count > 0 && pipe.text.size() < most_bytes_) {
        pipe.text.append(bytes.data(), to_index(count));
      }
    }
  }
  return is_new;
}

const std::optional<Ending>& Child::ending(std::chrono::milliseconds patience) {
  const auto latest = Clock::now() + patience;
  while (!ending_) {
    int status = 0;
    const pid_t ended = waitpid(id_, &status, WNOHANG);
    if (ended == id_) ending_ = ending_of(status);
    if (ended < 0 && errno != EINTR) ending_ = Ending{.is_known = false};
    if (ending_ || Clock::now() >= latest) break;
    poll(nullptr, 0, 1);
  }
  return ending_;
}

void Child::ask_to_end() {
  if (!ending()) kill(id_, SIGTERM);
}

Ending Child::end(std::chrono::milliseconds patience) {
  if (patience.count() > 0) ask_to_end();
  if (!ending(patience)) {
    const std::vector<Descendant> started = descendants_of(id_);
    kill(id_, SIGKILL);
    for (const Descendant& each : started) kill(each.id, SIGKILL);
    while (!ending(std::chrono::seconds(1))) continue;
  }
  return *ending_;
}

std::string Child::last_line() const {
  constexpr off_t kLongest = 300;
  struct stat status {};
  if (fstat(memory_.get(), &status) != 0) return {};
  std::string text(kLongest, '\0');
  const ssize_t count =
      pread(memory_.get(), text.data(), text.size(), std::max<off_t>(0, status.st_size - kLongest));
  text.resize(to_index(std::max<ssize_t>(count, 0)));
  text.resize(text.find_last_not_of(" \t\r\n") + 1);  // npos + 1 is 0
  text.erase(0, text.rfind('\n') + 1);
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  return text;
}

std::uint64_t Child::empty_memory() const {
  constexpr off_t kMost_bytes = 1 << 20;
  struct stat status {};
  if (fstat(memory_.get(), &status) != 0 || status.st_size <= kMost_bytes) return 0;
  return ftruncate(memory_.get(), 0) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

}  // namespace weft::process
