// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/data/keypoints.hpp>

namespace weft::matchers {

/// Checks that two sets of keypoints, neither of them empty, can be matched. They must have the
/// same known metric, descriptors of the same length, finite numbers and positive scales. Numbers
/// on a device are not checked. The Error suggests what to change. The numbers of a template that
/// passed before are not read again.
Result<void> check(const Keypoints& templ, const Keypoints& image, bool root_sift,
                   bool template_passed = false);

}  // namespace weft::matchers
