// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "kit/conformance/notebook.hpp"
#include "kit/conformance/play.hpp"

namespace weft::conformance {

/// Checks that are made in one process.
struct Group {
  const char* name;
  const char* sentence;  ///< its subject
  void (*make)(const Setting& setting, Notebook& notebook);
  std::chrono::seconds longest;  ///< for one check
  bool calls = true;  ///< makes instances, for which parameters are needed, and maybe a device
};

/// In the order in which they are made.
const std::vector<Group>& all_groups();

void check_load(const Setting& setting, Notebook& notebook);
void check_table(const Setting& setting, Notebook& notebook);
void check_parameters(const Setting& setting, Notebook& notebook);
void check_contract(const Setting& setting, Notebook& notebook);
void check_geometry(const Setting& setting, Notebook& notebook);
void check_calls(const Setting& setting, Notebook& notebook);
void check_limits(const Setting& setting, Notebook& notebook);

}  // namespace weft::conformance
