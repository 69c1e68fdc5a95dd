// SPDX-License-Identifier: Apache-2.0
#include "prediction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::mask {
namespace {

constexpr Eigen::Index kFewestMatches = 10;
constexpr int kRounds = 10;
constexpr double kLeastDistance_px = 0.5;

/// Draws one triangle with the nearest depth in front.
class FacePainter {
 public:
  FacePainter(Rendering& to, const cv::Size& size)
      : to_(to), depth_(size, CV_32F, cv::Scalar(std::numeric_limits<float>::max())) {}

  void paint(const std::array<cv::Point2f, 3>& at, const std::array<cv::Vec2f, 3>& texture_px,
             const std::array<float, 3>& depth) {
    const float area = cross(at[1] - at[0], at[2] - at[0]);
    if (!(std::abs(area) > 0.0F)) return;
    const int left = first(std::min({at[0].x, at[1].x, at[2].x}));
    const int top = first(std::min({at[0].y, at[1].y, at[2].y}));
    const int right = last(std::max({at[0].x, at[1].x, at[2].x}), depth_.cols);
    const int bottom = last(std::max({at[0].y, at[1].y, at[2].y}), depth_.rows);
    worked(std::max((right - left + 1) * (bottom - top + 1) / 4, 1));
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        const cv::Point2f place(static_cast<float>(x), static_cast<float>(y));
        const float a = cross(at[1] - place, at[2] - place) / area;
        const float b = cross(at[2] - place, at[0] - place) / area;
        const float c = 1.0F - a - b;
        if (a < 0.0F || b < 0.0F || c < 0.0F) continue;
        const float here = a * depth[0] + b * depth[1] + c * depth[2];
        if (here >= depth_.at<float>(y, x)) continue;
        depth_.at<float>(y, x) = here;
        to_.inside.at<std::uint8_t>(y, x) = 255;
        to_.texture_px.at<cv::Vec2f>(y, x) =
            a * texture_px[0] + b * texture_px[1] + c * texture_px[2];
      }
    }
  }

 private:
  static float cross(const cv::Point2f& a, const cv::Point2f& b) { return a.x * b.y - a.y * b.x; }
  static int first(float value) { return static_cast<int>(std::ceil(std::max(value, 0.0F))); }
  static int last(float value, int size) {
    return static_cast<int>(std::floor(std::min(value, static_cast<float>(size - 1))));
  }

  Rendering& to_;
  cv::Mat depth_;
};

}  // namespace

std::optional<Prediction> from_shape(const Shape& shape, const Camera& camera) {
  const auto vertices_m = shape.vertices_m.matrix<3>();
  if (!vertices_m.allFinite() || !(vertices_m.col(2).minCoeff() > 0.0)) return std::nullopt;
  Prediction prediction;
  prediction.vertices_px = project_points({camera.fx, camera.fy, camera.cx, camera.cy}, vertices_m);
  prediction.depth_m = vertices_m.col(2);
  prediction.is_exact = true;
  return prediction;
}

std::optional<Prediction> from_matches(const Correspondences& matches, const Template& templ) {
  constexpr double kFlattest = 0.05;
  Eigen::MatrixX3d places(matches.count(), 3);
  Points2 pixels(matches.count(), 2);
  Eigen::Index count = 0;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0) continue;
    places.row(count) << matches.template_px(i, 0), matches.template_px(i, 1), 1.0;
    pixels.row(count++) << matches.image_px(i, 0), matches.image_px(i, 1);
  }
  if (count < kFewestMatches) return std::nullopt;
  places.conservativeResize(count, 3);
  pixels.conservativeResize(count, 2);
  const Points2 spread = places.leftCols<2>().rowwise() - places.leftCols<2>().colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> widths(spread.transpose() * spread);
  if (!(widths.eigenvalues()[0] > kFlattest * kFlattest * widths.eigenvalues()[1]))
    return std::nullopt;
  Eigen::Matrix<double, 3, 2> affine;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count);
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixX3d weighted = weights.asDiagonal() * places;
    affine = (places.transpose() * weighted).ldlt().solve(weighted.transpose() * pixels);
    const Eigen::VectorXd distances_px = (places * affine - pixels).rowwise().norm();
    weights = distances_px.cwiseMax(kLeastDistance_px).cwiseInverse();
  }
  if (!affine.allFinite()) return std::nullopt;
  Prediction prediction;
  prediction.vertices_px =
      (templ.flat_px.matrix<2>() * affine.topRows<2>()).rowwise() + affine.row(2);
  return prediction;
}

cv::Rect box_around(const Prediction& prediction, double margin, int width_px, int height_px) {
  const Eigen::RowVector2d least = prediction.vertices_px.colwise().minCoeff();
  const Eigen::RowVector2d most = prediction.vertices_px.colwise().maxCoeff();
  const double more_px = margin * (most - least).maxCoeff();
  const auto within = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const int left = within(std::floor(least.x() - more_px), width_px);
  const int top = within(std::floor(least.y() - more_px), height_px);
  return {left, top, within(std::ceil(most.x() + more_px) + 1.0, width_px) - left,
          within(std::ceil(most.y() + more_px) + 1.0, height_px) - top};
}

Rendering render(const Prediction& prediction, const Template& templ, const Crop& crop) {
  const cv::Size size = crop.size();
  Rendering made{cv::Mat(size, CV_8U, cv::Scalar(0)), cv::Mat(size, CV_32FC2, cv::Scalar(-1, -1))};
  FacePainter painter(made, size);
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    std::array<cv::Point2f, 3> at;
    std::array<cv::Vec2f, 3> texture_px;
    std::array<float, 3> depth{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t v = templ.faces(f, static_cast<std::int64_t>(k));
      at[k] = crop.inside(prediction.vertices_px(v, 0), prediction.vertices_px(v, 1));
      texture_px[k] = {static_cast<float>(templ.flat_px(v, 0)),
                       static_cast<float>(templ.flat_px(v, 1))};
      if (prediction.depth_m.size() > 0) depth[k] = static_cast<float>(prediction.depth_m[v]);
    }
    painter.paint(at, texture_px, depth);
  }
  return made;
}

}  // namespace weft::mask
