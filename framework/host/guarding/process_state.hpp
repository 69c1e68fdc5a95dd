// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace weft::host {

/// State that a library shares with its process, besides memory: resource limits, timers,
/// signals, CPU affinity, priority, locale, environment, umask, working directory and terminate
/// handler. A library must leave all of it as it was. The affinity, the priority and the mask of
/// signals are those of this thread.
///
/// Taking and comparing it costs about 300 system calls: once per load, creation, preparation,
/// first call and destruction of a component, not once per call.
///
/// Output to stdout is no part of it: what a library prints there cannot be separated from what the
/// program prints. A worker keeps it out of the program's output, and `weft plugins check` fails.
class ProcessState {
 public:
  /// A part of the state that differs from the earlier one, as text.
  struct Change {
    std::string part;           ///< "umask"
    std::string before, after;  ///< one line per limit, signal, variable
  };

  ProcessState();  ///< takes the present state

  /// A part of it, as text, or an empty text.
  std::string text(std::string_view part) const;

  /// The parts that differ now.
  std::vector<Change> changes() const;

  /// Restores what differs now. Returns a sentence for a warning, or an empty text: "the process
  /// state changed while it was created: umask (restored)". Where other threads call libraries at
  /// the same time, one of these may have changed it.
  std::string restore(const std::string& when) const;

 private:
  struct Part {
    std::string name, text;
    std::function<std::string()> now;  ///< the text of the present state
    std::function<bool()> restore;     ///< false where the kernel refuses
  };

  std::vector<Part> parts_;
};

}  // namespace weft::host
