// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"

namespace weft::view {

/// Blurs the rendered pixels of a level with a normal kernel of this standard deviation in px of
/// the level; pixels where nothing is rendered do not count.
void blur_drawn(double sigma_px, ViewLevel& level);

/// Standard deviation, in px of the image, of the blur that makes the rendered view as smooth as
/// the image there. It is at most `most_px`, and 0 if the image is about as sharp. The energies of
/// the gradients relative to the contrast are compared at level `k`. The view is displaced by
/// `shift_px` (px of the image); an error of a few px does not matter.
double blur_of_image(const PredictedView& view, const Pyramid& image, int k,
                     const Eigen::Vector2d& shift_px, double most_px);

}  // namespace weft::view
