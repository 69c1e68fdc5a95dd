// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace weft::conformance {

enum class Verdict {
  holds,
  fails,
  deviates,        ///< fails, according to the component's page
  does_not_apply,  ///< to this component, here
};

inline const char* to_text(Verdict verdict) {
  constexpr const char* kNames[] = {"holds", "fails", "deviates", "does not apply"};
  return kNames[static_cast<int>(verdict)];
}

/// The result of a check.
struct Finding {
  std::string check;  ///< "limits/descriptors"
  Verdict verdict = Verdict::holds;
  std::string seen;  ///< for a failure, the observation and the fix; the reason why it does not
                     ///< apply; a figure
};

/// The beginning of what is seen by a check that holds with fewer repetitions than it has.
inline constexpr std::string_view kReduced = "reduced: ";

inline bool is_reduced(const Finding& finding) {
  return finding.verdict == Verdict::holds && finding.seen.starts_with(kReduced);
}

/// Which checks are made.
struct Choice {
  std::string only;     ///< a group or a check; empty for all
  bool brief = false;   ///< those alone that take little time
  double effort = 1.0;  ///< CPU time for the checks that repeat calls, as a part of their whole

  bool takes(std::string_view check) const {
    return only.empty() || check == only || check.starts_with(only + "/");
  }
};

}  // namespace weft::conformance
