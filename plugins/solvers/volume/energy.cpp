// SPDX-License-Identifier: Apache-2.0
#include "energy.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::volume {

double part_count(const SolidModel& body) {
  const double side_m = body.diagonal_m() / 6.0;
  return std::max(1.0, body.volume_m3() / (side_m * side_m * side_m));
}

void Energy::prepare(const SolidModel& body) {
  body_ = &body;
  outline_.prepare(body.faces(), body.vertices_m().rows());
  outline_.forget();
  outline_points_.clear();
}

double Energy::value(const FrameData& frame, const Scales& scales, const Points3& nodes_m) const {
  return sum(frame, scales, nodes_m, {});
}

double Energy::linearise(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
                         Points3& gradient, solvers::BlockMatrix& matrix) const {
  gradient.setZero();
  matrix.set_zero();
  const Derivatives to{&gradient, &matrix};
  return sum(frame, scales, nodes_m, to);
}

double Energy::sum(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
                   const Derivatives& to) const {
  return deformed(scales, nodes_m, to) + observed(frame, scales, nodes_m, to) +
         outlined(frame, scales, nodes_m, to) + known(frame, scales, nodes_m, to);
}

double Energy::mean_deformation(const Material& material, const Points3& nodes_m) const {
  double mean = 0.0;
  for (const Tetrahedron& each : body_->tetrahedra()) {
    mean += each.share * material.energy(each.gradient(nodes_m));
  }
  return mean;
}

double Energy::deformed(const Scales& scales, const Points3& nodes_m, const Derivatives& to) const {
  return deformed(body_->tetrahedra(), scales.strain, scales.material, nodes_m, to) +
         deformed(body_->parts(), scales.mean_strain, scales.material, nodes_m, to) +
         uneven(scales.unevenness, nodes_m, to);
}

double Energy::uneven(double unevenness, const Points3& nodes_m, const Derivatives& to) const {
  const double weight = part_count(*body_) / (unevenness * unevenness);
  const auto& pairs = body_->couplings();
  worked(static_cast<std::int64_t>(pairs.size()) / 4);
  double sum = 0.0;
  for (std::size_t k = 0; k < body_->uneven_diagonal().size(); ++k) {
    const double own = weight * body_->uneven_diagonal()[k];
    const auto row = static_cast<Eigen::Index>(k);
    sum += own * nodes_m.row(row).squaredNorm();
    if (to.gradient == nullptr) continue;
    to.gradient->row(row) += own * nodes_m.row(row);
    to.matrix->diagonal[k].diagonal().array() += own;
  }
  for (std::size_t c = 0; c < pairs.size(); ++c) {
    const double both = weight * body_->uneven_coupling()[c];
    if (both == 0.0) continue;
    const auto& [i, j] = pairs[c];
    sum += 2.0 * both * nodes_m.row(i).dot(nodes_m.row(j));
    if (to.gradient == nullptr) continue;
    to.gradient->row(i) += both * nodes_m.row(j);
    to.gradient->row(j) += both * nodes_m.row(i);
    to.matrix->coupling[c].diagonal().array() += both;
  }
  return sum;
}

template <class Cell>
double Energy::deformed(const std::vector<Cell>& cells, double strain, const Material& material,
                        const Points3& nodes_m, const Derivatives& to) const {
  const double weight = part_count(*body_) / (strain * strain);
  double sum = 0.0;
  std::int64_t done = 0;
  for (const Cell& each : cells) {
    worked_in_loop(done++, 20);
    const Eigen::Matrix3d gradient = each.gradient(nodes_m);
    if (to.gradient == nullptr) {
      sum += each.share * material.energy(gradient);
      continue;
    }
    const Linearised at(material, gradient);
    sum += each.share * at.energy();
    add_cell(each, weight * each.share, at, to);
  }
  return weight * sum;
}

template <class Cell>
void Energy::add_cell(const Cell& in, double weight, const Linearised& at,
                      const Derivatives& to) const {
  std::vector<Linearised::Slope> slopes;
  std::vector<std::uint8_t> counts;  // a thick part has nodes around it that its mean omits
  slopes.reserve(in.node.size());
  for (std::size_t a = 0; a < in.node.size(); ++a) {
    const Eigen::Vector3d slope = in.slopes.col(static_cast<Eigen::Index>(a));
    slopes.push_back(at.slope(slope));
    counts.push_back(slope.isZero(0.0) ? 0 : 1);
    to.gradient->row(in.node[a]) += weight * (at.half_stress() * slope).transpose();
  }
  std::size_t pair = 0;
  for (std::size_t a = 0; a < in.node.size(); ++a) {
    if (counts[a] == 0) {
      pair += in.node.size() - a - 1;
      continue;
    }
    to.matrix->diagonal[to_index(in.node[a])] += weight * at.half_curvature(slopes[a], slopes[a]);
    for (std::size_t b = a + 1; b < in.node.size(); ++b, ++pair) {
      if (counts[b] == 0) continue;
      const Eigen::Matrix3d block = weight * at.half_curvature(slopes[a], slopes[b]);
      Eigen::Matrix3d& into = to.matrix->coupling[to_index(in.coupling[pair])];
      if (in.node[a] < in.node[b]) {
        into += block;
      } else {
        into += block.transpose();
      }
    }
  }
}

double Energy::observed(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
                        const Derivatives& to) const {
  const Pinhole& camera = frame.camera;
  double energy = 0.0;
  std::int64_t done = 0;
  for (const Observation& o : frame.observations) {
    worked_in_loop(done++, 5);
    const Eigen::Vector3d p = o.point.on(body_->tetrahedra(), nodes_m);
    if (!(p.z() > 0.0)) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d off_px = project(camera, p) - o.seen_px;
    const Eigen::Vector2d residual(o.white.xx * off_px.x(),
                                   o.white.yx * off_px.x() + o.white.yy * off_px.y());
    const double weight = scales.trust.weight(residual.squaredNorm(), energy);
    if (to.gradient == nullptr) continue;
    Eigen::Matrix<double, 2, 3> slopes;
    slopes << camera.fx / p.z(), 0.0, -camera.fx * p.x() / (p.z() * p.z()),  //
        0.0, camera.fy / p.z(), -camera.fy * p.y() / (p.z() * p.z());
    Eigen::Matrix2d white;
    white << o.white.xx, 0.0, o.white.yx, o.white.yy;
    const Eigen::Matrix<double, 2, 3> whitened = white * slopes;
    add_point(o.point, weight * whitened.transpose() * residual,
              weight * whitened.transpose() * whitened, to);
  }
  return energy;
}

void Energy::meet_outline(const FrameData& frame, const Scales& scales, const Points3& nodes_m) {
  constexpr std::size_t kEnoughObservations = 30;
  constexpr double kMostTrace = 0.5;
  outline_points_.clear();
  outline_.forget();
  if (!frame.outline.present()) return;
  const Points3 surface_m = body_->surface_of(nodes_m);
  const auto on_surface = [&](std::int32_t face, const std::array<double, 3>& weights) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      point += weights[k] *
               surface_m.row(body_->faces()(face, static_cast<Eigen::Index>(k))).transpose();
    }
    return point;
  };
  outline_.meet(frame.outline, frame.camera, scales.outline, surface_m, {}, on_surface);
  outline_.share = scales.outline.share;
  for (const solvers::OutlinePoint& each : outline_.points()) {
    outline_points_.push_back(
        body_->point_of(each.face, {each.weights[0], each.weights[1], each.weights[2]}));
  }
  if (frame.observations.size() < kEnoughObservations) return;
  const auto trace_of = [&](auto&& add) {
    trace_matrix_.diagonal.assign(to_index(nodes_m.rows()), Eigen::Matrix3d::Zero());
    trace_matrix_.coupling.assign(body_->couplings().size(), Eigen::Matrix3d::Zero());
    Points3 unused = Points3::Zero(nodes_m.rows(), 3);
    add(Derivatives{&unused, &trace_matrix_});
    double trace = 0.0;
    for (const Eigen::Matrix3d& block : trace_matrix_.diagonal) trace += block.trace();
    return trace;
  };
  const double of_matches =
      trace_of([&](const Derivatives& to) { observed(frame, scales, nodes_m, to); });
  const double of_outline =
      trace_of([&](const Derivatives& to) { outlined(frame, scales, nodes_m, to); });
  if (of_outline > kMostTrace * of_matches) outline_.share *= kMostTrace * of_matches / of_outline;
}

double Energy::outlined(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
                        const Derivatives& to) const {
  if (!frame.outline.present() || !(scales.outline.share > 0.0)) return 0.0;
  const Pinhole& camera = frame.camera;
  const double per_px = 1.0 / scales.outline.noise_px;
  double energy = outline_.missed();
  for (std::size_t i = 0; i < outline_points_.size(); ++i) {
    const solvers::OutlinePoint& line = outline_.points()[i];
    const Eigen::Vector3d p = outline_points_[i].on(body_->tetrahedra(), nodes_m);
    if (!(p.z() > 0.0)) return std::numeric_limits<double>::infinity();
    const double off = per_px * (line.normal.dot(project(camera, p)) - line.offset_px);
    double own = 0.0;
    const double weight = outline_.share * line.share * outline_.loss().weight(off, own);
    energy += line.share * own;
    if (to.gradient == nullptr) continue;
    const Eigen::Vector2d along(camera.fx * line.normal.x(), camera.fy * line.normal.y());
    const Eigen::Vector3d slope =
        per_px / p.z() * Eigen::Vector3d(along.x(), along.y(), -along.dot(p.head<2>()) / p.z());
    add_point(outline_points_[i], weight * off * slope, weight * slope * slope.transpose(), to);
  }
  return outline_.share * energy;
}

double Energy::known(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
                     const Derivatives& to) const {
  const double weight = 1.0 / (scales.known_m * scales.known_m);
  double energy = 0.0;
  for (const KnownPlace& each : frame.known) {
    const Eigen::Vector3d off_m = each.point.on(body_->tetrahedra(), nodes_m) - each.centre_m;
    const double length_m = off_m.norm(), beyond_m = length_m - each.radius_m;
    if (!(beyond_m > 0.0)) continue;
    energy += weight * beyond_m * beyond_m;
    if (to.gradient == nullptr) continue;
    add_point(each.point, weight * beyond_m / length_m * off_m,
              weight * Eigen::Matrix3d::Identity(), to);
  }
  return energy;
}

void Energy::add_point(const BodyPoint& point, const Eigen::Vector3d& half_gradient,
                       const Eigen::Matrix3d& half_curvature, const Derivatives& to) const {
  const Tetrahedron& in = body_->tetrahedra()[to_index(point.tetrahedron)];
  std::size_t pair = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    const double of_a = point.weights[static_cast<Eigen::Index>(a)];
    to.gradient->row(in.node[a]) += of_a * half_gradient.transpose();
    to.matrix->diagonal[to_index(in.node[a])] += of_a * of_a * half_curvature;
    for (std::size_t b = a + 1; b < 4; ++b) {
      const double of_b = point.weights[static_cast<Eigen::Index>(b)];
      to.matrix->coupling[to_index(in.coupling[pair++])] += of_a * of_b * half_curvature;
    }
  }
}

}  // namespace weft::volume
