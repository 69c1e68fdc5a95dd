// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <iostream>
#include <span>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

#include "filmed_sheet.hpp"

/// Compares the output of sources/frex_video for a film of the marker sheet of paper with the exact
/// ground truth.
namespace weft::testing {

inline constexpr double kPosterPitch_mm = 0.25;

struct OpenedSource : PluginUnderTest {
  explicit OpenedSource(const std::string& params, const std::string& id = "sources/frex_video")
      : PluginUnderTest(id, params) {
    const PluginAnswer opened = process(kOpen, {});
    EXPECT_EQ(opened.status, WEFT_OK) << opened.message;
  }
  PluginAnswer frame(int index) { return process(kRead, {}, static_cast<std::uint64_t>(index)); }
};

/// Distances in mm of the truth of some frames from the exact one.
inline std::vector<double> truth_errors_mm(const FilmedSheet& filmed, std::span<const int> frames,
                                           const std::string& truth) {
  OpenedSource source(filmed.scene(", truth: " + truth, ", noise_grey: 1.5"));
  std::vector<double> errors_mm;
  for (const int index : frames) {
    const PluginAnswer frame = source.frame(index);
    EXPECT_EQ(frame.status, WEFT_OK) << index << frame.message;
    const auto found = frame.get<GroundTruth>();
    if (!found) continue;
    EXPECT_EQ(found->kind, truth);
    const DevelopableSheet sheet = filmed.true_sheet(index);
    for (std::int64_t k = 0; k < found->count(); ++k) {
      const Eigen::Vector2d xy_mm = 1000.0 * found->template_xy_m.matrix<2>().row(k).transpose();
      const Eigen::Vector3d exact =
          FilmedSheet::point_m(sheet, xy_mm.array() + 0.5 * kPosterPitch_mm);
      errors_mm.push_back(1000.0 * (found->points_m.matrix<3>().row(k).transpose() - exact).norm());
    }
  }
  return errors_mm;
}

/// Expects that a texture put onto the film looks as if it had been filmed itself.
inline void expect_the_print_as_if_filmed(FilmedSheet& sheet_film, std::span<const int> frames,
                                          std::size_t least_pixels) {
  OpenedSource made(sheet_film.scene(", ambient: 1, noise_grey: 0, blur_px: 0", ", noise_grey: 0"));
  OpenedSource filmed(sheet_film.film("poster.png", ", noise_grey: 0"), "sources/synthetic");
  cv::Mat white(84, 119, CV_8UC1, cv::Scalar(255));
  sheet_film.folder.write_image("white.png", white);
  OpenedSource blank(sheet_film.film("white.png", ", noise_grey: 0"), "sources/synthetic");
  std::vector<double> differences_grey, flow_px;
  for (const int index : frames) {
    const PluginAnswer frame = made.frame(index);
    ASSERT_EQ(frame.status, WEFT_OK) << index << frame.message;
    const cv::Mat3b picture = view(frame.get<Image>()->pixels);
    const PluginAnswer filmed_frame = filmed.frame(index), blank_frame = blank.frame(index);
    const cv::Mat1b expected = view(filmed_frame.get<Image>()->pixels);
    const cv::Mat1b brightness = view(blank_frame.get<Image>()->pixels);
    const auto uv_m = frame.get<GroundTruth>()->uv_m;
    const DevelopableSheet sheet = sheet_film.true_sheet(index);
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        const Eigen::Vector2d uv_mm = 1000.0 * Eigen::Vector2d(uv_m(y, 2 * x), uv_m(y, 2 * x + 1));
        if (!uv_mm.allFinite()) continue;
        differences_grey.push_back(
            std::abs(picture(y, x)[1] * brightness(y, x) / 255.0 - expected(y, x)));
        const Eigen::Vector3d seen =
            FilmedSheet::point_m(sheet, uv_mm.array() + 0.5 * kPosterPitch_mm);
        flow_px.push_back((project(sheet_film.camera, seen) - Eigen::Vector2d(x, y)).norm());
      }
    }
  }
  std::cout << "grey levels: median " << median(differences_grey) << ", 95 % "
            << percentile(differences_grey, 95.0) << "; flow: median " << median(flow_px)
            << " px, 95 % " << percentile(flow_px, 95.0) << " px over " << flow_px.size()
            << " pixels\n";
  EXPECT_GT(flow_px.size(), least_pixels);
  EXPECT_LE(median(differences_grey), 1.5);
  EXPECT_LE(median(flow_px), 0.2);
  EXPECT_LE(percentile(flow_px, 99.0), 0.7);
}

/// Expects that the surface is more accurate than each marker by itself.
inline void expect_the_surface_to_be_known(const FilmedSheet& filmed, std::span<const int> frames) {
  const std::vector<double> surface_mm = truth_errors_mm(filmed, frames, "surface");
  const std::vector<double> markers_mm = truth_errors_mm(filmed, frames, "markers");
  std::cout << "surface: median " << median(surface_mm) << " mm, 95 % "
            << percentile(surface_mm, 95.0) << " mm, worst " << percentile(surface_mm, 100.0)
            << " mm of " << surface_mm.size() << "; markers: median " << median(markers_mm)
            << " mm, 95 % " << percentile(markers_mm, 95.0) << " mm of " << markers_mm.size()
            << "\n";
  EXPECT_LT(median(surface_mm), 0.5);
  EXPECT_LT(percentile(surface_mm, 95.0), 1.5);
  EXPECT_LT(3.0 * median(surface_mm), median(markers_mm));
}

}  // namespace weft::testing
