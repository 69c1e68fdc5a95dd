// SPDX-License-Identifier: Apache-2.0
#include "unwarping.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/mesh_topology.hpp>

namespace weft::unwarping {
namespace {

/// The most pixels along an axis that OpenCV's remap takes.
constexpr std::int64_t kMostPx = 32'766;
/// Beyond the border of any image.
constexpr float kNowhere = -1e4F;
/// Texels on the edge between two faces belong to both in spite of rounding.
constexpr double kRounding = 1e-9;

std::string size_text(const Array<std::uint8_t>& pixels) {
  return std::to_string(pixels.dim(1)) + " x " + std::to_string(pixels.dim(0));
}

/// Where the camera sees each texel, [H,W] px.
struct PixelMap {
  cv::Mat x_px, y_px;  ///< f32
};

int clamped(double place_px, int size) {
  return static_cast<int>(std::clamp(place_px, 0.0, static_cast<double>(size)));
}

/// Writes the texels whose centres lie in the triangle.
void map_face(const Eigen::Matrix<double, 3, 2>& flat_px, const Eigen::Matrix3d& corners_m,
              const Pinhole& camera, PixelMap& map) {
  Eigen::Matrix3d edges;  // (u, v, 1) of the corners, one a column
  edges << flat_px.transpose(), Eigen::RowVector3d::Ones();
  if (!(std::abs(edges.determinant()) > 0.0)) return;
  const Eigen::Matrix3d to_weights = edges.inverse();
  const Eigen::RowVector2d least = flat_px.colwise().minCoeff(),
                           most = flat_px.colwise().maxCoeff();
  const int left = clamped(std::ceil(least.x() - kRounding), map.x_px.cols);
  const int right = clamped(std::floor(most.x() + kRounding) + 1.0, map.x_px.cols);
  const int top = clamped(std::ceil(least.y() - kRounding), map.x_px.rows);
  const int bottom = clamped(std::floor(most.y() + kRounding) + 1.0, map.x_px.rows);
  for (int v = top; v < bottom; ++v) {
    for (int u = left; u < right; ++u) {
      const Eigen::Vector3d weights = to_weights * Eigen::Vector3d(u, v, 1.0);
      if (weights.minCoeff() < -kRounding) continue;
      const Eigen::Vector3d place_m = corners_m.transpose() * weights;
      if (!(place_m.z() > 0.0)) continue;
      const Eigen::Vector2d pixel = project(camera, place_m);
      map.x_px.at<float>(v, u) = static_cast<float>(pixel.x());
      map.y_px.at<float>(v, u) = static_cast<float>(pixel.y());
    }
  }
}

}  // namespace

cv::Mat matrix_of(const Array<std::uint8_t>& pixels) {
  cv::Mat copy(static_cast<int>(pixels.dim(0)), static_cast<int>(pixels.dim(1)),
               pixels.ndim() == 3 ? CV_8UC3 : CV_8UC1);
  for (int y = 0; y < copy.rows; ++y) {
    std::copy_n(pixels.row(y), pixels.row_elements(), copy.ptr(y));
  }
  return copy;
}

cv::Mat grey_levels(const Array<std::uint8_t>& pixels) {
  const cv::Mat copy = matrix_of(pixels);
  if (copy.type() == CV_8UC1) return copy;
  cv::Mat grey;
  cv::cvtColor(copy, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

Result<void> check_unwarping(const Template& templ, const Image& image, const Shape& shape) {
  if (templ.texture.size() == 0 || image.pixels.size() == 0) {
    return Error{Errc::invalid_data,
                 templ.texture.size() == 0
                     ? "the template has no texture to compare the image with; give it one"
                     : "the image is empty; give at least one pixel",
                 {}};
  }
  for (const auto* pixels : {&templ.texture, &image.pixels}) {
    if (pixels->dim(0) <= kMostPx && pixels->dim(1) <= kMostPx) continue;
    return Error{Errc::invalid_data,
                 "an image of " + size_text(*pixels) + " px is too large, at most " +
                     std::to_string(kMostPx) + " px along an axis can be unwarped; scale it down",
                 {}};
  }
  const std::int64_t vertices = templ.vertices_m.rows();
  if (shape.vertices_m.rows() != vertices || templ.flat_px.rows() != vertices) {
    return Error{Errc::invalid_data,
                 "the shape has " + std::to_string(shape.vertices_m.rows()) +
                     " vertices, the template " + std::to_string(vertices) +
                     ": use one template throughout",
                 {}};
  }
  return check_face_indices(templ.faces.matrix<3>(), vertices);
}

cv::Mat unwarped(const cv::Mat& image, const Template& templ, const Camera& camera,
                 const Shape& shape) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const cv::Size size(static_cast<int>(templ.texture.dim(1)),
                      static_cast<int>(templ.texture.dim(0)));
  PixelMap map{cv::Mat(size, CV_32F, kNowhere), cv::Mat(size, CV_32F, kNowhere)};
  const auto flat_px = templ.flat_px.matrix<2>();
  const auto vertices_m = shape.vertices_m.matrix<3>();
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    ask_to_go_on();
    Eigen::Matrix<double, 3, 2> corners_px;
    Eigen::Matrix3d corners_m;
    for (int k = 0; k < 3; ++k) {
      corners_px.row(k) = flat_px.row(templ.faces(f, k));
      corners_m.row(k) = vertices_m.row(templ.faces(f, k));
    }
    map_face(corners_px, corners_m, pinhole, map);
  }
  cv::Mat texels;
  cv::remap(image, texels, map.x_px, map.y_px, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
            cv::Scalar::all(0));
  return texels;
}

}  // namespace weft::unwarping
