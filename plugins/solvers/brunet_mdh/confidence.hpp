// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::brunet_mdh {

/// The probability that the mean error of the visible vertices is below 2 % of the template's
/// diagonal. It is a logistic function, fitted to shapes with ground truth, see README.md. `strain`
/// is the mean |d / l0 - 1| over the distances of the program.
double confidence(double strain, int agreeing_matches);

}  // namespace weft::brunet_mdh
