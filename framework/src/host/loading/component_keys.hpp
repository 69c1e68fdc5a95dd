// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "yaml/key_table.hpp"

namespace weft::host {

/// The keys of a component; places of a pipeline add some of their own.
inline const yaml::KeyTable& component_keys() {
  static const yaml::KeyTable kKeys{
      {.name = "use",
       .help = "id of the plugin, ROLE/NAME",
       .form = yaml::Form::part,
       .part = "use",
       .required = true},
      {.name = "params",
       .help = "its parameters, see: weft plugins show ID",
       .form = yaml::Form::part,
       .part = "params"},
  };
  return kKeys;
}

}  // namespace weft::host
