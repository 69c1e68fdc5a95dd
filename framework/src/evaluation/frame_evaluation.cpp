// SPDX-License-Identifier: Apache-2.0
#include "frame_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>
#include <weft/geometry/barycentric.hpp>

namespace weft::evaluation {
namespace {

constexpr double kMmPerM = 1000.0;

/// The mean of distances, unless a point behind the camera has none.
double mean_px(const std::vector<double>& distances_px, ImageMetrics& image) {
  if (distances_px.empty()) return kUnknown;
  const double result = mean(distances_px);
  image.behind_camera = image.behind_camera || std::isnan(result);
  return result;
}

/// Over the matches labelled correct that lie on the mesh.
void measure_reprojection(const Correspondences& matches, const std::vector<std::int8_t>& labels,
                          const Points3View& vertices_m, const Template& sheet,
                          const Pinhole& camera, ImageMetrics& image) {
  const FacesView faces = sheet.faces.matrix<3>();
  std::vector<double> distances_px;
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    if (labels[static_cast<std::size_t>(n)] != 1 || matches.face(n) < 0) continue;
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(n);
    const Eigen::Vector3d point_m = interpolate(vertices_m, faces, matches.face(n), weights);
    const Eigen::Vector2d image_px = matches.image_px.matrix<2>().row(n);
    distances_px.push_back((project(camera, point_m) - image_px).norm());
  }
  image.reprojection_matches = static_cast<std::int64_t>(distances_px.size());
  image.reprojection_px = mean_px(distances_px, image);
}

/// Over the vertices whose true place is known.
void measure_overlay(const Points3View& vertices_m, const Template& sheet, const TruthMap& truth,
                     const Pinhole& camera, ImageMetrics& image) {
  const Eigen::Vector2d m_per_px = sheet.m_per_px.matrix<1>();
  std::vector<double> distances_px;
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    const Eigen::Vector2d flat_px = sheet.flat_px.matrix<2>().row(v);
    const auto true_m = truth.at(flat_px.cwiseProduct(m_per_px));
    if (!true_m || !(true_m->z() > 0.0)) continue;
    const Eigen::Vector3d vertex_m = vertices_m.row(v);
    distances_px.push_back((project(camera, vertex_m) - project(camera, *true_m)).norm());
  }
  image.overlay_vertices = static_cast<std::int64_t>(distances_px.size());
  image.overlay_px = mean_px(distances_px, image);
}

PointSummary summarise(const PointErrors& errors) {
  std::vector<double> mm, squares, of_depth;
  for (std::size_t i = 0; i < errors.distances_m.size(); ++i) {
    mm.push_back(kMmPerM * errors.distances_m[i]);
    squares.push_back(mm[i] * mm[i]);
    of_depth.push_back(100.0 * errors.distances_m[i] / errors.depths_m[i]);
  }
  const auto worst = std::max_element(mm.begin(), mm.end());
  const std::int64_t point = errors.points[static_cast<std::size_t>(worst - mm.begin())];
  return {mean(mm),       median(mm), percentile(mm, 95.0), *worst, std::sqrt(mean(squares)),
          mean(of_depth), point};
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

/// Labels by the truth, what filters made of them, and errors of a solved shape in the image.
void measure_image(const RunReader& reader, const FrameRecords& records, double tolerance_px,
                   FrameMetrics& frame) {
  const Template& sheet = reader.sheet();
  if (!sheet.m_per_px.present()) return;
  const Pinhole camera{reader.camera().fx, reader.camera().fy, reader.camera().cx,
                       reader.camera().cy};
  const TruthMap truth(*records.ground_truth);
  frame.image.truth_map_px = truth.leave_one_out_px(camera);
  std::vector<std::int8_t> labels;
  for (const MatchRecords& made : records.matches) {
    labels = label_matches(made.matches, truth, sheet.m_per_px.matrix<1>(), camera, tolerance_px);
    for (const FilterRecords& filter : made.filters) {
      frame.filters.emplace_back(filter.stage, count_filter(filter.before, filter.after, labels));
    }
  }
  if (frame.outcome != Outcome::solved) return;
  const auto vertices_m = records.shape->vertices_m.matrix<3>();
  if (!records.matches.empty()) {
    measure_reprojection(records.matches.back().matches, labels, vertices_m, sheet, camera,
                         frame.image);
  }
  measure_overlay(vertices_m, sheet, truth, camera, frame.image);
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
    measure_image(reader, records, options.match_tolerance_px, frame);
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
    const auto done = measure_error(meter, records, options.alignment, frame);
    if (!done) return done.error();
  }
  return frame;
}

}  // namespace weft::evaluation
