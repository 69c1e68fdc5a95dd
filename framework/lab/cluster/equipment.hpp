// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/loading/registry.hpp"

namespace weft::cluster {

/// Properties that two machines must share for cells to have the same keys there.
struct Equipment {
  std::string weft;                           ///< version
  std::vector<std::string> processor;         ///< features that count
  std::map<std::string, std::string> builds;  ///< build id of each component

  /// The properties of this machine.
  static Equipment here(const host::Registry& registry);

  /// How `other` differs, in words; empty where it has all that this one has.
  std::string difference(const Equipment& other) const;
};

}  // namespace weft::cluster
