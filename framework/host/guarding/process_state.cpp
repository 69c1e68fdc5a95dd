// SPDX-License-Identifier: Apache-2.0
#include "host/guarding/process_state.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <locale>
#include <set>
#include <string_view>

namespace weft::host {
namespace {

// Numbers are written by std::to_string(): streams follow the global locale.
std::string limit_text(rlim_t limit) {
  return limit == RLIM_INFINITY ? "unlimited" : std::to_string(limit);
}

/// Resource limits, by number.
class Limits {
 public:
  Limits() {
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      getrlimit(static_cast<__rlimit_resource>(i), &limits_.at(i));
    }
  }
  std::string text() const {
    std::string text;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      text += std::to_string(i) + ": " + limit_text(limits_.at(i).rlim_cur) + " of " +
              limit_text(limits_.at(i).rlim_max) + "\n";
    }
    return text;
  }
  /// Only root can raise a hard limit: then the soft one is set as near as it can be.
  bool restore() const {
    bool whole = true;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      const auto which = static_cast<__rlimit_resource>(i);
      if (setrlimit(which, &limits_.at(i)) == 0) continue;
      whole = false;
      rlimit now{};
      getrlimit(which, &now);
      now.rlim_cur = std::min(limits_.at(i).rlim_cur, now.rlim_max);
      setrlimit(which, &now);
    }
    return whole;
  }

 private:
  std::array<rlimit, RLIM_NLIMITS> limits_{};
};

/// Interval timers, which end the process by a signal, and the numbers of POSIX timers.
class Timers {
 public:
  Timers() {
    std::ifstream file("/proc/self/timers");
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with("ID:")) posix_.insert(std::atoi(line.c_str() + 3));
    }
    for (std::size_t i = 0; i < timers_.size(); ++i) {
      getitimer(static_cast<__itimer_which>(i), &timers_.at(i));
    }
  }
  /// Not the remaining time, which passes.
  std::string text() const {
    std::string text;
    for (const itimerval& timer : timers_) {
      const bool is_armed = timer.it_value.tv_sec != 0 || timer.it_value.tv_usec != 0;
      text += (is_armed ? "armed, " : "off, ") + std::to_string(timer.it_interval.tv_sec) + "." +
              std::to_string(timer.it_interval.tv_usec) + " s\n";
    }
    for (const int id : posix_) text += "timer " + std::to_string(id) + "\n";
    return text;
  }
  bool restore() const {
    bool whole = true;
    for (std::size_t i = 0; i < timers_.size(); ++i) {
      whole = setitimer(static_cast<__itimer_which>(i), &timers_.at(i), nullptr) == 0 && whole;
    }
    for (const int id : Timers().posix_) {
      // The kernel has another number than the timer_t of the C library.
      if (!posix_.contains(id)) whole = syscall(SYS_timer_delete, id) == 0 && whole;
    }
    return whole;
  }

 private:
  std::array<itimerval, 3> timers_{};
  std::set<int> posix_{};
};

/// Actions of all signals, and which this thread blocks.
class Signals {
 public:
  Signals() {
    for (int signal = 1; signal < NSIG; ++signal) {
      known_.at(signal) = sigaction(signal, nullptr, &actions_.at(signal)) == 0;
    }
    pthread_sigmask(SIG_SETMASK, nullptr, &mask_);
  }
  std::string text() const {
    constexpr int kRestorer = 0x04000000;  // set by the C library in each installed action
    std::string text;
    for (int signal = 1; signal < NSIG; ++signal) {
      const bool is_blocked = sigismember(&mask_, signal) == 1;
      if (!known_.at(signal)) continue;
      const struct sigaction& action = actions_.at(signal);
      const auto handler = reinterpret_cast<std::uintptr_t>(action.sa_handler);
      const int flags = action.sa_flags & ~kRestorer;
      if (handler == 0 && flags == 0 && !is_blocked) continue;
      text += "signal " + std::to_string(signal) + ": handler " + std::to_string(handler) +
              ", flags " + std::to_string(flags) + (is_blocked ? ", blocked\n" : "\n");
    }
    return text;
  }
  bool restore() const {
    for (int signal = 1; signal < NSIG; ++signal) {
      if (known_.at(signal)) sigaction(signal, &actions_.at(signal), nullptr);
    }
    return pthread_sigmask(SIG_SETMASK, &mask_, nullptr) == 0;
  }

 private:
  std::array<struct sigaction, NSIG> actions_{};
  std::array<bool, NSIG> known_{};
  sigset_t mask_{};
};

/// The processors on which this thread may run.
class Affinity {
 public:
  Affinity() { is_known_ = sched_getaffinity(0, sizeof(set_), &set_) == 0; }
  std::string text() const {
    std::string text;
    for (std::size_t i = 0; is_known_ && i < CPU_SETSIZE; ++i) {
      if (CPU_ISSET(i, &set_)) text += "CPU " + std::to_string(i) + "\n";
    }
    return text;
  }
  bool restore() const { return is_known_ && sched_setaffinity(0, sizeof(set_), &set_) == 0; }

 private:
  cpu_set_t set_{};
  bool is_known_ = false;
};

class Priority {
 public:
  std::string text() const {
    return "nice " + std::to_string(nice_) + ", policy " + std::to_string(policy_);
  }
  bool restore() const {
    sched_param with{};
    const bool as_before = sched_getscheduler(0) == policy_ ||
                           (policy_ == SCHED_OTHER && sched_setscheduler(0, policy_, &with) == 0);
    return setpriority(PRIO_PROCESS, 0, nice_) == 0 && as_before;
  }

 private:
  int nice_ = getpriority(PRIO_PROCESS, 0);
  int policy_ = sched_getscheduler(0);
};

/// Locales of the C library and of C++ streams.
class Locale {
 public:
  std::string text() const { return c_ + ", of C++ " + cpp_.name(); }
  bool restore() const {
    std::locale::global(cpp_);  // changes that of C too, where it has a name
    return std::setlocale(LC_ALL, c_.c_str()) != nullptr;
  }

 private:
  std::string c_ = std::setlocale(LC_ALL, nullptr);
  std::locale cpp_{};
};

/// The variables that a process has. New ones disturb no other component, unless the C library
/// reads them; runtimes of OpenMP and CUDA, and modules of Python, add some.
class Environment {
 public:
  Environment() {
    for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
      all_.emplace_back(*entry);
    }
    for (const char* name : {"TZ", "LANG", "LANGUAGE", "LC_ALL"}) {
      if (std::getenv(name) == nullptr) all_.emplace_back(name);
    }
  }
  std::string text() const {
    std::string text;
    for (const std::string& entry : all_) text += entry + "\n";
    return text;
  }
  /// The present values of the same variables.
  std::string text_now() const {
    std::string text;
    for (const std::string& entry : all_) text += present(name_of(entry)) + "\n";
    return text;
  }
  bool restore() const {
    for (const std::string& entry : all_) {
      const std::string name = name_of(entry);
      if (present(name) == entry) continue;
      if (name == entry) unsetenv(name.c_str());
      if (name != entry) setenv(name.c_str(), entry.c_str() + name.size() + 1, 1);
    }
    tzset();
    return true;
  }

 private:
  static std::string name_of(const std::string& entry) { return entry.substr(0, entry.find('=')); }
  static std::string present(const std::string& name) {
    const char* value = std::getenv(name.c_str());
    return value != nullptr ? name + "=" + value : name;
  }

  std::vector<std::string> all_;  ///< "NAME=VALUE"; "NAME" where it is not set
};

/// Read from the kernel: umask(2) can only be read by changing it, for other threads too.
class FileMask {
 public:
  FileMask() {
    std::ifstream file("/proc/self/status");
    constexpr std::string_view kKey = "Umask:\t";
    for (std::string line; text_.empty() && std::getline(file, line);) {
      if (line.starts_with(kKey)) text_ = line.substr(kKey.size());
    }
  }
  const std::string& text() const { return text_; }
  bool restore() const {
    umask(static_cast<mode_t>(std::strtoul(text_.c_str(), nullptr, 8)));
    return true;
  }

 private:
  std::string text_;  ///< octal
};

class WorkingDirectory {
 public:
  const std::string& text() const { return path_; }
  bool restore() const { return chdir(path_.c_str()) == 0; }

 private:
  std::error_code code_;
  std::string path_ = std::filesystem::current_path(code_).string();
};

class TerminateHandler {
 public:
  std::string text() const { return std::to_string(reinterpret_cast<std::uintptr_t>(handler_)); }
  bool restore() const {
    std::set_terminate(handler_);
    return true;
  }

 private:
  std::terminate_handler handler_ = std::get_terminate();
};

}  // namespace

ProcessState::ProcessState() {
  const auto add = [this](const char* name, const auto& make) {
    const auto state = make();
    parts_.push_back({name, state.text(), [make] { return make().text(); },
                      [state] { return state.restore(); }});
  };
  add("resource limits", [] { return Limits(); });
  add("timers", [] { return Timers(); });
  add("signals", [] { return Signals(); });
  add("CPU affinity", [] { return Affinity(); });
  add("priority", [] { return Priority(); });
  add("locale", [] { return Locale(); });
  add("umask", [] { return FileMask(); });
  add("working directory", [] { return WorkingDirectory(); });
  add("terminate handler", [] { return TerminateHandler(); });
  const Environment environment;
  parts_.push_back({"environment", environment.text(),
                    [environment] { return environment.text_now(); },
                    [environment] { return environment.restore(); }});
}

std::string ProcessState::text(std::string_view name) const {
  const auto part = std::find_if(parts_.begin(), parts_.end(),
                                 [&](const Part& each) { return each.name == name; });
  return part != parts_.end() ? part->text : "";
}

std::vector<ProcessState::Change> ProcessState::changes() const {
  std::vector<Change> changes;
  for (const Part& part : parts_) {
    std::string now = part.now();
    if (now != part.text) changes.push_back({part.name, part.text, std::move(now)});
  }
  return changes;
}

std::string ProcessState::restore(const std::string& when) const {
  std::string list;
  for (const Part& part : parts_) {
    if (part.now() == part.text) continue;
    list += (list.empty() ? "" : ", ") + part.name +
            (part.restore() ? " (restored)" : " (cannot be restored)");
  }
  return list.empty() ? "" : "the process state changed " + when + ": " + list;
}

}  // namespace weft::host
