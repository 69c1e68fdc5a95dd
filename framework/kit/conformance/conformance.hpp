// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kit/conformance/candidate.hpp"
#include "kit/conformance/finding.hpp"

namespace weft::conformance {

/// How a component did.
struct Report {
  std::string id, library;
  std::string skipped;            ///< why it was not checked, or not called; empty where it was
  std::vector<Finding> findings;  ///< [.] in the order of the checks

  std::size_t count(Verdict verdict) const;
  bool fails() const { return count(Verdict::fails) > 0; }
};

/// Checks that a component conforms to the binary contract and to that of its role. Each group of
/// checks runs in a separate process, a copy of this one, which must have one thread.
Report check(const Candidate& candidate, const Choice& choice);

/// The same for several, `jobs` of them at once, each in a separate process. `done` gets the
/// reports in the order of the candidates.
void check_all(const std::vector<Candidate>& candidates, const Choice& choice, int jobs,
               const std::function<void(const Report&)>& done);

/// True if there is a group or a check of this name.
bool is_known(const std::string& group_or_check);

}  // namespace weft::conformance
