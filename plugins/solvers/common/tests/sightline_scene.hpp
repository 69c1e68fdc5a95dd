// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numeric>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/known_points.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::solvers {

/// The reference surface: 297 x 192 mm, 10 x 6 vertices, 0.6 m away, focal length 817 px.
inline testing::SheetSpec reference_sheet() {
  testing::SheetSpec spec;
  spec.height_m = 0.192;
  spec.height_px = 621;
  return spec;
}

inline Camera reference_camera() {
  Camera camera = testing::make_camera();
  camera.fx = camera.fy = 817.0;
  return camera;
}

/// One of the 24 poses of the reference table: four radii, six tilts, all faces seen from the
/// front.
struct BentPose {
  double radius_m;
  testing::PoseSpec pose;
};

inline std::vector<BentPose> reference_poses() {
  constexpr double kTilts[6][2] = {{0.0, 0.0},  {0.3, 0.0},  {0.0, 0.3},
                                   {-0.3, 0.3}, {0.5, -0.2}, {-0.2, -0.5}};
  std::vector<BentPose> poses;
  for (const double radius_m : {0.25, -0.25, 0.12, -0.12}) {
    for (const auto& tilt : kTilts) {
      poses.push_back({radius_m, {0.6, 0.0, 0.0, tilt[0], tilt[1], 0.0}});
    }
  }
  return poses;
}

/// The reference surface bent to a cylinder, and sightlines of its vertices.
struct SightlineScene {
  Template templ = testing::make_template(reference_sheet());
  Camera camera = reference_camera();
  Points3 truth_m;                 ///< [60,3] m, camera frame
  std::vector<std::int32_t> seen;  ///< vertices
  Sightlines lines;

  explicit SightlineScene(double radius_m = 1e9, const testing::PoseSpec& pose = {0.6},
                          const Camera& looking = reference_camera())
      : camera(looking), seen(60) {
    std::iota(seen.begin(), seen.end(), 0);
    const auto sheet = testing::make_cylinder(reference_sheet(), radius_m, 0.3, pose);
    truth_m = testing::bent_vertices(templ, sheet);
    look();
  }
  static SightlineScene bent(double radius_m, const testing::PoseSpec& pose = {0.6}) {
    return SightlineScene(radius_m, pose);
  }
  static SightlineScene flat(const testing::PoseSpec& pose = {0.6}) { return bent(1e9, pose); }

  /// Sightlines of the seen vertices, with noise on the pixels.
  void look(double noise_px = 0.0, std::uint64_t seed = 1) {
    Rng rng(seed);
    const auto n = static_cast<std::int64_t>(seen.size());
    lines = {};
    lines.vertex = Array<std::int32_t>({n});
    lines.face = Array<std::int32_t>({n}, -1);
    lines.barycentrics = Array<double>({n, 3}, 0.0);
    lines.pixel_px = Array<double>({n, 2});
    lines.ray = Array<double>({n, 3});
    lines.weight = Array<double>({n});
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

  testing::PluginAnswer run(testing::PluginUnderTest& plugin, const Shape* previous = nullptr,
                            const KnownPoints* known = nullptr,
                            const Correspondences* matches = nullptr) const {
    std::vector<testing::Input> inputs{testing::input("template", templ),
                                       testing::input("camera", camera),
                                       testing::input("sightlines", lines)};
    if (previous != nullptr) inputs.push_back(testing::input("previous.shape", *previous));
    if (known != nullptr) inputs.push_back(testing::input("known_points", *known));
    if (matches != nullptr) inputs.push_back(testing::input("correspondences", *matches));
    return plugin.process(0, inputs);
  }

  double mean_error_m(const Points3& vertices_m) const {
    return (vertices_m - truth_m).rowwise().norm().mean();
  }
  double mean_error_m(const Shape& shape) const {
    return mean_error_m(Points3(shape.vertices_m.matrix<3>()));
  }
};

inline Shape shape_of(const Points3& vertices_m, ShapeState state = ShapeState::estimated) {
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  shape.state = static_cast<std::int32_t>(state);
  shape.source = Array<std::uint8_t>({vertices_m.rows()}, 0);
  return shape;
}

/// Vertices that are known to be within `radius_m` of points [N,3].
inline KnownPoints known_points(const std::vector<std::int32_t>& vertices, const Points3& points_m,
                                double radius_m) {
  KnownPoints known;
  const auto count = static_cast<std::int64_t>(vertices.size());
  known.vertex = Array<std::int32_t>({count});
  known.radius_m = Array<double>({count});
  known.points_m = make_array<double>(points_m);
  for (std::int64_t p = 0; p < count; ++p) {
    known.vertex(p) = vertices[to_index(p)];
    known.radius_m(p) = radius_m;
  }
  return known;
}

}  // namespace weft::solvers
