// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "yaml/key_table.hpp"

namespace weft::lab {

inline constexpr std::int64_t kLargestSeed = 1'000'000'000;  ///< limit of seeds of data and of runs

/// The keys of a plan.
const yaml::KeyTable& plan_keys();

/// The keys of an axis of one setting or of patches, and of an axis of components.
const yaml::KeyTable& axis_keys();
const yaml::KeyTable& component_axis_keys();

/// The keys of a patch of a pipeline, and those of them that are a value of an axis or data.
const yaml::KeyTable& patch_keys();
const yaml::KeyTable& axis_value_keys();
const yaml::KeyTable& data_keys();

/// The keys of `metrics`, of `cluster`, and of an entry of `comparisons` and of `expect`.
const yaml::KeyTable& measurement_keys();
const yaml::KeyTable& cluster_keys();
const yaml::KeyTable& comparison_keys();
const yaml::KeyTable& expectation_keys();

/// Names that no axis may have: words of `where` and columns of tables.
const std::vector<std::string>& reserved_axis_names();

}  // namespace weft::lab
