// SPDX-License-Identifier: Apache-2.0
#include "fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

namespace weft::gauss_newton {
namespace {

constexpr double kFarPx = 3.0;
constexpr int kFewestAround = 4;
constexpr double kFarAway = 1e6;  // px

/// The point of a face, taken for flat.
Eigen::Vector3d flat_point_m(const MeshModel& mesh, std::int32_t face, const Observation& seen,
                             const Points3& vertices_m) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t v = mesh.faces(face, static_cast<Eigen::Index>(k));
    point += seen.weights[k] * vertices_m.row(v).transpose();
  }
  return point;
}

double finite_or_far(double distance) {
  return std::isnan(distance) ? std::numeric_limits<double>::infinity() : distance;
}

template <class Visit>
void each_observation(const FrameData& frame, const Visit& visit) {
  for (const SeenFace& seen : frame.faces) {
    for (std::size_t i = seen.first; i < seen.end; ++i) visit(seen.face, frame.observations[i]);
  }
}

}  // namespace

Fit FitGauge::measure(const MeshModel& mesh, const FrameData& frame, const Energy& energy,
                      const Points3& vertices_m) {
  Fit fit;
  first_.clear();
  second_.clear();
  whitened_.clear();
  double far = 0.0;
  each_observation(frame, [&](std::int32_t face, const Observation& seen) {
    const Eigen::Vector2d seen_px(seen.seen_px[0], seen.seen_px[1]);
    const Eigen::Vector2d shown_px =
        project(frame.camera, energy.surface_point_m(vertices_m, face, seen.weights));
    const Eigen::Vector2d off_px = shown_px - seen_px;
    whitened_.emplace_back(seen.white.xx * off_px.x(),
                           seen.white.yx * off_px.x() + seen.white.yy * off_px.y());
    first_.push_back(finite_or_far(off_px.norm()));
    second_.push_back(finite_or_far(whitened_.back().norm()));
    if (!(first_.back() <= kFarPx)) far += 1.0;
  });
  fit.far_share = far / static_cast<double>(first_.size());
  fit.far_around = far_around(mesh, frame);
  fit.coherence = coherence(mesh, frame);
  fit.residual_px = median_in_place(first_);
  fit.residual = median_in_place(second_);
  measure_lengths(mesh, vertices_m, fit);
  double back = 0.0;
  for (const SeenFace& seen : frame.faces) {
    const Eigen::Vector3d a = vertices_m.row(mesh.faces(seen.face, 0)),
                          b = vertices_m.row(mesh.faces(seen.face, 1)),
                          c = vertices_m.row(mesh.faces(seen.face, 2));
    if (!((b - a).cross(c - a).dot(a) < 0.0)) back += 1.0;
  }
  fit.back_share = back / static_cast<double>(frame.faces.size());
  return fit;
}

void FitGauge::measure_lengths(const MeshModel& mesh, const Points3& vertices_m, Fit& fit) {
  first_.clear();
  for (const Arc& edge : mesh.edges) {
    const double length_m = (vertices_m.row(edge.i) - vertices_m.row(edge.j)).norm();
    first_.push_back(std::abs(length_m / edge.rest_m - 1.0));
  }
  fit.strain = mean(first_);
  const auto rank = first_.begin() + static_cast<std::ptrdiff_t>(first_.size() * 19 / 20);
  std::nth_element(first_.begin(), rank, first_.end());
  fit.crease = *rank;
}

Fit FitGauge::measure_outline(const MeshModel& mesh, const FrameData& frame, double noise_px,
                              const Energy& energy, const Points3& vertices_m) {
  Fit fit;
  first_.clear();
  for (const OutlinePoint& point : energy.outline().points()) {
    const Eigen::Vector2d shown_px =
        project(frame.camera, energy.surface_point_m(vertices_m, point.face, point.weights));
    first_.push_back(std::abs(point.normal.dot(shown_px) - point.offset_px));
  }
  fit.residual_px = first_.empty() ? kFarAway : finite_or_far(median_in_place(first_));
  fit.residual = fit.residual_px / noise_px;
  fit.far_share = 1.0 - energy.outline().met_share();
  measure_lengths(mesh, vertices_m, fit);
  double back = 0.0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices_m.row(mesh.faces(f, 0)),
                          b = vertices_m.row(mesh.faces(f, 1)),
                          c = vertices_m.row(mesh.faces(f, 2));
    if (!((b - a).cross(c - a).dot(a) < 0.0)) back += 1.0;
  }
  fit.back_share = back / static_cast<double>(mesh.faces.rows());
  return fit;
}

/// Large residuals in one place only come from the shape, not from chance. Reads the distances in
/// first_, in the order of the observations.
double FitGauge::far_around(const MeshModel& mesh, const FrameData& frame) {
  seen_around_.assign(to_index(mesh.vertex_count()), {0, 0});
  std::size_t next = 0;
  each_observation(frame, [&](std::int32_t face, const Observation&) {
    const bool is_far = !(first_[next++] <= kFarPx);
    for (Eigen::Index k = 0; k < 3; ++k) {
      auto& around = seen_around_[to_index(mesh.faces(face, k))];
      ++around[0];
      around[1] += is_far ? 1 : 0;
    }
  });
  double most = 0.0;
  for (const auto& [seen, far] : seen_around_) {
    if (seen >= kFewestAround) most = std::max(most, static_cast<double>(far) / seen);
  }
  return most;
}

/// For n independent residuals of variance s^2 the square of the sum is n s^2 on average.
double FitGauge::coherence(const MeshModel& mesh, const FrameData& frame) {
  constexpr double kOutlier = 3.0;  // such residuals are hardly trusted
  sums_.assign(to_index(mesh.vertex_count()), {});
  double squares = 0.0, squares_of_sums = 0.0;
  std::size_t next = 0, counted = 0, counted_around = 0;
  each_observation(frame, [&](std::int32_t face, const Observation&) {
    const Eigen::Vector2d& whitened = whitened_[next++];
    if (!(whitened.norm() <= kOutlier)) return;
    squares += whitened.squaredNorm();
    ++counted;
    for (Eigen::Index k = 0; k < 3; ++k) {
      Sum& sum = sums_[to_index(mesh.faces(face, k))];
      sum.whitened += whitened;
      ++sum.count;
    }
  });
  for (const Sum& sum : sums_) {
    if (sum.count < kFewestAround) continue;
    squares_of_sums += sum.whitened.squaredNorm() / sum.count;
    ++counted_around;
  }
  if (!(squares > 0.0) || counted_around == 0) return 1.0;
  const double independent = squares / static_cast<double>(counted);
  return std::max(1.0, squares_of_sums / static_cast<double>(counted_around) / independent);
}

solvers::ImageMotion FitGauge::motion(const MeshModel& mesh, const FrameData& frame,
                                      const Points3& vertices_m) {
  const auto count = static_cast<Eigen::Index>(frame.observations.size());
  measured_px_.resize(count, 2);
  projected_px_.resize(count, 2);
  Eigen::Index i = 0;
  each_observation(frame, [&](std::int32_t face, const Observation& seen) {
    measured_px_.row(i) << seen.seen_px[0], seen.seen_px[1];
    projected_px_.row(i++) =
        project(frame.camera, flat_point_m(mesh, face, seen, vertices_m)).transpose();
  });
  return solvers::image_motion(measured_px_, projected_px_);
}

bool FitGauge::is_behind(const MeshModel& mesh, const FrameData& frame, const Points3& vertices_m) {
  first_.clear();
  each_observation(frame, [&](std::int32_t face, const Observation& seen) {
    first_.push_back(flat_point_m(mesh, face, seen, vertices_m).z());
  });
  return median_in_place(first_) < 0.0;
}

}  // namespace weft::gauss_newton
