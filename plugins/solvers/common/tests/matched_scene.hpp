// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::solvers {

/// 0.6 m away, turned by 0.3 rad.
inline constexpr testing::PoseSpec kTurned{0.6, 0.0, 0.0, 0.0, 0.3, 0.0};

/// A surface bent to a cylinder, and matches on it.
struct MatchedScene {
  Template templ;
  Camera camera = testing::make_camera();
  DevelopableSheet sheet;
  Points3 truth_m;  ///< [V,3] m, camera frame
  Correspondences matches;

  /// `zoom` multiplies the focal lengths.
  MatchedScene(double radius_m, const testing::MatchSpec& spec, std::uint64_t seed,
               const testing::SheetSpec& sheet_spec = {}, const testing::PoseSpec& pose = kTurned,
               double zoom = 1.0)
      : templ(testing::make_template(sheet_spec)),
        sheet(testing::make_cylinder(sheet_spec, radius_m, 0.3, pose)),
        truth_m(testing::bent_vertices(templ, sheet)) {
    std::cout << "seed " << seed << "\n";
    camera.fx *= zoom;
    camera.fy *= zoom;
    Rng rng(seed);
    matches = testing::draw_matches(templ, camera, sheet, spec, rng).matches;
  }
  MatchedScene(double radius_m, int count, double noise_px, std::uint64_t seed,
               double correct_rate = 1.0)
      : MatchedScene(radius_m, {count, correct_rate, noise_px}, seed) {}

  std::vector<testing::Input> inputs() const {
    return {testing::input("template", templ), testing::input("camera", camera),
            testing::input("correspondences", matches)};
  }
  /// Shapes of the answer live as long as the plugin.
  testing::PluginAnswer run(testing::PluginUnderTest& plugin,
                            const Shape* previous = nullptr) const {
    auto all = inputs();
    if (previous != nullptr) all.push_back(testing::input("previous.shape", *previous));
    return plugin.process(0, all);
  }
  double mean_error_m(const Points3& vertices_m) const {
    return (vertices_m - truth_m).rowwise().norm().mean();
  }
  double mean_error_m(const Shape& shape) const {
    return mean_error_m(Points3(shape.vertices_m.matrix<3>()));
  }
};

/// One call with a separate plugin; the result lives as long as this.
struct SolverCall {
  testing::PluginUnderTest plugin;
  testing::PluginAnswer out;

  SolverCall(const char* id, const std::string& params, const MatchedScene& scene)
      : plugin(id, params), out(scene.run(plugin)) {}

  std::optional<Shape> shape() const { return out.get<Shape>(); }
  /// The vertices of a shape that must exist; NaN where it does not.
  Points3 vertices_m() const {
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    const auto found = shape();
    if (found) return found->vertices_m.matrix<3>();
    return Points3::Constant(1, 3, std::numeric_limits<double>::quiet_NaN());
  }
};

/// Scenes of the tests of one solver.
template <const auto& kSolver>
struct SceneOf : MatchedScene {
  using MatchedScene::MatchedScene;
  using MatchedScene::mean_error_m;

  SolverCall call(const std::string& params = "{}") const { return {kSolver, params, *this}; }
  Points3 vertices_m(const std::string& params = "{}") const { return call(params).vertices_m(); }
  /// NaN without a shape.
  double mean_error_m(const std::string& params = "{}") const {
    const Points3 found_m = vertices_m(params);
    return found_m.rows() == truth_m.rows() ? mean_error_m(found_m)
                                            : std::numeric_limits<double>::quiet_NaN();
  }
};

}  // namespace weft::solvers
