// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>

#include "common/pictures/picture.hpp"

namespace weft::collins_integrated {

using pictures::at_level;
using pictures::Picture;
using pictures::Pyramid;

/// A point of the texture at which something changes.
struct Sample {
  Eigen::Vector2d template_px = Eigen::Vector2d::Zero();  ///< [2] px of the texture
  std::int32_t face = -1;                                 ///< []
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();      ///< [3] in that face, sum 1
};

/// One sample for each of about `most` square cells of the mesh in the texture. It is where the
/// grey levels are steepest, at the size at which a camera sees a surface that fills 0.7 of its
/// image. Cells without an edge of 3 grey levels a px have none; around a sample 4 px belong to the
/// object. Fails on an invalid mesh.
Result<void> choose_samples(const Template& templ, const Pyramid& texture, const Camera& camera,
                            int most, std::vector<Sample>& samples);

}  // namespace weft::collins_integrated
