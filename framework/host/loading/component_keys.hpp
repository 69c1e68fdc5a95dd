// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "yaml/key_table.hpp"

namespace weft::host {

/// The keys of a component; some places of a pipeline add further keys.
inline const yaml::KeyTable& component_keys() {
  static const yaml::KeyTable kKeys =
      yaml::KeyTableBuilder()
          .part("use", "use", "id of the plugin, ROLE/NAME")
          .required()
          .part("params", "params", "its parameters, see: weft plugins show ID");
  return kKeys;
}

}  // namespace weft::host
