// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <weft/core/whole_file.hpp>
#include <weft/evaluation/metrics_report.hpp>

#include "text_table.hpp"

namespace weft::evaluation {
namespace {

/// Nine digits, or nothing.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : "";
}

std::string counts_of(const FrameMetrics& frame, const std::string& stage) {
  for (const auto& [name, counts] : frame.filters) {
    if (name != stage) continue;
    return fmt::format(",{},{},{},{},{},{}", counts.entered, counts.kept, counts.mismatches,
                       counts.correct, counts.rejected_wrong, counts.rejected_right);
  }
  return ",,,,,,";
}

std::string row_of(const FrameMetrics& frame, const RunMetrics& metrics) {
  const PointSummary error = frame.error.value_or(PointSummary{});
  std::string row = fmt::format(
      "{},{},{},{},{},{},{},{},{},{}", frame.frame, csv_field(frame.stem), to_string(frame.state),
      to_string(frame.outcome), frame.failed ? 1 : 0, csv_field(frame.kind), csv_field(frame.apart),
      frame.motion.cut ? 1 : 0, to_string(metrics.alignment), frame.points);
  for (const double value :
       {error.mean_mm, error.median_mm, error.p95_mm, error.worst_mm, error.rmse_mm,
        error.of_depth_percent, 100.0 * frame.strain_mean, 100.0 * frame.strain_p95,
        frame.motion.jitter_mm, frame.motion.truth_jitter_mm}) {
    row += "," + number(value);
  }
  const ImageMetrics& image = frame.image;
  row += fmt::format(",{},{},{},{}", number(image.reprojection_px), image.reprojection_matches,
                     number(image.overlay_px), image.overlay_vertices);
  const DepthMetrics depth = frame.depth.value_or(DepthMetrics{});
  row += fmt::format(",{},{},{}", number(depth.median_mm), depth.matches, depth.without_depth);
  for (const FilterMetrics& filter : metrics.filters) row += counts_of(frame, filter.stage);
  return row + "\n";
}

}  // namespace

std::string to_csv(const RunMetrics& metrics) {
  std::string text =
      "frame,stem,state,outcome,failed,truth,apart,cut,alignment,points,mean_mm,median_mm,p95_mm,"
      "worst_mm,rmse_mm,of_depth_percent,isometry_error_percent,isometry_error_p95_percent,"
      "jitter_mm,truth_jitter_mm,reprojection_px,reprojection_matches,overlay_px,overlay_vertices,"
      "depth_median_mm,depth_matches,depth_matches_without";
  for (const FilterMetrics& filter : metrics.filters) {
    for (const char* count :
         {"entered", "kept", "mismatches", "correct", "rejected_wrong", "rejected_right"}) {
      text += "," + csv_field(filter.stage + "_" + count);
    }
  }
  text += "\n";
  for (const FrameMetrics& frame : metrics.frames) text += row_of(frame, metrics);
  return text;
}

Result<void> write_csv(const RunMetrics& metrics, const std::string& file) {
  return write_whole(to_csv(metrics), file);
}

}  // namespace weft::evaluation
