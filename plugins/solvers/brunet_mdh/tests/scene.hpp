// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numeric>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/known_points.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::brunet_mdh {

/// The reference sheet: 297 x 192 mm, 10 x 6 vertices, 0.6 m away.
inline testing::SheetSpec reference_sheet() {
  testing::SheetSpec spec;
  spec.height_m = 0.192;
  spec.height_px = 621;
  return spec;
}

struct Scene {
  Template templ = testing::make_template(reference_sheet());
  Camera camera = testing::make_camera();
  Points3 truth_m;
  std::vector<std::int32_t> seen;
  Sightlines lines;

  Scene() : seen(60) { std::iota(seen.begin(), seen.end(), 0); }

  static Scene bent(double radius_m, testing::PoseSpec pose = {}) {
    Scene scene;
    pose.distance_m = 0.6;
    const auto sheet = testing::make_cylinder(reference_sheet(), radius_m, 0.3, pose);
    scene.truth_m = testing::bent_vertices(scene.templ, sheet);
    scene.look();
    return scene;
  }

  /// A random bend and pose, seen at random vertices with a pixel of noise.
  static Scene random(std::uint64_t seed) {
    Rng rng(seed);
    const double radius_m = rng.uniform(0.12, 0.5) * (rng.uniform() < 0.5 ? -1.0 : 1.0);
    testing::PoseSpec pose;
    pose.tilt_x_rad = rng.uniform(-0.4, 0.4);
    pose.tilt_y_rad = rng.uniform(-0.4, 0.4);
    Scene scene = bent(radius_m, pose);
    scene.seen.clear();
    for (std::int32_t v = 0; v < 60; ++v) {
      if (rng.uniform() < 0.35) scene.seen.push_back(v);
    }
    scene.look(1.0, seed);
    return scene;
  }

  /// Sightlines of the seen vertices, with noise on the pixels.
  void look(double noise_px = 0.0, std::uint64_t seed = 1) {
    Rng rng(seed);
    const auto n = static_cast<std::int64_t>(seen.size());
    lines = {};
    lines.vertex = Array<std::int32_t>({n}, 0);
    lines.face = Array<std::int32_t>({n}, 0);
    lines.barycentrics = Array<double>({n, 3}, 0.0);
    lines.pixel_px = Array<double>({n, 2}, 0.0);
    lines.ray = Array<double>({n, 3}, 0.0);
    lines.weight = Array<double>({n}, 0.0);
    lines.coverage = static_cast<double>(n) / static_cast<double>(truth_m.rows());
    for (std::int64_t i = 0; i < n; ++i) {
      const std::int32_t v = seen[to_index(i)];
      lines.vertex(i) = v;
      lines.barycentrics(i, 0) = 1.0;
      lines.weight(i) = 1.0;
      Eigen::Vector2d pixel = project(testing::pinhole(camera), truth_m.row(v));
      pixel.x() += noise_px * rng.normal();
      pixel.y() += noise_px * rng.normal();
      aim(i, pixel);
    }
  }

  void aim(std::int64_t i, const Eigen::Vector2d& pixel) {
    lines.pixel_px.matrix<2>().row(i) = pixel.transpose();
    lines.ray.matrix<3>().row(i) = unit_ray(testing::pinhole(camera), pixel).transpose();
  }

  testing::PluginAnswer run(testing::PluginUnderTest& plugin,
                            const KnownPoints* known = nullptr) const {
    std::vector<testing::Input> inputs{testing::input("template", templ),
                                       testing::input("camera", camera),
                                       testing::input("sightlines", lines)};
    if (known != nullptr) inputs.push_back(testing::input("known_points", *known));
    return plugin.process(0, inputs);
  }

  /// Vertices that are known to be within `radius_m` of where they truly are, or beside that.
  KnownPoints known(const std::vector<std::int32_t>& vertices, double radius_m,
                    const Eigen::RowVector3d& offset_m = {0.0, 0.0, 0.0}) const {
    const auto count = static_cast<std::int64_t>(vertices.size());
    KnownPoints known{Array<std::int32_t>({count}, 0), Array<double>({count, 3}, 0.0),
                      Array<double>({count}, 0.0)};
    for (std::int64_t p = 0; p < count; ++p) {
      const std::int32_t v = vertices[to_index(p)];
      known.vertex(p) = v;
      known.points_m.matrix<3>().row(p) = truth_m.row(v) + offset_m;
      known.radius_m(p) = radius_m;
    }
    return known;
  }

  double mean_error_m(const Shape& shape) const {
    return (shape.vertices_m.matrix<3>() - truth_m).rowwise().norm().mean();
  }
};

}  // namespace weft::brunet_mdh
