// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace weft::conformance {

/// A check as the page lists it.
struct CheckInfo {
  std::string name;      ///< "limits/descriptors"; "contract/without_*" stands for each input
  std::string sentence;  ///< the property that holds
  bool brief = false;    ///< true if it is also made in a quick run
};

/// The checks of all groups, in the order in which they are made.
const std::vector<CheckInfo>& all_checks();

/// Null where there is no such check.
const CheckInfo* find_check(std::string_view name);

/// "with 0 matches" as part of a name: "with_0_matches".
std::string as_name(std::string_view words);

}  // namespace weft::conformance
