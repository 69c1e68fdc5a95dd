// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/geometry/types.hpp>

namespace weft::learned {

/// The matches that the network judges. Lengths in the image are in px of the training, where an
/// inlier is nearer than 3 px to its true place.
struct MatchSet {
  Points2 template_px, image_px;  ///< [n,2]
  std::vector<double> log_scale;  ///< [n] of image scale / template scale, or empty
  std::vector<double> angle_rad;  ///< [n] image minus template, or empty
  std::vector<double> ratio;      ///< [n] of descriptor distances, or empty
  double half_diagonal_px = 1.0;  ///< half the diagonal of the texture

  Eigen::Index count() const { return template_px.rows(); }
};

/// Positions without translation and scale, the image also without rotation.
struct Normalised {
  Points2 p;                      ///< [n,2] template, in half diagonals
  Points2 q;                      ///< [n,2] image, in RMS radii, turned by -turn_rad
  double rms_px = 0.0;            ///< RMS distance of the image points from their mean
  double turn_rad = 0.0;          ///< best rotation from p to q
  std::vector<double> scale;      ///< [n] log_scale minus its mean, within +- 3; or empty
  std::vector<double> angle_rad;  ///< [n] minus turn_rad; or empty
};

Normalised normalised(const MatchSet& matches);

constexpr int kInputs = 15;
constexpr int kFitInputs = 9;

/// Inputs of the network, a column for each match.
Eigen::MatrixXf inputs_of(const MatchSet& matches, const Normalised& places);

/// Residuals of each match beside an affine, a cubic and a local map, which are fitted to all
/// others. Two more inputs compare its scale and angle with the cubic map. `weight` is [n] in
/// [0,1].
Eigen::MatrixXf fit_inputs_of(const Normalised& places, const Eigen::VectorXd& weight);

}  // namespace weft::learned
