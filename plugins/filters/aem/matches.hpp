// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>

#include "common/candidates.hpp"

namespace weft::aem {

/// The matches among which a coherent set is sought.
struct Matches {
  Points2 template_px, image_px;           ///< [n,2]
  Eigen::ArrayXd log_scale, turn_rad;      ///< [n] of the keypoints, or empty
  double width_px = 0.0, height_px = 0.0;  ///< of the template's texture
  double image_area_px2 = 0.0;             ///< of the box around the image points

  Eigen::Index count() const { return template_px.rows(); }
  double diagonal_px() const { return std::hypot(width_px, height_px); }
  bool oriented() const { return log_scale.size() > 0; }
};

/// The candidates; their scales and angles where `use_orientation` and the matches have both.
Matches matches_of(const Correspondences& correspondences, const filters::Candidates& candidates,
                   const Template& templ, bool use_orientation);

}  // namespace weft::aem
