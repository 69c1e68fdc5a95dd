// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/data/template.hpp>
#include <weft/generators/marker_sheet.hpp>
#include <weft/generators/sheet_motion.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "common/cameras/tests/frame_folder.hpp"

namespace weft::testing {

/// Pixels of an image without a copy.
inline cv::Mat view(const Array<std::uint8_t>& pixels) {
  return {static_cast<int>(pixels.dim(0)), static_cast<int>(pixels.dim(1)),
          pixels.ndim() == 2 ? CV_8UC1 : CV_8UC3, const_cast<std::uint8_t*>(pixels.data()),
          to_index(pixels.row_stride())};
}

/// Blots of all sizes, in which no two places are alike.
inline cv::Mat blots(int width, int height) {
  constexpr std::uint64_t kSeed = 3;
  Rng rng(kSeed);
  cv::Mat picture(height, width, CV_8UC1, cv::Scalar(150));
  for (int i = 0; i < 900; ++i) {
    const double radius = std::exp(rng.uniform(std::log(4.0), std::log(60.0)));
    const cv::Point centre(static_cast<int>(rng.below(static_cast<unsigned>(width))),
                           static_cast<int>(rng.below(static_cast<unsigned>(height))));
    cv::circle(picture, centre, static_cast<int>(radius), cv::Scalar(rng.uniform(20.0, 240.0)),
               cv::FILLED);
  }
  cv::GaussianBlur(picture, picture, {0, 0}, 1.5);
  return picture;
}

/// A sheet of paper with markers that sources/synthetic films: 640 x 480 px, f = 820 px, 0.6 m
/// away. It moves and bends, with a ground truth in closed form.
class FilmedSheet {
 public:
  static constexpr int kTexelsPerMm = 6;

  FilmedSheet() {
    PluginUnderTest plugin("templates/frex_sheet",
                           "{px_per_mm: " + std::to_string(kTexelsPerMm) + "}");
    const auto templ = plugin.process(0, {}).get<Template>();
    if (!templ) throw std::runtime_error("no sheet");
    folder.write_image("sheet.png", view(templ->texture));
    folder.write("sheet.yaml", to_yaml(*lay_out_markers({})));
    folder.write_image("poster.png", blots(1188, 840));
    motion.centre_m = {0.1485 - 0.5 * kPitch_m, 0.105 - 0.5 * kPitch_m};
  }

  /// Parameters of a synthetic film of a texture.
  std::string film(const std::string& print, const std::string& more = "") const {
    return "{texture: '" + folder.path(print) + "', width_m: 0.297, height_m: 0.21, frames: 200" +
           more + "}";
  }

  /// Parameters of sources/frex_video on the film of the markers.
  std::string scene(const std::string& more = "", const std::string& of_film = "") const {
    return "{frames: {use: sources/synthetic, params: " + film("sheet.png", of_film) +
           "}, layout: '" + folder.path("sheet.yaml") + "', texture: '" +
           folder.path("poster.png") + "'" + more + "}";
  }

  /// The true shape of the paper in a frame.
  DevelopableSheet true_sheet(int frame) const { return *motion.at(frame / 30.0); }

  /// The place of a point of such a paper, mm from its top left corner.
  static Eigen::Vector3d point_m(const DevelopableSheet& sheet, const Eigen::Vector2d& point_mm) {
    const Eigen::Vector2d xy_m = (0.001 * point_mm).array() - 0.5 * kPitch_m;
    return sheet.at(xy_m.x(), xy_m.y());
  }

  FrameFolder folder;
  SheetMotion motion;
  Pinhole camera{820.0, 820.0, 319.5, 239.5};

 private:
  static constexpr double kPitch_m = 0.001 / kTexelsPerMm;
};

}  // namespace weft::testing
