// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <weft/evaluation/metrics_report.hpp>

#include "write_whole.hpp"

namespace weft::evaluation {
namespace {

/// Nine digits, or nothing.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : "";
}

/// Text as RFC 4180 wants it.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

}  // namespace

std::string to_csv(const RunMetrics& metrics) {
  std::string text =
      "frame,stem,state,outcome,failed,truth,apart,alignment,mean_mm,median_mm,p95_mm,worst_mm,"
      "isometry_error_percent,isometry_error_p95_percent,reprojection_px,overlay_px\n";
  for (const FrameMetrics& frame : metrics.frames) {
    const PointSummary error = frame.error.value_or(PointSummary{});
    text += fmt::format("{},{},{},{},{},{},{},{}", frame.frame, quoted(frame.stem),
                        to_string(frame.state), to_string(frame.outcome), frame.failed ? 1 : 0,
                        quoted(frame.kind), quoted(frame.apart), to_string(metrics.alignment));
    for (const double value :
         {error.mean_mm, error.median_mm, error.p95_mm, error.worst_mm, 100.0 * frame.strain_mean,
          100.0 * frame.strain_p95, frame.image.reprojection_px, frame.image.overlay_px}) {
      text += "," + number(value);
    }
    text += "\n";
  }
  return text;
}

Result<void> write_csv(const RunMetrics& metrics, const std::string& file) {
  return write_whole(to_csv(metrics), file);
}

}  // namespace weft::evaluation
