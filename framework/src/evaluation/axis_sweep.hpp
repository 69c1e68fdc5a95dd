// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <weft/evaluation/plan.hpp>

namespace weft::evaluation {

/// A number that an axis runs through.
struct AxisSweep {
  std::string name;             ///< of the axis, where its values are called by the number, or of
                                ///< the setting
  std::vector<double> numbers;  ///< one a value; NaN: the value sets something else
};

/// The number that at least three values of an axis set and nothing else: by their names, or else
/// by the setting that most of them have in common.
std::optional<AxisSweep> sweep_of(const Axis& axis);

}  // namespace weft::evaluation
