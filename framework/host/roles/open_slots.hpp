// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "host/roles/role_rules.hpp"

namespace weft {

/// The inputs and outputs that a component of an open role declares.
struct OpenSlots {
  std::vector<std::string> needs, reads, produces;  ///< [.] names of slots
  std::vector<std::string> records;  ///< types that it declares, "image/1", "acme.depth/1"
};

/// The rules of such a component: those of its role, with its slots in the method. A slot is that
/// of any role's input, or a vendor's record type without its version; it makes what passes make,
/// and records of vendors. Fails with a sentence that names the slot.
Result<RoleRules> rules_with(const RoleRules& open, const OpenSlots& slots);

}  // namespace weft
