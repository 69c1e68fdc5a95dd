// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::brunet_mdh {

/// The probability that the mean error of what the camera sees is below 2 % of the template's
/// diagonal: a logistic fitted to shapes of which the truth is known, see README.md. `strain` is
/// the mean |d / l0 - 1| over the distances of the program.
double confidence(double strain, int agreeing_matches);

}  // namespace weft::brunet_mdh
