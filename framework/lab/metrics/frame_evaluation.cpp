// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/frame_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/truth/match_labels.hpp>

#include "lab/metrics/field.hpp"

namespace weft::lab {
namespace {

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
    if (labels[to_index(n)] != kCorrectMatch || matches.face(n) < 0) continue;
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(n);
    const Eigen::Vector3d point_m = interpolate(vertices_m, faces, matches.face(n), weights);
    const Eigen::Vector2d image_px = matches.image_px.matrix<2>().row(n);
    distances_px.push_back((project(camera, point_m) - image_px).norm());
  }
  image.reprojection_matches = static_cast<std::int64_t>(distances_px.size());
  image.reprojection_px = mean_px(distances_px, image);
}

/// Which matches of a stage its last filter kept.
const Array<std::uint8_t>& last_kept(const MatchRecords& made) {
  return made.filters.empty() ? made.matches.kept : made.filters.back().after;
}

/// Over the kept matches on the mesh: the estimate X(p) against the point D^-1(q) that the depth
/// camera saw at the match's pixel (Shetab-Bushehri et al. 2023, Section VI). The median, because
/// what is left of mismatches lies on the background.
std::optional<DepthMetrics> depth_metrics(const MatchRecords& made, const Points3View& vertices_m,
                                          const Template& sheet, const Pinhole& camera) {
  if (!made.depth_m.present()) return std::nullopt;
  const FacesView faces = sheet.faces.matrix<3>();
  const Array<std::uint8_t>& kept = last_kept(made);
  DepthMetrics depth;
  std::vector<double> distances_mm;
  for (std::int64_t n = 0; n < made.matches.count(); ++n) {
    if (kept(n) == 0 || made.matches.face(n) < 0) continue;
    const double depth_m = made.depth_m(n);
    if (!(depth_m > 0.0) || !std::isfinite(depth_m)) {
      ++depth.without_depth;
      continue;
    }
    const Eigen::Vector2d image_px = made.matches.image_px.matrix<2>().row(n);
    const Eigen::Vector3d ray = unit_ray(camera, image_px);
    const Eigen::Vector3d weights = made.matches.barycentrics.matrix<3>().row(n);
    const Eigen::Vector3d point_m = interpolate(vertices_m, faces, made.matches.face(n), weights);
    distances_mm.push_back(kMmPerM * (point_m - depth_m / ray.z() * ray).norm());
  }
  depth.matches = static_cast<std::int64_t>(distances_mm.size());
  depth.median_mm = median(distances_mm);
  return depth;
}

/// Over the vertices whose true place is known.
void measure_overlay(const Points3View& vertices_m, const Template& sheet, const TruthMap& truth,
                     const Pinhole& camera, ImageMetrics& image) {
  const Eigen::Vector2d m_per_px = sheet.m_per_px.matrix<1>();
  std::vector<double> distances_px;
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    const Eigen::Vector2d flat_px = sheet.flat_px.matrix<2>().row(v);
    const auto place = truth.at(flat_px.cwiseProduct(m_per_px));
    if (!place || !(place->point_m.z() > 0.0)) continue;
    const Eigen::Vector3d vertex_m = vertices_m.row(v);
    distances_px.push_back((project(camera, vertex_m) - project(camera, place->point_m)).norm());
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
  const std::int64_t point = errors.points[to_index(worst - mm.begin())];
  return {mean(mm),       median(mm), percentile(mm, 95.0), *worst, std::sqrt(mean(squares)),
          mean(of_depth), point};
}

/// The error that the shape predicts for itself. It is compared with the error in the camera's
/// frame, even if other metrics are aligned.
Result<void> measure_certainty(const RunReader& reader, const ShapeMeter& meter,
                               const FrameRecords& records, FrameMetrics& frame) {
  const Shape& shape = *records.shape;
  const GroundTruth& truth = *records.ground_truth;
  const auto errors = meter.errors(shape.vertices_m.matrix<3>(), truth, Alignment::none);
  if (!errors || errors->distances_m.empty()) return {};
  std::vector<double> seen_mm, all_mm;
  for (std::size_t i = 0; i < errors->points.size(); ++i) {
    all_mm.push_back(kMmPerM * errors->distances_m[i]);
    const bool seen = !truth.visible.present() || truth.visible(errors->points[i]) != 0;
    if (seen) seen_mm.push_back(all_mm.back());
  }
  FrameCertainty& certainty = frame.certainty.emplace();
  certainty.confidence = shape.confidence;
  certainty.seen_mm = mean(seen_mm.empty() ? all_mm : seen_mm);
  certainty.right = certainty.seen_mm < kRightShare * kMmPerM * meter.diagonal_m();
  certainty.silently_wrong = mean(all_mm) > kWrongMm && frame.state == ShapeState::estimated;
  const auto places = TruthMap::create(truth);
  if (!places) return places.error();
  count_deviations(shape, reader.sheet(), *places, certainty);
  return {};
}

FrameOutcome outcome_of(const FrameRecords& records) {
  if (!records.shape) return FrameOutcome::missing;
  if (!std::isfinite(records.shape->vertices_m.matrix<3>().squaredNorm()))
    return FrameOutcome::invalid;
  const ShapeState state = records.shape->shape_state();
  const bool solved = state == ShapeState::estimated || state == ShapeState::weak;
  return solved ? FrameOutcome::solved : FrameOutcome::carried_over;
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
  if (frame.visibility && frame.outcome == FrameOutcome::solved) {
    count_errors(*errors, records.ground_truth->visible, *frame.visibility);
  }
  add_errors(*errors, *records.ground_truth, frame.parts);
  frame.extrapolated = errors->extrapolated;
  frame.unlocated = errors->unlocated;
  if (frame.points == 0) {
    frame.no_error_because = records.ground_truth->cloud_m.present()
                                 ? "the places of its points on the template are unknown"
                                 : "the truth has no points";
  } else if (errors->distances_m.empty()) {
    frame.no_error_because = "no point of the truth lies on the template's mesh";
  } else {
    frame.error = summarise(*errors);
  }
  return {};
}

/// For a solved frame: distances between the surfaces of the shape and all of the truth, and each
/// part of it.
void measure_surfaces(const FrameRecords& records, const Template& sheet, std::int64_t samples,
                      FrameMetrics& frame) {
  const auto vertices_m = records.shape->vertices_m.matrix<3>();
  const auto faces = sheet.faces.matrix<3>();
  const TrueSurface truth = true_surface(*records.ground_truth);
  if (truth.points_m.empty()) return;
  frame.surface = surface_metrics(vertices_m, faces, truth, samples);
  frame.parts = frame_parts(vertices_m, faces, *records.ground_truth, samples);
}

void measure_warps(const FrameRecords& records, const Template& sheet, const TruthMap& truth,
                   const Pinhole& camera, FrameMetrics& frame) {
  if (records.matches.empty()) return;
  const MatchRecords& made = records.matches.back();
  for (const WarpRecords& warp : records.warps) {
    frame.warps.emplace_back(
        warp.stage, warp_errors(warp.samples, made.matches, last_kept(made), sheet, truth, camera));
  }
}

/// Labels by the truth, what filters made of them, and errors of a solved shape in the image.
Result<void> measure_image(const RunReader& reader, const FrameRecords& records,
                           double tolerance_px, FrameMetrics& frame) {
  const Template& sheet = reader.sheet();
  const Pinhole camera{reader.camera().fx, reader.camera().fy, reader.camera().cx,
                       reader.camera().cy};
  const auto truth = TruthMap::create(*records.ground_truth);
  if (!truth) {
    return Error{truth.error().code,
                 "frame " + std::to_string(frame.frame) + ": " + truth.error().message,
                 reader.folder()};
  }
  frame.image.truth_map_px = truth->leave_one_out_px(camera);
  if (records.ground_truth->visible.present()) {
    frame.visibility.emplace();
    if (records.visibility) count_vertices(*records.visibility, sheet, *truth, *frame.visibility);
  }
  std::vector<std::int8_t> labels;
  for (const MatchRecords& made : records.matches) {
    labels = label_matches(made.matches, *truth, sheet, camera, tolerance_px);
    for (const FilterRecords& filter : made.filters) {
      frame.filters.emplace_back(filter.stage,
                                 count_filter(filter.before, filter.after, filter.score, labels));
    }
  }
  const bool has_scale = sheet.m_per_px.present();
  if (has_scale) measure_warps(records, sheet, *truth, camera, frame);
  if (frame.outcome != FrameOutcome::solved) return {};
  const auto vertices_m = records.shape->vertices_m.matrix<3>();
  if (!records.matches.empty()) {
    measure_reprojection(records.matches.back().matches, labels, vertices_m, sheet, camera,
                         frame.image);
    frame.depth = depth_metrics(records.matches.back(), vertices_m, sheet, camera);
  }
  if (has_scale) measure_overlay(vertices_m, sheet, *truth, camera, frame.image);
  return {};
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
  if (records.registration) frame.registration = frame_registration(*records.registration);
  frame.has_truth = records.ground_truth.has_value();
  if (frame.has_truth) {
    frame.kind = records.ground_truth->kind;
    frame.exclusion = records.ground_truth->exclusion;
    frame.points = records.ground_truth->count();
    const auto done = measure_image(reader, records, options.match_tolerance_px, frame);
    if (!done) return done.error();
  }
  if (frame.outcome == FrameOutcome::missing || frame.outcome == FrameOutcome::invalid) {
    const bool missing = frame.outcome == FrameOutcome::missing;
    if (frame.has_truth) frame.no_error_because = missing ? "no shape" : "the shape is not finite";
    return frame;
  }
  const StrainStatistics strain = meter.strain(records.shape->vertices_m.matrix<3>());
  frame.strain_mean = strain.mean;
  frame.strain_p95 = strain.p95;
  if (frame.has_truth) {
    const bool solved = frame.outcome == FrameOutcome::solved;
    if (solved) measure_surfaces(records, reader.sheet(), options.surface_samples, frame);
    auto done = measure_error(meter, records, options.alignment, frame);
    if (done && solved) {
      done = measure_certainty(reader, meter, records, frame);
    }
    if (!done) return done.error();
  }
  return frame;
}

}  // namespace weft::lab
