// SPDX-License-Identifier: Apache-2.0
#include "frame_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>
#include <weft/geometry/barycentric.hpp>

namespace weft::evaluation {
namespace {

constexpr double kMmPerM = 1000.0;

/// Mean over the matches labelled correct of |pi(X(p)) - q|, X(p) on the estimated mesh.
double reprojection_error_px(const Correspondences& matches, const std::vector<std::int8_t>& labels,
                             const Points3View& vertices_m, const Template& sheet,
                             const Pinhole& camera) {
  const Faces faces = sheet.faces.matrix<3>();
  std::vector<double> errors_px;
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    const std::int32_t face = matches.face(n);
    if (labels[static_cast<std::size_t>(n)] != 1 || face < 0 || face >= faces.rows()) continue;
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(n).transpose();
    const Eigen::Vector3d point_m = interpolate(vertices_m, faces, face, weights);
    const Eigen::Vector2d image_px(matches.image_px(n, 0), matches.image_px(n, 1));
    errors_px.push_back((project(camera, point_m) - image_px).norm());
  }
  return errors_px.empty() ? kUnknown : mean(errors_px);
}

/// Mean over the vertices whose true place is known of |pi(X_v) - its image|.
double overlay_error_px(const Points3View& vertices_m, const Template& sheet, const TruthMap& truth,
                        const Pinhole& camera) {
  const Eigen::Vector2d m_per_px = sheet.m_per_px.matrix<1>();
  std::vector<double> errors_px;
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    const Eigen::Vector2d flat_px = sheet.flat_px.matrix<2>().row(v).transpose();
    const auto true_m = truth.at(flat_px.cwiseProduct(m_per_px));
    if (!true_m) continue;
    const Eigen::Vector3d vertex_m = vertices_m.row(v).transpose();
    errors_px.push_back((project(camera, vertex_m) - project(camera, *true_m)).norm());
  }
  return errors_px.empty() ? kUnknown : mean(errors_px);
}

PointSummary summarise(const PointErrors& errors) {
  std::vector<double> mm;
  for (const double distance_m : errors.distances_m) mm.push_back(kMmPerM * distance_m);
  const auto worst = std::max_element(mm.begin(), mm.end());
  const std::int64_t point = errors.points[static_cast<std::size_t>(worst - mm.begin())];
  return {mean(mm), median(mm), percentile(mm, 95.0), *worst, point};
}

Outcome outcome_of(const FrameRecords& records) {
  if (!records.shape) return Outcome::missing;
  if (!std::isfinite(records.shape->vertices_m.matrix<3>().squaredNorm())) return Outcome::invalid;
  const ShapeState state = records.shape->shape_state();
  const bool solved = state == ShapeState::estimated || state == ShapeState::weak;
  return solved ? Outcome::solved : Outcome::held;
}

/// Compares a finite shape with the truth.
Result<void> measure_error(const ShapeMeter& meter, const FrameRecords& records,
                           Alignment alignment, FrameMetrics& frame) {
  const auto errors =
      meter.errors(records.shape->vertices_m.matrix<3>(), *records.ground_truth, alignment);
  if (!errors && errors.error().code != Errc::no_result) {
    return Error{errors.error().code, errors.error().message, "template.npz"};
  }
  if (!errors) {
    frame.no_error_because = errors.error().message;
    return {};
  }
  frame.extrapolated = errors->extrapolated;
  frame.unlocated = errors->unlocated;
  if (errors->distances_m.empty()) {
    frame.no_error_because = "no point of the truth lies on the template's mesh";
  } else {
    frame.error = summarise(*errors);
  }
  return {};
}

/// Labels by the truth, what filters made of them, and errors of the shape in the image.
void measure_image(const RunReader& reader, const FrameRecords& records, bool has_shape,
                   double match_tolerance_px, FrameMetrics& frame) {
  if (!reader.sheet().m_per_px.present()) return;
  const Pinhole camera{reader.camera().fx, reader.camera().fy, reader.camera().cx,
                       reader.camera().cy};
  const Eigen::Vector2d m_per_px = reader.sheet().m_per_px.matrix<1>();
  const TruthMap truth(*records.ground_truth);
  frame.image.truth_map_px = truth.leave_one_out_px(camera);
  std::vector<std::int8_t> labels;
  for (const FilterRecords& filter : records.filters) {
    labels = label_matches(filter.matches, truth, m_per_px, camera, match_tolerance_px);
    frame.filters.emplace_back(filter.stage, count_filter(filter.matches, filter.mask, labels));
  }
  if (!has_shape) return;
  const auto vertices_m = records.shape->vertices_m.matrix<3>();
  if (!records.filters.empty()) {
    frame.image.reprojection_px = reprojection_error_px(records.filters.back().matches, labels,
                                                        vertices_m, reader.sheet(), camera);
  }
  frame.image.overlay_px = overlay_error_px(vertices_m, reader.sheet(), truth, camera);
}

}  // namespace

Result<FrameMetrics> evaluate_frame(const RunReader& reader, const ShapeMeter& meter,
                                    const FrameLine& line, const FrameRecords& records,
                                    const EvaluationOptions& options) {
  FrameMetrics frame;
  frame.frame = line.frame;
  frame.stem = line.stem;
  frame.state = line.state;
  frame.failed = line.failed;
  frame.outcome = outcome_of(records);
  frame.has_truth = records.ground_truth.has_value();
  if (frame.has_truth) {
    frame.kind = records.ground_truth->kind;
    frame.apart = records.ground_truth->apart;
    frame.points = records.ground_truth->count();
  }
  if (frame.has_truth) {
    measure_image(reader, records, frame.outcome == Outcome::solved, options.match_tolerance_px,
                  frame);
  }
  if (frame.outcome == Outcome::missing || frame.outcome == Outcome::invalid) {
    const bool missing = frame.outcome == Outcome::missing;
    if (frame.has_truth) frame.no_error_because = missing ? "no shape" : "the shape is not finite";
    return frame;
  }
  const StrainStatistics strain = meter.strain(records.shape->vertices_m.matrix<3>());
  frame.strain_mean = strain.mean;
  frame.strain_p95 = strain.p95;
  if (frame.has_truth) {
    if (auto done = measure_error(meter, records, options.alignment, frame); !done)
      return done.error();
  }
  return frame;
}

}  // namespace weft::evaluation
