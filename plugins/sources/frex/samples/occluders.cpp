// SPDX-License-Identifier: Apache-2.0
#include "samples/occluders.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::frex {
namespace {

constexpr std::int32_t kThingMesh = 2;
constexpr int kShift = 4;  // binary digits of a pixel's fraction

cv::Point fixed(const Eigen::Vector2d& at_px) {
  constexpr double kScale = 1 << kShift;
  return {static_cast<int>(std::lround(kScale * at_px.x())),
          static_cast<int>(std::lround(kScale * at_px.y()))};
}

/// Coverage of each pixel by one thing, 0 to 255.
cv::Mat random_thing(const scene::View& view, const Eigen::Vector2d& middle_px, double size_px,
                     Rng& rng) {
  cv::Mat cover = cv::Mat::zeros(view.image.height, view.image.width, CV_8UC1);
  const double turn_rad = rng.uniform(0.0, M_PI), slim = rng.uniform(0.3, 1.0);
  const Eigen::Vector2d along(std::cos(turn_rad), std::sin(turn_rad)),
      across(-along.y(), along.x());
  const std::uint32_t kind = rng.below(3);
  if (kind == 0) {
    cv::ellipse(cover, fixed(middle_px),
                {static_cast<int>(size_px * (1 << kShift)),
                 static_cast<int>(slim * size_px * (1 << kShift))},
                turn_rad * 180.0 / M_PI, 0.0, 360.0, cv::Scalar(255), cv::FILLED, cv::LINE_AA,
                kShift);
  } else if (kind == 1) {
    const Eigen::Vector2d a = size_px * along, b = slim * size_px * across;
    const std::array<cv::Point, 4> corners{fixed(middle_px - a - b), fixed(middle_px + a - b),
                                           fixed(middle_px + a + b), fixed(middle_px - a + b)};
    cv::fillConvexPoly(cover, corners.data(), 4, cv::Scalar(255), cv::LINE_AA, kShift);
  } else {
    // A finger comes from far outside and ends on the surface.
    const double far_px = 2.0 * (view.image.width + view.image.height);
    const int thick_px = std::max(2, static_cast<int>(0.4 * slim * size_px));
    cv::line(cover, fixed(middle_px), fixed(middle_px + far_px * across), cv::Scalar(255), thick_px,
             cv::LINE_AA, kShift);
  }
  return cover;
}

/// A smooth surface of one colour, as of skin or a sleeve, darker towards one side.
Picture smooth_filling(int width, int height, Rng& rng) {
  constexpr double kLeast_grey = 30.0, kMost_grey = 235.0, kTint = 40.0, kMostShade = 0.5;
  scene::Colour colour = scene::Colour::Zero();
  const double grey = rng.uniform(kLeast_grey, kMost_grey);
  for (int k = 0; k < 3; ++k) {
    colour[k] = static_cast<float>(std::clamp(grey + rng.uniform(-kTint, kTint), 0.0, 255.0));
  }
  const double direction_rad = rng.uniform(0.0, 2.0 * M_PI), shade = rng.uniform(0.0, kMostShade);
  const double along_x = std::cos(direction_rad) * shade / width;
  const double along_y = std::sin(direction_rad) * shade / height;
  Picture filling{width, height};
  filling.pixels.reserve(to_index(width) * to_index(height));
  for (int y = 0; y < height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < width; ++x) {
      const double light = 1.0 + along_x * (x - 0.5 * width) + along_y * (y - 0.5 * height);
      filling.pixels.push_back(static_cast<float>(light) * colour);
    }
  }
  return filling;
}

void paint(const cv::Mat& cover, const Picture& filling, scene::View& view) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr std::uint8_t kMostly = 128;
  for (int y = 0; y < cover.rows; ++y) {
    ask_to_go_on();
    const std::uint8_t* row = cover.ptr(y);
    for (int x = 0; x < cover.cols; ++x) {
      if (row[x] == 0) continue;
      const std::size_t k = to_index(y) * to_index(cover.cols) + to_index(x);
      const float share = static_cast<float>(row[x]) / 255.0F;
      view.image.pixels[k] = share * filling.pixels[k] + (1.0F - share) * view.image.pixels[k];
      if (row[x] < kMostly) continue;
      view.hits[k].mesh = kThingMesh;
      view.depth_m(y, x) = 0.0F;
      view.uv_px.row(y)[2 * x] = view.uv_px.row(y)[2 * x + 1] = kNone;
    }
  }
}

void hide_vertices(const cv::Mat& cover, const Points2& vertices_px, scene::View& view) {
  for (Eigen::Index v = 0; v < vertices_px.rows(); ++v) {
    if (view.is_visible[to_index(v)] == 0) continue;
    const auto x = static_cast<int>(std::lround(vertices_px(v, 0)));
    const auto y = static_cast<int>(std::lround(vertices_px(v, 1)));
    if (x < 0 || y < 0 || x >= cover.cols || y >= cover.rows) continue;
    if (cover.at<std::uint8_t>(y, x) >= 128) view.is_visible[to_index(v)] = 0;
  }
}

}  // namespace

void cover_at_random(int count, const Picture& textured, const Points2& vertices_px, Rng& rng,
                     scene::View& view) {
  const Eigen::RowVector2d extent_px =
      vertices_px.colwise().maxCoeff() - vertices_px.colwise().minCoeff();
  for (int k = 0; k < count; ++k) {
    const auto vertex = rng.below(static_cast<std::uint32_t>(vertices_px.rows()));
    const double size_px = extent_px.norm() * rng.uniform(0.06, 0.42);
    const cv::Mat cover = random_thing(view, vertices_px.row(vertex).transpose(), size_px, rng);
    if (rng.below(2) == 0) {
      paint(cover, textured, view);
    } else {
      paint(cover, smooth_filling(view.image.width, view.image.height, rng), view);
    }
    hide_vertices(cover, vertices_px, view);
  }
}

}  // namespace weft::frex
