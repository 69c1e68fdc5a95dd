// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/object_box.hpp>

#include "common/candidates.hpp"

namespace weft::aem {

/// The matches among which a coherent set is sought.
struct Matches {
  Points2 template_px, image_px;       ///< [n,2]
  Eigen::ArrayXd log_scale, turn_rad;  ///< [n] of the keypoints, or empty
  TextureBox box;                      ///< box of the object in the texture
  double image_area_px2 = 0.0;         ///< area of the box around the image points

  Eigen::Index count() const { return template_px.rows(); }
  double diagonal_px() const { return std::hypot(box.width_px(), box.height_px()); }
  double area_px2() const { return box.width_px() * box.height_px(); }
  bool oriented() const { return log_scale.size() > 0; }
};

/// The candidates; their scales and angles where `use_orientation` and the matches have both.
Matches matches_of(const Correspondences& correspondences, const filters::Candidates& candidates,
                   const Template& templ, bool use_orientation);

}  // namespace weft::aem
