// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::salzmann_local {

/// A sheet at 0.6 m, turned by 0.3 rad and bent to a cylinder, and matches on it.
struct LocalScene {
  testing::SheetSpec sheet;
  Template templ;
  Camera camera = testing::make_camera();
  Points3 truth_m;
  Correspondences matches;

  LocalScene(double radius_m, int count, double noise_px, std::uint64_t seed,
             testing::SheetSpec spec = {})
      : sheet(spec), templ(testing::make_template(spec)) {
    testing::PoseSpec pose;
    pose.distance_m = 0.6;
    pose.tilt_y_rad = 0.3;
    const auto bent = testing::make_cylinder(sheet, radius_m, 0.3, pose);
    truth_m = testing::bent_vertices(templ, bent);
    Rng rng(seed);
    testing::MatchSpec drawn;
    drawn.count = count;
    drawn.noise_px = noise_px;
    matches = testing::draw_matches(templ, camera, bent, drawn, rng).matches;
  }

  testing::PluginAnswer ask(testing::PluginUnderTest& plugin) const {
    using testing::input;
    return plugin.process(
        0, {input("template", templ), input("camera", camera), input("correspondences", matches)});
  }

  /// What would live in the plugin is copied; NaN where there is no shape.
  Points3 vertices_m(const std::string& params = "{}") const {
    testing::PluginUnderTest plugin("solvers/salzmann_local", params);
    const testing::PluginAnswer out = ask(plugin);
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    const auto shape = out.get<Shape>();
    if (shape) return shape->vertices_m.matrix<3>();
    return Points3::Constant(truth_m.rows(), 3, std::numeric_limits<double>::quiet_NaN());
  }

  double mean_error_m(const std::string& params = "{}") const {
    return (vertices_m(params) - truth_m).rowwise().norm().mean();
  }

  /// Numbers the vertices anew, so that the mesh is no grid by its numbers.
  void shuffle(std::uint64_t seed) {
    std::vector<std::int32_t> place;
    for (std::int32_t v = 0; v < truth_m.rows(); ++v) place.push_back(v);
    Rng rng(seed);
    rng.shuffle(place);
    const Points3 rest_m = templ.vertices_m.matrix<3>(), true_m = truth_m;
    const Points2 flat_px = templ.flat_px.matrix<2>();
    for (Eigen::Index v = 0; v < true_m.rows(); ++v) {
      const std::int32_t to = place[to_index(v)];
      truth_m.row(to) = true_m.row(v);
      for (int k = 0; k < 3; ++k) templ.vertices_m(to, k) = rest_m(v, k);
      for (int k = 0; k < 2; ++k) templ.flat_px(to, k) = flat_px(v, k);
    }
    for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) templ.faces(f, k) = place[to_index(templ.faces(f, k))];
    }
  }
};

}  // namespace weft::salzmann_local
