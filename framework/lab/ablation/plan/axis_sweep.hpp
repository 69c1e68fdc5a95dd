// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/ablation/plan/plan.hpp"

namespace weft::lab {

/// A number that an axis runs through, or several, each in a family of its values.
struct AxisSweep {
  std::string name;             ///< name of the axis, if its values are labelled by the number, or
                                ///< of the setting
  std::vector<double> numbers;  ///< one a value; NaN: the value sets something else
  /// Where there are several families, the one of each value, empty for none: what the names of
  /// its values begin with ("tran" of "tran_0.05"), or the setting.
  std::vector<std::string> families;
};

/// The number that at least three values of an axis set alone. It comes from their names, else from
/// the setting in which they differ while all their other settings are the same.
std::optional<AxisSweep> sweep_of(const Axis& axis);

}  // namespace weft::lab
