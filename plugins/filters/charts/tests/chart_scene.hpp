// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::charts {

/// Three sides of a cube of 0.1 m that share a corner, each a chart with its own vertices, turned
/// by a quarter from chart to chart in the texture. The corner points to the camera, 0.45 m away.
struct ChartScene {
  static constexpr int kSide = 8;           ///< vertices along a side
  static constexpr double kSidePx = 200.0;  ///< [] px of the texture
  static constexpr int kFacesPerChart = 2 * (kSide - 1) * (kSide - 1);

  Template templ;
  Camera camera = testing::make_camera();
  Faces faces;
  Points3 vertices_m;  ///< [V,3] m, camera frame
  Eigen::Matrix3d rotation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1.0, 1.0, 1.0),
                                                                Eigen::Vector3d(0.0, 0.0, -1.0))
                                 .toRotationMatrix();

  ChartScene() {
    constexpr std::int64_t kVertices = 3 * kSide * kSide;
    templ.vertices_m = Array<double>({kVertices, 3});
    templ.flat_px = Array<double>({kVertices, 2});
    templ.faces = Array<std::int32_t>({3 * kFacesPerChart, 3});
    for (int chart = 0; chart < 3; ++chart) add_chart(chart);
    templ.m_per_px = Array<double>({2}, 0.1 / kSidePx);
    templ.texture = Array<std::uint8_t>({400, 960}, 128);
    templ.mask = Array<std::uint8_t>({400, 960}, 1);
    faces = templ.faces.matrix<3>();
    vertices_m = templ.vertices_m.matrix<3>() * rotation.transpose();
    vertices_m.col(2).array() += 0.45;
  }

  /// A chart without the others, with the vertices and faces of the first.
  static bool is_of_chart(std::int32_t face, int chart) { return face / kFacesPerChart == chart; }

 private:
  void add_chart(int chart) {
    const double turn_rad = 0.5 * std::numbers::pi * chart;
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const std::int64_t v = (static_cast<std::int64_t>(chart) * kSide + j) * kSide + i;
        const double a = static_cast<double>(i) / (kSide - 1) - 0.5;
        const double b = static_cast<double>(j) / (kSide - 1) - 0.5;
        templ.vertices_m(v, chart) = 0.05;
        templ.vertices_m(v, (chart + 1) % 3) = 0.1 * a;
        templ.vertices_m(v, (chart + 2) % 3) = 0.1 * b;
        const Eigen::Vector2d local(a, -b);  // b upwards, v downwards
        const Eigen::Vector2d place_px =
            kSidePx * (Eigen::Rotation2Dd(turn_rad) * local) +
            Eigen::Vector2d(150.0 + 300.0 * chart, 150.0 + 50.0 * chart);
        templ.flat_px(v, 0) = place_px.x();
        templ.flat_px(v, 1) = place_px.y();
      }
    }
    std::int64_t f = static_cast<std::int64_t>(chart) * kFacesPerChart;
    for (std::int32_t j = 0; j + 1 < kSide; ++j) {
      for (std::int32_t i = 0; i + 1 < kSide; ++i) {
        const std::int32_t p = (chart * kSide + j) * kSide + i, q = p + 1, r = q + kSide,
                           s = p + kSide;
        for (const std::array<std::int32_t, 3>& corners :
             {std::array{p, q, r}, std::array{p, r, s}}) {
          for (std::size_t k = 0; k < 3; ++k) {
            templ.faces(f, static_cast<std::int64_t>(k)) = corners[k];
          }
          ++f;
        }
      }
    }
  }
};

/// Matches of a scene; `correct` is the truth.
struct SceneMatches {
  Correspondences matches;
  std::vector<std::uint8_t> correct;
  std::vector<int> chart;
};

/// `counts[c]` matches of chart c with noise of 0.7 px; the share `wrong` of them is anywhere in
/// the image.
inline SceneMatches matches_of(const ChartScene& scene, const std::array<int, 3>& counts,
                               double wrong, std::uint64_t seed) {
  std::cout << "seed " << seed << "\n";
  Rng rng(seed);
  SceneMatches made;
  const std::int64_t count = counts[0] + counts[1] + counts[2];
  Correspondences& all = made.matches;
  all.template_px = Array<double>({count, 2}, 0.0);
  all.image_px = Array<double>({count, 2}, 0.0);
  all.face = Array<std::int32_t>({count}, 0);
  all.barycentrics = Array<double>({count, 3}, 0.0);
  all.kept = Array<std::uint8_t>({count}, 1);
  all.score = Array<double>({count}, 1.0);
  for (int chart = 0; chart < 3; ++chart) {
    for (int k = 0; k < counts[to_index(chart)]; ++k) {
      const auto i = static_cast<std::int64_t>(made.chart.size());
      double a = rng.uniform(), b = rng.uniform();
      if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
      const Eigen::Vector3d weights(1.0 - a - b, a, b);
      all.face(i) = chart * ChartScene::kFacesPerChart +
                    static_cast<std::int32_t>(rng.below(ChartScene::kFacesPerChart));
      all.barycentrics.matrix<3>().row(i) = weights.transpose();
      all.template_px.matrix<2>().row(i) =
          interpolate(scene.templ.flat_px.matrix<2>(), scene.faces, all.face(i), weights)
              .transpose();
      Eigen::Vector2d pixel =
          project(testing::pinhole(scene.camera),
                  interpolate(scene.vertices_m, scene.faces, all.face(i), weights));
      pixel += 0.7 * Eigen::Vector2d(rng.normal(), rng.normal());
      const bool is_wrong = k < wrong * counts[to_index(chart)];
      if (is_wrong) pixel = Eigen::Vector2d(rng.uniform(0.0, 639.0), rng.uniform(0.0, 479.0));
      all.image_px.matrix<2>().row(i) = pixel.transpose();
      made.correct.push_back(is_wrong ? 0 : 1);
      made.chart.push_back(chart);
    }
  }
  return made;
}

/// Moves the matches of a chart in the image.
inline void displace(SceneMatches& made, int chart, const Eigen::RowVector2d& by_px) {
  for (std::size_t i = 0; i < made.chart.size(); ++i) {
    if (made.chart[i] != chart) continue;
    made.matches.image_px.matrix<2>().row(static_cast<Eigen::Index>(i)) += by_px;
  }
}

inline testing::PluginAnswer run_filter(testing::PluginUnderTest& plugin, const ChartScene& scene,
                                        const Correspondences& matches) {
  return plugin.process(
      0, {testing::input("correspondences", matches), testing::input("template", scene.templ),
          testing::input("camera", scene.camera)});
}

/// Share of the chart's inliers or outliers that a mask keeps.
inline double kept_share(const InlierMask& mask, const SceneMatches& made, int chart,
                         bool correct = true) {
  double kept = 0.0, all = 0.0;
  for (std::size_t i = 0; i < made.chart.size(); ++i) {
    if (made.chart[i] != chart || (made.correct[i] != 0) != correct) continue;
    ++all;
    kept += mask.kept(static_cast<std::int64_t>(i)) != 0 ? 1.0 : 0.0;
  }
  return all == 0.0 ? 0.0 : kept / all;
}

}  // namespace weft::charts
