// SPDX-License-Identifier: Apache-2.0
#include "energy.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "face_sums.hpp"
#include "terms.hpp"

namespace weft::gauss_newton {
namespace {

constexpr double kMostTurn = 1.0;  // rad, along an arc: the formulas are for smaller ones
constexpr double kTooClose_m = 1e-9;
constexpr std::size_t kEnoughObservations = 30;  // with fewer the outline has its full weight
constexpr double kMostTrace = 0.5;  // ratio of the outline's trace to that of the matches

double squared_turn(const Arc& arc, double per_m) {
  const double turn = std::clamp(per_m * arc.rest_m, -kMostTurn, kMostTurn);
  return turn * turn;
}

/// The arc keeps the length that it has at rest, where its chord was rest_m.
double chord_m(const Arc& arc, double per_m) {
  return arc.rest_m * (1.0 + (squared_turn(arc, arc.rest_per_m) - squared_turn(arc, per_m)) / 24.0);
}

}  // namespace

void Energy::prepare(const MeshModel& mesh) {
  mesh_ = &mesh;
  normals_.resize(mesh.faces.rows(), 3);
  fronts_.resize(mesh.faces.rows(), 3);
  angles_rad_.resize(mesh.hinges.size());
  edge_chords_m_.resize(mesh.edges.size());
  outline_.prepare(mesh.faces, mesh.vertex_count());
  rises_m_.resize(mesh.edges.size());
  pair_chords_m_.resize(mesh.pairs.size());
}

void Energy::follow(const Points3& vertices_m, double share) {
  face_normals(vertices_m, mesh_->faces, normals_);
  for (std::size_t h = 0; h < angles_rad_.size(); ++h) {
    const double now_rad = angle_rad(mesh_->hinges[h], normals_, vertices_m);
    angles_rad_[h] = share == 1.0 ? now_rad : angles_rad_[h] + share * (now_rad - angles_rad_[h]);
  }
  for (Eigen::Index f = 0; f < normals_.rows(); ++f) {
    const double area2 = normals_.row(f).norm();
    fronts_.row(f) = normals_.row(f) / (area2 > 0.0 ? area2 : 1.0);
  }
  for (std::size_t e = 0; e < edge_chords_m_.size(); ++e) {
    const Arc& edge = mesh_->edges[e];
    const double per_m = curvature_per_m(*mesh_, edge, angles_rad_);
    edge_chords_m_[e] = chord_m(edge, per_m);
    rises_m_[e] = 0.5 * edge.rest_m * std::clamp(per_m * edge.rest_m, -kMostTurn, kMostTurn);
  }
  for (std::size_t p = 0; p < pair_chords_m_.size(); ++p) {
    const Arc& pair = mesh_->pairs[p];
    pair_chords_m_[p] = chord_m(pair, curvature_per_m(*mesh_, pair, angles_rad_));
  }
}

Eigen::Vector3d Energy::surface_point_m(const Points3& vertices_m, std::int32_t face,
                                        const std::array<double, 3>& weights) const {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double rise_m = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto corner = static_cast<Eigen::Index>(k);
    point += weights[k] * vertices_m.row(mesh_->faces(face, corner)).transpose();
    rise_m +=
        weights[k] * weights[(k + 1) % 3] * rises_m_[to_index(mesh_->face_arcs(face, corner))];
  }
  return point - rise_m * fronts_.row(face).transpose();
}

template <bool wants_derivatives>
double Energy::observed(const FrameData& frame, const Trust& trust, const Points3& vertices_m,
                        const Derivatives& to) const {
  double energy = 0.0;
  SeenFrom from;
  from.camera = frame.camera;
  from.trust = trust;
  for (const SeenFace& seen : frame.faces) {
    const std::size_t count = seen.end - seen.first;
    worked(static_cast<std::int64_t>(count));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = static_cast<Eigen::Index>(k);
      from.corners_m[k] = vertices_m.row(mesh_->faces(seen.face, corner)).transpose();
      from.rises_m[k] = rises_m_[to_index(mesh_->face_arcs(seen.face, corner))];
    }
    from.front = fronts_.row(seen.face).transpose();
    FaceSums sums;
    const Observation* first = frame.observations.data() + seen.first;
    if (!sums.observe(from, first, count, wants_derivatives, energy)) {
      return std::numeric_limits<double>::infinity();
    }
    if constexpr (wants_derivatives) add_sums(sums, seen.face, to);
  }
  return energy;
}

void Energy::meet_outline(const FrameData& frame, const Scales& scales, const Points3& vertices_m) {
  if (!frame.outline.present()) return;
  const auto on_surface = [&](std::int32_t face, const std::array<double, 3>& weights) {
    return surface_point_m(vertices_m, face, weights);
  };
  outline_.meet(frame.outline, frame.camera, scales.outline, vertices_m, frame.covered, on_surface);
  outline_.share = scales.outline.share;
  if (frame.observations.size() < kEnoughObservations) return;
  BlockMatrix& matrix = outline_matrix_;
  const auto trace_of = [&](auto&& add) {
    matrix.diagonal.assign(to_index(vertices_m.rows()), Eigen::Matrix3d::Zero());
    matrix.coupling.assign(mesh_->couplings.size(), Eigen::Matrix3d::Zero());
    add();
    double trace = 0.0;
    for (const Eigen::Matrix3d& block : matrix.diagonal) trace += block.trace();
    return trace;
  };
  const double of_matches = trace_of([&] {
    observed<true>(frame, scales.trust, vertices_m, {nullptr, &matrix});
  });
  const double of_outline = trace_of([&] {
    outlined<true>(frame, scales, vertices_m, {nullptr, &matrix});
  });
  if (of_outline > kMostTrace * of_matches) outline_.share *= kMostTrace * of_matches / of_outline;
}

template <bool wants_derivatives>
double Energy::outlined(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
                        const Derivatives& to) const {
  const Pinhole camera = frame.camera;
  const double per_px = 1.0 / scales.outline.noise_px;
  double energy = outline_.missed();
  for (const OutlinePoint& o : outline_.points()) {
    const Eigen::Vector3d p = surface_point_m(vertices_m, o.face, o.weights);
    if (!(p.z() > 0.0)) return std::numeric_limits<double>::infinity();
    const double inverse_z = 1.0 / p.z(), px = p.x() * inverse_z, py = p.y() * inverse_z;
    const Eigen::Vector2d seen_px(camera.fx * px + camera.cx, camera.fy * py + camera.cy);
    const double r = per_px * (o.normal.dot(seen_px) - o.offset_px);
    double own = 0.0;
    const double weight = outline_.share * o.share * outline_.loss().weight(r, own);
    energy += o.share * own;
    if constexpr (wants_derivatives) {
      // Only across the line: the second of the two whitened residuals.
      const Whitening slopes{0.0, per_px * camera.fx * o.normal.x(),
                             per_px * camera.fy * o.normal.y()};
      FaceSums sums;
      sums.add(o.weights.data(), inverse_z, px, py, slopes, weight, 0.0, r);
      add_sums(sums, o.face, to);
    }
  }
  return outline_.share * energy;
}

void Energy::add_sums(const FaceSums& sums, std::int32_t face, const Derivatives& to) const {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto corner = static_cast<Eigen::Index>(k);
    const std::int32_t v = mesh_->faces(face, corner);
    to.matrix->diagonal[to_index(v)] += sums.block(k);
    const Arc& edge = mesh_->edges[to_index(mesh_->face_arcs(face, corner))];
    to.matrix->coupling[to_index(edge.coupling)] += sums.block(3 + k);
    if (to.gradient == nullptr) continue;
    to.gradient->row(v) += Eigen::Map<const Eigen::RowVector3d>(sums.slopes[k]);
  }
}

template <bool wants_derivatives>
double Energy::stretched(const std::vector<Arc>& arcs, const std::vector<double>& chords_m,
                         double strain, const Points3& vertices_m, const Derivatives& to) const {
  double energy = 0.0;
  for (std::size_t e = 0; e < arcs.size(); ++e) {
    worked_in_loop(static_cast<std::int64_t>(e), 5);
    const Arc& arc = arcs[e];
    const Eigen::Vector3d offset_m = (vertices_m.row(arc.j) - vertices_m.row(arc.i)).transpose();
    const double length_m = offset_m.norm(), per_m = 1.0 / (strain * arc.rest_m);
    const double residual = (length_m - chords_m[e]) * per_m;
    energy += residual * residual;
    if constexpr (wants_derivatives) {
      if (length_m < kTooClose_m) continue;
      const Eigen::Vector3d slope = per_m / length_m * offset_m;
      to.gradient->row(arc.j) += residual * slope.transpose();
      to.gradient->row(arc.i) -= residual * slope.transpose();
      // An edge that is too long resists motion to the side, too.
      const Eigen::Vector3d unit = offset_m / length_m;
      const double aside = std::max(residual, 0.0) * per_m / length_m;
      add_square(arc,
                 slope * slope.transpose() +
                     aside * (Eigen::Matrix3d::Identity() - unit * unit.transpose()),
                 *to.matrix);
    }
  }
  return energy;
}

template <bool wants_derivatives>
double Energy::bent(const std::vector<double>& expected_rad, double bend_rad,
                    const Points3& vertices_m, const Derivatives& to) {
  face_normals(vertices_m, mesh_->faces, normals_);
  double energy = 0.0;
  for (std::size_t h = 0; h < mesh_->hinges.size(); ++h) {
    worked_in_loop(static_cast<std::int64_t>(h), 20);
    const Hinge& hinge = mesh_->hinges[h];
    const double per_rad = std::sqrt(hinge.weight / 3.0) / bend_rad;
    const double residual = (angle_rad(hinge, normals_, vertices_m) - expected_rad[h]) * per_rad;
    energy += residual * residual;
    if constexpr (wants_derivatives) {
      HingeSlopes slopes = angle_slopes(hinge, normals_, vertices_m);
      for (std::size_t k = 0; k < 4; ++k) {
        slopes[k] *= per_rad;
        to.gradient->row(hinge.vertex[k]) += residual * slopes[k].transpose();
      }
      add_square(hinge, slopes, *to.matrix);
    }
  }
  return energy;
}

template <bool wants_derivatives>
double Energy::known_energy(const FrameData& frame, double known_m, const Points3& vertices_m,
                            const Derivatives& to) const {
  const double per_m = 1.0 / known_m;
  double energy = 0.0;
  for (const KnownSurfacePoint& known : frame.spheres) {
    const Eigen::Vector3d offset_m = known.on(vertices_m) - known.centre_m;
    const double length_m = offset_m.norm(), beyond_m = length_m - known.radius_m;
    if (!(beyond_m > 0.0)) continue;
    energy += per_m * per_m * beyond_m * beyond_m;
    if constexpr (wants_derivatives) {
      const Eigen::Vector3d out = offset_m / length_m;
      // Along the sphere a point is free, as far as the sphere is flat; at a radius of 0 it is not.
      const double across = beyond_m / length_m;
      const Eigen::Matrix3d block =
          per_m * per_m *
          ((1.0 - across) * out * out.transpose() + across * Eigen::Matrix3d::Identity());
      add_square(*mesh_, known, block, *to.matrix);
      for (std::size_t k = 0; k < 3; ++k) {
        to.gradient->row(known.vertices[k]) +=
            known.weights[k] * per_m * per_m * beyond_m * out.transpose();
      }
    }
  }
  return energy;
}

template <bool wants_derivatives>
double Energy::sum(const FrameData& frame, const Expectation& expected, const Scales& scales,
                   const Points3& vertices_m, const Derivatives& to) {
  constexpr bool d = wants_derivatives;
  double energy = observed<d>(frame, scales.trust, vertices_m, to);
  energy += stretched<d>(mesh_->edges, edge_chords_m_, scales.strain, vertices_m, to);
  if (scales.pair_strain > 0.0) {
    energy += stretched<d>(mesh_->pairs, pair_chords_m_, scales.pair_strain, vertices_m, to);
  }
  if (scales.bend_rad > 0.0) {
    energy += bent<d>(expected.bends_rad, scales.bend_rad, vertices_m, to);
  }
  energy += known_energy<d>(frame, scales.known_m, vertices_m, to);
  if (frame.outline.present()) energy += outlined<d>(frame, scales, vertices_m, to);
  if (!(scales.previous_m > 0.0)) return energy;
  const double per_m2 = 1.0 / (scales.previous_m * scales.previous_m);
  energy += per_m2 * (vertices_m - expected.previous_m).squaredNorm();
  if constexpr (wants_derivatives) {
    *to.gradient += per_m2 * (vertices_m - expected.previous_m);
    for (Eigen::Matrix3d& block : to.matrix->diagonal) block.diagonal().array() += per_m2;
  }
  return energy;
}

double Energy::value(const FrameData& frame, const Expectation& expected, const Scales& scales,
                     const Points3& vertices_m) {
  return sum<false>(frame, expected, scales, vertices_m, {});
}

double Energy::linearise(const FrameData& frame, const Expectation& expected, const Scales& scales,
                         const Points3& vertices_m, Points3& gradient, BlockMatrix& matrix) {
  gradient.setZero();
  matrix.set_zero();
  return sum<true>(frame, expected, scales, vertices_m, {&gradient, &matrix});
}

void Energy::add_observations(const FrameData& frame, const Scales& scales,
                              const Points3& vertices_m, BlockMatrix& matrix) {
  observed<true>(frame, scales.trust, vertices_m, {nullptr, &matrix});
}

void Energy::add_outline(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
                         BlockMatrix& matrix) const {
  if (frame.outline.present()) outlined<true>(frame, scales, vertices_m, {nullptr, &matrix});
}

}  // namespace weft::gauss_newton
