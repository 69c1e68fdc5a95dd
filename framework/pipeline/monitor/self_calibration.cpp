// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/self_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>

namespace weft {
namespace {

constexpr double kLeastStrain = 0.002, kBend_rad = 0.3;
constexpr double kLeastNoise_px = 0.5;  // noise of a keypoint's place
constexpr int kLeastMatches = 30, kMostSteps = 25, kMostHalvings = 6, kMostRelaxed = 3;
constexpr double kLongestStep = 0.3;
constexpr double kLastStep = 0.1;   // in standard deviations
constexpr double kLeastGain = 0.3;  // gain of a sum of squares in standard deviations

/// A pixel and its derivatives by the point in the camera frame and by the deviation.
struct Projection {
  Eigen::Vector2d pixel_px;
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Matrix<double, 2, kParts> by_deviation;
};

Projection project(const Camera& camera, const PartVector& deviation,
                   const Eigen::Vector3d& point_m) {
  const double fx = camera.fx * std::exp(deviation(kFocal) - deviation(kAspect));
  const double fy = camera.fy * std::exp(deviation(kFocal) + deviation(kAspect));
  const double x = point_m.x() / point_m.z(), y = point_m.y() / point_m.z(), k = deviation(kLens);
  const double square = x * x + y * y, lens = 1.0 + k * square;
  const double u = fx * x * lens, v = fy * y * lens;
  const double xx = lens + 2.0 * k * x * x, yy = lens + 2.0 * k * y * y, xy = 2.0 * k * x * y;
  Projection result;
  result.pixel_px << u + camera.cx + camera.fx * deviation(kCentreX),
      v + camera.cy + camera.fy * deviation(kCentreY);
  result.by_point << fx * xx, fx * xy, -fx * (xx * x + xy * y),  //
      fy * xy, fy * yy, -fy * (xy * x + yy * y);
  result.by_point /= point_m.z();
  result.by_deviation << u, -u, fx * x * square, camera.fx, 0.0, 0.0, 0.0, 0.0,  //
      v, v, fy * y * square, 0.0, camera.fy, 0.0, 0.0, 0.0;
  return result;
}

}  // namespace

Result<SelfCalibration> SelfCalibration::of(const Template& templ) {
  SelfCalibration calibration;
  calibration.faces_ = templ.faces.matrix<3>();
  const auto rest_m = templ.vertices_m.matrix<3>();
  const auto topology = build_topology(calibration.faces_, rest_m.rows());
  if (!topology) return topology.error();
  auto edges = distance_constraints(topology->edges, rest_m);
  if (!edges) return edges.error();
  calibration.edges_ = *std::move(edges);
  const auto flat_px = templ.flat_px.matrix<2>();
  const Eigen::RowVector2d low_px = flat_px.colwise().minCoeff();
  const Eigen::RowVector2d size_px = flat_px.colwise().maxCoeff() - low_px;
  calibration.edge_places_.resize(topology->edges.rows(), 3);
  calibration.edge_directions_.resize(topology->edges.rows(), 2);
  for (Eigen::Index e = 0; e < topology->edges.rows(); ++e) {
    const Eigen::RowVector2d from_px = flat_px.row(topology->edges(e, 0));
    const Eigen::RowVector2d to_px = flat_px.row(topology->edges(e, 1));
    const Eigen::RowVector2d from_low_px = 0.5 * (from_px + to_px) - low_px;
    const Eigen::RowVector2d along = (to_px - from_px).normalized();
    calibration.edge_directions_.row(e) << along.x() * along.x() - along.y() * along.y(),
        2.0 * along.x() * along.y();
    const Eigen::RowVector2d place = 2.0 * from_low_px.cwiseQuotient(size_px).array() - 1.0;
    calibration.edge_places_.row(e) << place, place.squaredNorm();
  }
  calibration.hinges_ = bending_hinges(rest_m, calibration.faces_, *topology);
  for (const BendingHinge& hinge : calibration.hinges_) {
    Eigen::RowVector3d bend = Eigen::RowVector3d::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      bend += hinge.coefficient_per_m[k] * rest_m.row(hinge.vertex[k]);
    }
    calibration.rest_bend_rad_.push_back(bend.norm());
  }
  calibration.face_blocks_.resize(to_index(calibration.faces_.rows()));
  return calibration;
}

std::optional<CameraEvidence> SelfCalibration::look(const Camera& camera,
                                                    const Points3View& vertices_m,
                                                    const Correspondences& matches) {
  observations_.clear();
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0 || matches.face(i) < 0) continue;
    observations_.push_back({matches.face(i), matches.barycentrics.matrix<3>().row(i),
                             matches.image_px.matrix<2>().row(i)});
  }
  if (observations_.size() < kLeastMatches) return std::nullopt;
  State& state = state_;
  state.vertices_m = vertices_m;
  state.deviation.setZero();
  state.strain = kLeastStrain;
  CameraEvidence evidence;
  int relaxed = 0;
  for (int i = 0; i < kMostSteps; ++i) {
    if (!measure_noise(camera, state)) return std::nullopt;
    const auto change = step(camera, evidence);
    if (!change) return std::nullopt;
    if (*change >= kLastStep) continue;
    // A stretching surface cannot be held to its lengths.
    const double strain = measured_strain(state);
    if (strain <= state.strain || ++relaxed > kMostRelaxed) {
      evidence.add_strain(equations_, step_at_);
      return evidence;
    }
    state.strain = strain;
  }
  return std::nullopt;
}

/// Measures the noise of the matches. False if a point is not in front of the camera, or they do
/// not fit.
bool SelfCalibration::measure_noise(const Camera& camera, State& state) {
  constexpr double kMedianOfRayleigh = 1.1774, kMost_px = 20.0;
  residuals_px_.clear();
  for (const Observation& seen : observations_) {
    const Eigen::Vector3d point_m = interpolate(state.vertices_m, faces_, seen.face, seen.weights);
    if (!(point_m.z() > 0.0)) return false;
    residuals_px_.push_back(
        (project(camera, state.deviation, point_m).pixel_px - seen.pixel_px).norm());
  }
  state.noise_px = std::max(kLeastNoise_px, median_in_place(residuals_px_) / kMedianOfRayleigh);
  return state.noise_px < kMost_px;
}

/// Measures the strain of the edges as they are.
double SelfCalibration::measured_strain(const State& state) {
  strains_.clear();
  for (const DistanceConstraint& edge : edges_) {
    const double length_m = (state.vertices_m.row(edge.i) - state.vertices_m.row(edge.j)).norm();
    strains_.push_back(std::abs(length_m / edge.rest_length_m - 1.0));
  }
  return kSigmaPerMad * median_in_place(strains_);
}

void SelfCalibration::add_matches(const Camera& camera, const State& state) {
  for (auto& block : face_blocks_) block.setZero();
  for (const Observation& seen : observations_) {
    const Eigen::Vector3d point_m = interpolate(state.vertices_m, faces_, seen.face, seen.weights);
    const Projection at = project(camera, state.deviation, point_m);
    const Eigen::Vector2d residual_px = at.pixel_px - seen.pixel_px;
    // Geman-McClure with the bend at three times the noise.
    const double robust = 1.0 + (residual_px / (3.0 * state.noise_px)).squaredNorm();
    const double weight = 1.0 / (state.noise_px * state.noise_px * robust * robust);
    const Eigen::Matrix3d square = weight * at.by_point.transpose() * at.by_point;
    const Eigen::Matrix<double, 3, kParts> mixed =
        weight * at.by_point.transpose() * at.by_deviation;
    const Eigen::Vector3d gradient = weight * at.by_point.transpose() * residual_px;
    auto& block = face_blocks_[to_index(seen.face)];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Index row = 3 * faces_(seen.face, k);
      equations_.mixed.middleRows<3>(row) += seen.weights(k) * mixed;
      equations_.vertex_gradient.segment<3>(row) += seen.weights(k) * gradient;
      for (int l = 0; l < 3; ++l) {
        block.block<3, 3>(3 * k, 3 * l) += seen.weights(k) * seen.weights(l) * square;
      }
    }
    equations_.parts += weight * at.by_deviation.transpose() * at.by_deviation;
    equations_.part_gradient += weight * at.by_deviation.transpose() * residual_px;
  }
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    const auto& block = face_blocks_[to_index(f)];
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < 3; ++l) {
        equations_.add_block(faces_(f, k), faces_(f, l), block.block<3, 3>(3 * k, 3 * l));
      }
    }
  }
}

/// How much longer an edge is than by the template and its deviation.
double SelfCalibration::edge_over_m(const State& state, std::size_t e) const {
  const DistanceConstraint& edge = edges_[e];
  const auto place = edge_places_.row(static_cast<Eigen::Index>(e));
  const double stretch = place.dot(state.deviation.segment<3>(kKeystoneX));
  return (state.vertices_m.row(edge.j) - state.vertices_m.row(edge.i)).norm() -
         edge.rest_length_m * (1.0 + stretch);
}

void SelfCalibration::add_edges(const State& state) {
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const DistanceConstraint& edge = edges_[e];
    const Eigen::Vector3d along = state.vertices_m.row(edge.j) - state.vertices_m.row(edge.i);
    const double length_m = std::max(along.norm(), 1e-9);
    const Eigen::Vector3d unit = along / length_m;
    const double std_m = state.strain * edge.rest_length_m, weight = 1.0 / (std_m * std_m);
    const Eigen::Vector3d by_template_m =
        edge.rest_length_m * edge_places_.row(static_cast<Eigen::Index>(e)).transpose();
    const double over_m = edge_over_m(state, e);
    const Eigen::Matrix3d square = weight * unit * unit.transpose();
    const Eigen::Matrix3d mixed = weight * unit * by_template_m.transpose();
    equations_.vertex_gradient.segment<3>(3 * edge.i) -= weight * over_m * unit;
    equations_.vertex_gradient.segment<3>(3 * edge.j) += weight * over_m * unit;
    equations_.mixed.block<3, 3>(3 * edge.i, kKeystoneX) += mixed;
    equations_.mixed.block<3, 3>(3 * edge.j, kKeystoneX) -= mixed;
    equations_.parts.block<3, 3>(kKeystoneX, kKeystoneX) +=
        weight * by_template_m * by_template_m.transpose();
    equations_.part_gradient.segment<3>(kKeystoneX) -= weight * over_m * by_template_m;
    const StrainVector by_strain_m =
        edge.rest_length_m * edge_directions_.row(static_cast<Eigen::Index>(e)).transpose();
    const Eigen::Matrix<double, 3, kStrains> strained = weight * unit * by_strain_m.transpose();
    equations_.strain_mixed.middleRows<3>(3 * edge.i) += strained;
    equations_.strain_mixed.middleRows<3>(3 * edge.j) -= strained;
    equations_.strains += weight * by_strain_m * by_strain_m.transpose();
    equations_.parts_by_strains.middleRows<3>(kKeystoneX) +=
        weight * by_template_m * by_strain_m.transpose();
    equations_.strain_gradient -= weight * over_m * by_strain_m;
    equations_.add_block(edge.i, edge.i, square);
    equations_.add_block(edge.j, edge.j, square);
    equations_.add_block(std::max(edge.i, edge.j), std::min(edge.i, edge.j), -square);
  }
}

/// From the bend at rest in the direction of the present one.
Eigen::Vector3d SelfCalibration::bend_off(const State& state, std::size_t hinge) const {
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    bend += hinges_[hinge].coefficient_per_m[k] *
            state.vertices_m.row(hinges_[hinge].vertex[k]).transpose();
  }
  if (rest_bend_rad_[hinge] > 0.0) bend -= rest_bend_rad_[hinge] * bend.normalized();
  return bend;
}

void SelfCalibration::add_hinges(const State& state) {
  constexpr double kWeight = 1.0 / (kBend_rad * kBend_rad);
  for (std::size_t h = 0; h < hinges_.size(); ++h) {
    const BendingHinge& hinge = hinges_[h];
    const Eigen::Vector3d bend = bend_off(state, h);
    for (std::size_t k = 0; k < 4; ++k) {
      const double scaled = kWeight * hinge.coefficient_per_m[k];
      equations_.vertex_gradient.segment<3>(3 * hinge.vertex[k]) += scaled * bend;
      for (std::size_t l = 0; l < 4; ++l) {
        equations_.add_block(hinge.vertex[k], hinge.vertex[l],
                             scaled * hinge.coefficient_per_m[l] * Eigen::Matrix3d::Identity());
      }
    }
  }
}

double SelfCalibration::cost(const Camera& camera, const State& state) const {
  double sum = state.deviation.cwiseQuotient(prior_std()).squaredNorm();
  for (const Observation& seen : observations_) {
    const Eigen::Vector3d point_m = interpolate(state.vertices_m, faces_, seen.face, seen.weights);
    if (!(point_m.z() > 0.0)) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d residual_px =
        project(camera, state.deviation, point_m).pixel_px - seen.pixel_px;
    const double square = residual_px.squaredNorm() / (state.noise_px * state.noise_px);
    sum += square / (1.0 + square / 9.0);
  }
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const double over = edge_over_m(state, e) / (state.strain * edges_[e].rest_length_m);
    sum += over * over;
  }
  for (std::size_t h = 0; h < hinges_.size(); ++h) {
    sum += bend_off(state, h).squaredNorm() / (kBend_rad * kBend_rad);
  }
  return sum;
}

std::optional<double> SelfCalibration::step(const Camera& camera, CameraEvidence& evidence) {
  constexpr double kFloor_per_m2 = 1.0;  // parameters without constraints stay unchanged
  State& state = state_;
  step_at_ = state.deviation;
  equations_.begin(state.vertices_m.rows(), kFloor_per_m2);
  add_matches(camera, state);
  add_edges(state);
  add_hinges(state);
  if (!equations_.solve()) return std::nullopt;
  const auto &mixed = equations_.mixed, &by_parts = equations_.by_parts;
  evidence.information = equations_.parts - mixed.transpose() * by_parts;
  const PartVector gradient = equations_.part_gradient - mixed.transpose() * equations_.alone;
  evidence.weighted = evidence.information * state.deviation - gradient;
  const CameraDeviation likeliest = CameraDeviation::of(evidence);
  const PartVector change = likeliest.mean - state.deviation;
  const double largest = change.cwiseAbs().maxCoeff();
  if (!std::isfinite(largest)) return std::nullopt;
  move_ = -equations_.alone;
  move_.noalias() -= by_parts * change;
  const Eigen::Map<const Points3> move_m(move_.data(), state.vertices_m.rows(), 3);
  const double before = cost(camera, state);
  const double longest = std::min(1.0, kLongestStep / std::max(largest, 1e-12));
  for (int halved = 0; halved < kMostHalvings; ++halved) {
    const double share = std::ldexp(longest, -halved);
    next_ = state;
    next_.vertices_m += share * move_m;
    next_.deviation += share * change;
    const double after = cost(camera, next_);
    if (!(after < before)) continue;
    std::swap(state, next_);
    if (before - after < kLeastGain) break;
    return change.cwiseAbs().cwiseQuotient(likeliest.stds()).maxCoeff();
  }
  return 0.0;
}

}  // namespace weft
