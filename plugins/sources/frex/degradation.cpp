// SPDX-License-Identifier: Apache-2.0
#include "degradation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/images/jpeg_decoder.hpp"
#include "common/scene/sensor.hpp"

namespace weft::frex {
namespace {

constexpr std::int32_t kHandMesh = 2;  // stands for the hand in View::hits

using scene::Colour;

/// A bar with round ends: a finger, the palm, the wrist. Lengths are those of the hand, whose palm
/// has its middle at 0; x goes to the right and y down when the fingers point up.
struct Bar {
  double x0, y0, x1, y1, radius;

  /// From the axis over the radius: 1 on the outline, less within.
  double distance(double x, double y) const {
    const double dx = x1 - x0, dy = y1 - y0;
    const double s = std::clamp(((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    return std::hypot(x - x0 - s * dx, y - y0 - s * dy) / radius;
  }
};

constexpr std::array<Bar, 7> kHand{{{-0.25, 0.0, 0.25, 0.05, 0.62},    // palm
                                    {0.1, 0.4, 0.25, 3.5, 0.5},        // wrist and arm
                                    {-0.55, -0.4, -0.95, -1.75, 0.2},  // fingers, spread
                                    {-0.2, -0.5, -0.3, -2.05, 0.21},
                                    {0.17, -0.5, 0.35, -1.95, 0.2},
                                    {0.5, -0.35, 0.9, -1.5, 0.17},
                                    {-0.6, 0.2, -1.5, -0.45, 0.23}}};  // thumb
constexpr double kTurn_rad = -0.65;  // direction of the fingers, from up towards the left

/// A hand in the image.
class Hand {
 public:
  Hand(const Eigen::Vector2d& palm_px, double size_px) : palm_px_(palm_px), size_px_(size_px) {}

  /// Distance of a pixel from the axis of the bar there, over its radius.
  double distance(int x, int y) const {
    const double dx = (x - palm_px_.x()) / size_px_, dy = (y - palm_px_.y()) / size_px_;
    const double cosine = std::cos(kTurn_rad), sine = std::sin(kTurn_rad);
    const double across = cosine * dx + sine * dy, down = -sine * dx + cosine * dy;
    double least = std::numeric_limits<double>::infinity();
    for (const Bar& bar : kHand) least = std::min(least, bar.distance(across, down));
    return least;
  }
  bool covers(int x, int y) const { return distance(x, y) <= 1.0; }

 private:
  Eigen::Vector2d palm_px_;
  double size_px_;
};

/// Skin, darker towards the outline.
Colour skin(double distance, bool is_grey) {
  const double shade = 0.55 + 0.45 * std::sqrt(std::max(0.0, 1.0 - distance * distance));
  Colour colour = static_cast<float>(shade) * Colour(128.0F, 158.0F, 205.0F, 0.0F);
  if (!is_grey) return colour;
  return scene::without_colour({1, 1, {colour}}).pixels.front();
}

}  // namespace

void DegradationSettings::read(Params& p) {
  p.read("motion_blur_px", motion_blur_px, "px", {0.0, 100.0},
         "length of the motion blur, along the mean movement of the surface in the image");
  p.read("readout_s", readout_s, "s", {0.0, 0.1},
         "readout time of a rolling shutter from the first row to the last; 0: global shutter");
  p.read("exposure_stops", exposure_stops, "", {0.0, 4.0},
         "exposure step, up and down every five frames, in stops");
  p.read("hand_share", hand_share, "", {0.0, 0.9},
         "share of the surface in the image that a hand covers");
  p.read("jpeg_quality", jpeg_quality, "", {0, 100},
         "JPEG quality of each image; 0: no compression");
}

Eigen::Vector3d Movement::at(Eigen::Index vertex, double t_s) const {
  const double s = t_s / frame_s;
  const Eigen::RowVector3d before = before_m.row(vertex), now = now_m.row(vertex),
                           after = after_m.row(vertex);
  return (now + 0.5 * s * (after - before) + 0.5 * s * s * (after - 2.0 * now + before))
      .transpose();
}

Points3 as_read(const Pinhole& camera, std::int64_t height_px, double readout_s,
                const Movement& movement) {
  constexpr int kRounds = 8;  // the row of a vertex moves by far less than a row per row read
  Points3 vertices_m = movement.now_m;
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    for (int round = 0; round < kRounds; ++round) {
      const double row = project(camera, vertices_m.row(v).transpose()).y();
      if (!std::isfinite(row)) break;
      const double share = (row + 0.5) / static_cast<double>(height_px) - 0.5;
      vertices_m.row(v) = movement.at(v, readout_s * std::clamp(share, -0.5, 0.5)).transpose();
    }
  }
  return vertices_m;
}

Eigen::Vector2d direction_of(const Pinhole& camera, const Movement& movement) {
  constexpr double kStill_px = 1e-3;  // between two frames
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Eigen::Index v = 0; v < movement.now_m.rows(); ++v) {
    const Eigen::Vector2d moved = project(camera, movement.after_m.row(v).transpose()) -
                                  project(camera, movement.before_m.row(v).transpose());
    if (moved.allFinite()) sum += moved;
  }
  const double mean_px = sum.norm() / static_cast<double>(movement.now_m.rows());
  return mean_px > kStill_px ? sum.normalized() : Eigen::Vector2d::Zero();
}

void blur_along(const Eigen::Vector2d& along_px, scene::Picture& picture) {
  const double length_px = along_px.norm();
  if (length_px <= 0.0) return;
  const int reach = static_cast<int>(std::ceil(0.5 * length_px));
  const int samples = 16 * static_cast<int>(std::ceil(length_px));
  cv::Mat kernel = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_32F);
  for (int k = 0; k < samples; ++k) {
    // Each sample is shared among the four pixels around it.
    const Eigen::Vector2d at = ((k + 0.5) / samples - 0.5) * along_px +
                               Eigen::Vector2d::Constant(static_cast<double>(reach));
    const int x = std::min(static_cast<int>(at.x()), 2 * reach - 1);
    const int y = std::min(static_cast<int>(at.y()), 2 * reach - 1);
    const double right = at.x() - x, below = at.y() - y;
    const auto add = [&](int row, int column, double share) {
      kernel.at<float>(row, column) += static_cast<float>(share / samples);
    };
    add(y, x, (1.0 - below) * (1.0 - right));
    add(y, x + 1, (1.0 - below) * right);
    add(y + 1, x, below * (1.0 - right));
    add(y + 1, x + 1, below * right);
  }
  ask_to_go_on();
  const cv::Mat sharp(picture.height, picture.width, CV_32FC4, picture.pixels.data());
  cv::Mat blurred;
  cv::filter2D(sharp, blurred, -1, kernel, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
  blurred.copyTo(sharp);
}

void cover_by_hand(double share, bool is_grey, const Points2& vertices_px, scene::View& view) {
  const int width = view.image.width, height = view.image.height;
  std::vector<std::array<int, 2>> sheet;
  double x0 = width, y0 = height, x1 = 0.0, y1 = 0.0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (view.hits[to_index(y) * to_index(width) + to_index(x)].mesh != 0) continue;
      sheet.push_back({x, y});
      x0 = std::min(x0, static_cast<double>(x));
      x1 = std::max(x1, static_cast<double>(x));
      y0 = std::min(y0, static_cast<double>(y));
      y1 = std::max(y1, static_cast<double>(y));
    }
  }
  if (sheet.empty() || share <= 0.0) return;
  // The palm is over the right lower part, so that the fingers reach the middle.
  const Eigen::Vector2d palm_px(x0 + 0.68 * (x1 - x0), y0 + 0.68 * (y1 - y0));
  double small_px = 1.0, large_px = 4.0 * std::max(x1 - x0, y1 - y0) + 4.0;
  constexpr int kHalvings = 14;
  for (int k = 0; k < kHalvings; ++k) {
    const double size_px = 0.5 * (small_px + large_px);
    const Hand hand(palm_px, size_px);
    worked(static_cast<std::int64_t>(20 * sheet.size()));
    const auto covered = std::count_if(sheet.begin(), sheet.end(), [&](const auto& pixel) {
      return hand.covers(pixel[0], pixel[1]);
    });
    const bool is_small = static_cast<double>(covered) < share * static_cast<double>(sheet.size());
    (is_small ? small_px : large_px) = size_px;
  }
  const Hand hand(palm_px, 0.5 * (small_px + large_px));
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (int y = 0; y < height; ++y) {
    worked(20L * width);
    for (int x = 0; x < width; ++x) {
      const double distance = hand.distance(x, y);
      if (distance > 1.0) continue;
      view.image.pixels[to_index(y) * to_index(width) + to_index(x)] = skin(distance, is_grey);
      view.depth_m(y, x) = 0.0F;
      view.hits[to_index(y) * to_index(width) + to_index(x)].mesh = kHandMesh;
      view.uv_px.row(y)[2 * x] = view.uv_px.row(y)[2 * x + 1] = kNone;
    }
  }
  for (Eigen::Index v = 0; v < vertices_px.rows(); ++v) {
    if (!vertices_px.row(v).allFinite()) continue;
    const double x = vertices_px(v, 0), y = vertices_px(v, 1);
    if (!(x >= -0.5 && y >= -0.5 && x <= width - 0.5 && y <= height - 0.5)) continue;
    if (hand.covers(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)))) {
      view.is_visible[to_index(v)] = 0;
    }
  }
}

double exposure_gain(double stops, std::int64_t frame) {
  constexpr std::int64_t kFrames = 5;
  constexpr std::array<double, 4> kSteps{0.0, 1.0, 0.0, -1.0};
  return std::exp2(stops * kSteps[to_index(frame / kFrames % 4)]);
}

Result<void> compress(int quality, Array<std::uint8_t>& pixels) {
  const bool is_grey = pixels.ndim() == 2;
  const cv::Mat image(static_cast<int>(pixels.dim(0)), static_cast<int>(pixels.dim(1)),
                      is_grey ? CV_8UC1 : CV_8UC3, pixels.data());
  std::vector<std::uint8_t> file;
  ask_to_go_on();
  if (!cv::imencode(".jpg", image, file, {cv::IMWRITE_JPEG_QUALITY, quality})) {
    return Error{Errc::plugin_failure, "the image cannot be compressed"};
  }
  cv::Mat kept;
  const std::string damage =
      image_files::decode_jpeg(std::string(file.begin(), file.end()), is_grey, kept);
  if (!damage.empty() || kept.size() != image.size() || kept.type() != image.type()) {
    return Error{Errc::plugin_failure, "the compressed image cannot be read: " + damage};
  }
  kept.copyTo(image);
  return {};
}

}  // namespace weft::frex
