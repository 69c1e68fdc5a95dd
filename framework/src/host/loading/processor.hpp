// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace weft::host {

/// Instruction sets, by the names that manifests use, that this processor has: "avx2", "fma".
std::vector<std::string> processor_features();

/// Whether it has this one; false for a name that is not known.
bool processor_has(std::string_view feature);

/// Whether a name is known: that of a feature that this or another processor may have.
bool is_processor_feature(std::string_view name);

/// What the processor calls itself; "unknown" where the system does not say.
std::string processor_name();

}  // namespace weft::host
