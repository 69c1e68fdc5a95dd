// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "process/open_file.hpp"

namespace weft::process {

/// How a process ended.
struct Ending {
  int exit_code = 0;      ///< 0 also where a signal ended it, and where it is not known
  int signal = 0;         ///< number of the signal that ended it; 0 for none
  bool too_many = false;  ///< its supervisor ended it with all processes that it had started
  bool is_known = true;   ///< false where another part of this program has waited for it
};

/// In words: "signal 11 (Segmentation fault)".
std::string signal_text(int signal);

/// The cause where `too_many` is set: "started more than 256 processes, and was ended with them".
std::string too_many_processes();

// Where stdout and stderr of a new process go, besides to an open file of this program.
constexpr int kNowhere = -1;
constexpr int kPipe = -2;    ///< read by this program
constexpr int kMemory = -3;  ///< one file in memory for both; its supervisor keeps the end only

/// A program to start. Its stdin is empty.
struct Program {
  std::vector<std::string> words;  ///< its path, or its name in the search path, and its arguments
  std::vector<std::string> settings = {};  ///< "NAME=VALUE", before those of this program
  int out = kNowhere, err = kNowhere;      ///< file descriptors of stdout and stderr
  std::vector<int> files = {};  ///< further open files that it keeps, under the same numbers
  bool own_group = false;  ///< no signal of the terminal reaches it, none is blocked or ignored
};

/// A copy of this process to start. Its stdin is empty. Its files may have 16 GiB, and its memory
/// three quarters of the machine's. `work` writes into a pipe, which this
/// program reads, and returns the exit code.
struct Copy {
  std::function<int(int pipe)> work;
  int out = kNowhere, err = kNowhere;  ///< file descriptors of stdout and stderr
  std::size_t most_bytes = 64 << 20;   ///< kept of what `work` writes
};

/// A process that this one has started. The destructor ends it.
class Child {
 public:
  /// Fails with not_found where there is no such program: "cannot be started: ..." and its name.
  static Result<std::unique_ptr<Child>> start(const Program& program);

  /// This process must have one thread: others are not copied, and the locks that they hold stay
  /// locked. The copy is supervised (supervisor.hpp) and ends with this process.
  static Result<std::unique_ptr<Child>> start(const Copy& copy);

  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Reads the pipes until the process has ended, or until `goes_on`, called at least every 20 ms,
  /// returns false. Other processes may keep the pipes open, and the process may close them early.
  void listen(const std::function<bool()>& goes_on);

  /// Reads what the pipes hold, without waiting. Returns whether that was anything, or an end.
  bool read();

  /// The text read from stdout, or from the pipe of a copy, and from stderr. Text beyond 64 MiB, or
  /// `most_bytes`, is dropped.
  std::string& out() { return pipes_[0].text; }
  std::string& err() { return pipes_[1].text; }
  int out_file() const { return pipes_[0].file.get(); }  ///< for poll(2); -1 after its end

  /// Waits at most this long for the end of the process; empty while it runs.
  const std::optional<Ending>& ending(std::chrono::milliseconds patience = {});

  /// Sends SIGTERM, with which a supervised process ends all that it has started.
  void ask_to_end();

  /// Ends it where it still runs: SIGTERM, and after the patience SIGKILL for it and all that it
  /// has started. Without patience SIGKILL at once.
  Ending end(std::chrono::milliseconds patience = std::chrono::seconds(60));

  /// Lets the process run on after this object.
  void leave() { id_ = 0; }

  /// The last line in its memory, of at most 300 bytes, with spaces for control characters.
  std::string last_line() const;

  /// Empties its memory where that has more than 1 MiB. Returns the size before, else 0 [bytes].
  std::uint64_t empty_memory() const;

 private:
  struct Pipe {
    OpenFile file;  ///< the end that is read
    std::string text;
  };
  /// The files of both streams, and those of them to close once the process has them.
  struct Streams {
    std::array<int, 2> files{};  ///< [2] file descriptors of stdout and stderr
    std::array<OpenFile, 2> own{};
  };

  Child() = default;
  Result<OpenFile> open_pipe(Pipe& pipe);
  Result<Streams> open_streams(std::array<int, 2> wanted);

  pid_t id_ = 0;  ///< 0 where there is none to end
  std::optional<Ending> ending_;
  std::array<Pipe, 2> pipes_;
  OpenFile memory_;
  std::size_t most_bytes_ = 64 << 20;
};

}  // namespace weft::process
