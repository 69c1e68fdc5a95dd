// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/testing/random_sheet.hpp>

namespace weft::testing {

/// Sets of matches that are hard in one way each. The template is make_template()'s.
enum class Kind {
  paper,     ///< the deformations of Shetab-Bushehri et al. 2023, mismatches uniform in the image
  turned,    ///< those, turned in the plane by any angle
  strong,    ///< a cylinder of 0.12 m, turned by any angle
  clusters,  ///< most mismatches go to few places in the image
  copy       ///< 15 % of the matches, all outliers, lie on a smaller copy of the surface
};

inline constexpr double kCopyShare = 0.15;

struct SceneSpec {
  Kind kind = Kind::paper;
  int count = 200;
  double correct_rate = 0.3;
  double noise_px = 0.0;
  bool oriented = false;  ///< the matches have scales and angles
};

namespace detail {

inline Points3 turned_any(const Points3& vertices_m, Rng& rng) {
  const Eigen::RowVector3d middle = vertices_m.colwise().mean();
  for (;;) {
    const Eigen::AngleAxisd turn(rng.uniform(-std::numbers::pi, std::numbers::pi),
                                 Eigen::Vector3d::UnitZ());
    const Points3 turned =
        ((vertices_m.rowwise() - middle) * turn.toRotationMatrix().transpose()).rowwise() + middle;
    if (all_in_image(make_camera(), turned)) return turned;
  }
}

inline Points3 shape_of(Kind kind, const Template& templ, Rng& rng) {
  if (kind == Kind::strong) {
    for (;;) {
      const double radius_m = rng.uniform() < 0.5 ? 0.12 : -0.12;
      const double ruling_rad = rng.uniform(0.0, std::numbers::pi);
      const PoseSpec pose{0.65,
                          0.0,
                          0.0,
                          rng.uniform(-0.4, 0.4),
                          rng.uniform(-0.4, 0.4),
                          rng.uniform(-std::numbers::pi, std::numbers::pi)};
      const Points3 vertices_m =
          bent_vertices(templ, make_cylinder({}, radius_m, ruling_rad, pose));
      if (all_in_image(make_camera(), vertices_m)) return vertices_m;
    }
  }
  const Points3 vertices_m = draw_deformation({}, make_camera(), rng)->vertices_m;
  return kind == Kind::paper ? vertices_m : turned_any(vertices_m, rng);
}

inline void cluster(LabelledMatches& drawn, Rng& rng) {
  Points2 places(5, 2);
  for (Eigen::Index c = 0; c < places.rows(); ++c) {
    places.row(c) << rng.uniform(20.0, 620.0), rng.uniform(20.0, 460.0);
  }
  for (std::int64_t i = 0; i < drawn.matches.count(); ++i) {
    if (drawn.correct[to_index(i)] != 0 || rng.uniform() > 0.8) continue;
    const auto place = places.row(rng.below(5));
    drawn.matches.image_px(i, 0) = place.x() + 3.0 * rng.normal();
    drawn.matches.image_px(i, 1) = place.y() + 3.0 * rng.normal();
  }
}

/// Puts the first mismatches on another copy of the surface.
inline void add_copy(LabelledMatches& drawn, double share, Rng& rng) {
  const double turn = rng.uniform(-std::numbers::pi, std::numbers::pi);
  const double scale = rng.uniform(0.15, 0.25);
  Eigen::Matrix2d slope;
  slope << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
  slope *= scale;
  const Eigen::Vector2d middle(rng.uniform(120.0, 520.0), rng.uniform(120.0, 360.0));
  auto left = static_cast<std::int64_t>(share * static_cast<double>(drawn.matches.count()));
  for (std::int64_t i = 0; i < drawn.matches.count() && left > 0; ++i) {
    if (drawn.correct[to_index(i)] != 0) continue;
    const Eigen::Vector2d p(drawn.matches.template_px(i, 0), drawn.matches.template_px(i, 1));
    const Eigen::Vector2d q = slope * (p - Eigen::Vector2d(479.5, 287.0)) + middle;
    drawn.matches.image_px.matrix<2>().row(i) = q.transpose();
    --left;
  }
}

/// Scales and angles as a detector finds them: rough for inliers, any for the others.
inline void orient(LabelledMatches& drawn, const Template& templ, const Points3& vertices_m,
                   Rng& rng) {
  const Points2 image_px = project_points(pinhole(make_camera()), vertices_m);
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  const std::int64_t n = drawn.matches.count();
  drawn.matches.scale_ratio = Array<double>({n}, 0.0);
  drawn.matches.angle_difference_rad = Array<double>({n}, 0.0);
  for (std::int64_t i = 0; i < n; ++i) {
    const auto face = faces.row(drawn.matches.face(i));
    Eigen::Matrix2d from, to;
    for (int e = 0; e < 2; ++e) {
      from.col(e) = (flat_px.row(face[e + 1]) - flat_px.row(face[0])).transpose();
      to.col(e) = (image_px.row(face[e + 1]) - image_px.row(face[0])).transpose();
    }
    const Eigen::Matrix2d slope = to * from.inverse();
    const bool correct = drawn.correct[to_index(i)] != 0;
    double log_scale = 0.5 * std::log(std::max(1e-6, std::abs(slope.determinant())));
    double turn = std::atan2(slope(1, 0) - slope(0, 1), slope(0, 0) + slope(1, 1));
    log_scale += (correct ? 0.2 : 0.6) * rng.normal();
    turn += correct ? 0.2 * rng.normal() : rng.uniform(-std::numbers::pi, std::numbers::pi);
    drawn.matches.scale_ratio(i) = std::exp(log_scale);
    drawn.matches.angle_difference_rad(i) = std::remainder(turn, 2.0 * std::numbers::pi);
  }
}

}  // namespace detail

inline LabelledMatches draw_scene(const SceneSpec& spec, std::uint64_t seed) {
  static const Template templ = make_template();
  Rng rng(seed);
  const Points3 vertices_m = detail::shape_of(spec.kind, templ, rng);
  LabelledMatches drawn = draw_matches(templ, make_camera(), vertices_m,
                                       {spec.count, spec.correct_rate, spec.noise_px, 2.0}, rng);
  if (spec.noise_px > 0.0) {  // noise does not make a match wrong
    for (Eigen::Index i = 0; i < spec.count; ++i) {
      drawn.correct[to_index(i)] = i >= std::lround((1.0 - spec.correct_rate) * spec.count) ? 1 : 0;
    }
  }
  if (spec.kind == Kind::clusters) detail::cluster(drawn, rng);
  if (spec.kind == Kind::copy) detail::add_copy(drawn, kCopyShare, rng);
  if (spec.oriented) detail::orient(drawn, templ, vertices_m, rng);
  return drawn;
}

/// Which matches Kind::copy puts on the copy: the first mismatches.
inline std::vector<std::uint8_t> on_copy(const LabelledMatches& drawn) {
  std::vector<std::uint8_t> is(drawn.correct.size(), 0);
  auto left = to_index(kCopyShare * static_cast<double>(is.size()));
  for (std::size_t i = 0; i < is.size() && left > 0; ++i) {
    if (drawn.correct[i] != 0) continue;
    is[i] = 1;
    --left;
  }
  return is;
}

}  // namespace weft::testing
