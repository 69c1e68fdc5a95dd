// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tests/sightline_scene.hpp"

namespace weft::brunet_mdh {

using solvers::reference_sheet;

/// The reference surface seen by the usual camera.
struct Scene : solvers::SightlineScene {
  explicit Scene(double radius_m = 1e9, testing::PoseSpec pose = {0.6})
      : SightlineScene(radius_m, pose, testing::make_camera()) {}

  static Scene bent(double radius_m, const testing::PoseSpec& pose = {0.6}) {
    return Scene(radius_m, pose);
  }

  /// A random bend and pose, seen at random vertices with a pixel of noise.
  static Scene random(std::uint64_t seed) {
    Rng rng(seed);
    const double radius_m = rng.uniform(0.12, 0.5) * (rng.uniform() < 0.5 ? -1.0 : 1.0);
    testing::PoseSpec pose{0.6};
    pose.tilt_x_rad = rng.uniform(-0.4, 0.4);
    pose.tilt_y_rad = rng.uniform(-0.4, 0.4);
    Scene scene(radius_m, pose);
    scene.seen.clear();
    for (std::int32_t v = 0; v < 60; ++v) {
      if (rng.uniform() < 0.35) scene.seen.push_back(v);
    }
    scene.look(1.0, seed);
    return scene;
  }

  testing::PluginAnswer run(testing::PluginUnderTest& plugin,
                            const KnownPoints* known = nullptr) const {
    return SightlineScene::run(plugin, nullptr, known);
  }

  /// Vertices that are known to be within `radius_m` of where they truly are, or beside that.
  KnownPoints known(const std::vector<std::int32_t>& vertices, double radius_m,
                    const Eigen::RowVector3d& offset_m = {0.0, 0.0, 0.0}) const {
    Points3 points_m(vertices.size(), 3);
    for (std::size_t p = 0; p < vertices.size(); ++p) {
      points_m.row(static_cast<Eigen::Index>(p)) = truth_m.row(vertices[p]) + offset_m;
    }
    return solvers::known_points(vertices, points_m, radius_m);
  }
};

}  // namespace weft::brunet_mdh
