// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft::mask {

/// Where the mesh is expected in the image.
struct Prediction {
  Points2 vertices_px;      ///< [V,2] px
  Eigen::VectorXd depth_m;  ///< [V] m; empty if it is not known
  bool is_exact = false;    ///< true for a shape: the texture can be compared with the image
};

/// The vertices of a shape, projected; nothing if one is not in front of the camera.
std::optional<Prediction> from_shape(const Shape& shape, const Camera& camera);

/// The vertices by the affine map from texture to image with the least sum of distances to the kept
/// matches. Nothing for fewer than ten of them or for matches on a line.
std::optional<Prediction> from_matches(const Correspondences& matches, const Template& templ);

/// A part of the image, reduced in size.
struct Crop {
  cv::Rect area;       ///< px of the image
  double scale = 1.0;  ///< size of a reduced pixel's side is 1 / scale px

  cv::Size size() const {
    return {std::max(1, static_cast<int>(area.width * scale)),
            std::max(1, static_cast<int>(area.height * scale))};
  }
  /// From the image to the reduced crop, both with pixel centres at integers.
  cv::Point2f inside(double x_px, double y_px) const {
    const cv::Size reduced = size();
    return {static_cast<float>((x_px - area.x + 0.5) * reduced.width / area.width - 0.5),
            static_cast<float>((y_px - area.y + 0.5) * reduced.height / area.height - 0.5)};
  }
};

/// The box of the prediction and a share of its longer side around it, within the image; empty if
/// they do not meet.
cv::Rect box_around(const Prediction& prediction, double margin, int width_px, int height_px);

/// The mesh rendered into a crop.
struct Rendering {
  cv::Mat inside;      ///< u8, 255 where the mesh is
  cv::Mat texture_px;  ///< f32 x 2, px of the texture there
};
Rendering render(const Prediction& prediction, const Template& templ, const Crop& crop);

}  // namespace weft::mask
