// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::brunet_refine {

inline constexpr const char* kId = "solvers/brunet_refine";

/// A sheet of 297 x 178 mm at 0.6 m, turned by 0.3 rad, bent to a cylinder, and matches on it.
struct Scene {
  Template templ = testing::make_template();
  Camera camera = testing::make_camera();
  Points3 truth_m;
  Correspondences matches;

  Scene(double radius_m, int count, double noise_px, std::uint64_t seed,
        double correct_rate = 1.0) {
    const auto sheet = testing::make_cylinder({}, radius_m, 0.3, {0.6, 0.0, 0.0, 0.0, 0.3, 0.0});
    truth_m = testing::bent_vertices(templ, sheet);
    Rng rng(seed);
    matches =
        testing::draw_matches(templ, camera, sheet, {count, correct_rate, noise_px}, rng).matches;
  }

  std::vector<testing::Input> inputs() const {
    return {testing::input("template", templ), testing::input("camera", camera),
            testing::input("correspondences", matches)};
  }

  /// What is in the answer lives as long as the plugin.
  testing::PluginAnswer run(testing::PluginUnderTest& plugin) const {
    return plugin.process(0, inputs());
  }

  double mean_error_m(const Shape& shape) const {
    return (shape.vertices_m.matrix<3>() - truth_m).rowwise().norm().mean();
  }
};

}  // namespace weft::brunet_refine
