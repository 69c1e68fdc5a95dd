// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "scale_plan.hpp"

/// SIFT as Lowe 2004 and the README define it: in doubles, by the definition, without regard to
/// time.
namespace weft::sift_gpu::reference {

/// Grey levels, one row of the image a row.
using Plane = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The largest relative error of a float that was rounded once.
inline constexpr double kRoundoff = 0x1.0p-24;

/// A triangle of height 1 over [-1, 1]: what a sample gives to a bin this far from it.
inline double share(double distance) { return std::max(0.0, 1.0 - std::abs(distance)); }

/// Row-major floats as a plane and back.
Plane plane_of(const float* values, int width, int height);
std::vector<float> floats_of(const Plane& plane);

/// The same in numbers that floats can hold, as a kernel is given it.
Plane rounded(const Plane& plane);

/// Twice the size, linear between pixel centres, constant beyond them; pixel edges are aligned.
Plane doubled(const Plane& image);

/// Every second pixel of every second row.
Plane halved(const Plane& image);

/// exp(-i^2 / 2 sigma^2) for i = -radius ... radius, its sum 1.
Eigen::VectorXd gaussian(double sigma_px, int radius);

/// sum_ij column[i] row[j] image(y + i, x + j), the image mirrored at its outermost pixel centres.
Plane convolved(const Plane& image, const Eigen::VectorXd& column, const Eigen::VectorXd& row);

/// The layers of each octave of an image of grey levels 0 to 255, each blurred from the one before.
std::vector<std::vector<Plane>> pyramid(const Plane& image, const Settings& settings);

struct Extremum {
  double x, y;      ///< px
  double scale;     ///< sigma, px
  double response;  ///< grey levels 0 to 1
  int layer;
};

/// Refined extrema of the differences of these layers, as in the README. A sample counts from a
/// grey level of half the contrast on, rounded down, as in OpenCV.
std::vector<Extremum> extrema(const std::vector<Plane>& layers, const Settings& settings);

/// Directions in [0, 2 pi), ascending, of the peaks of the smoothed histogram of 36 bins around the
/// pixel nearest to (x, y).
std::vector<double> orientations(const Plane& layer, double x, double y, double scale);

/// The descriptor before it is rounded to integers. Cells are counted along the keypoint's
/// direction first, then across it; directions anticlockwise, as in OpenCV.
std::array<double, 128> descriptor(const Plane& layer, double x, double y, double scale,
                                   double angle_rad);

}  // namespace weft::sift_gpu::reference
