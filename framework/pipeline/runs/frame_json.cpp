// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/frame_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <weft/core/statistics.hpp>
#include <weft/geometry/vertex_spread.hpp>

namespace weft {
namespace {

using nlohmann::ordered_json;

/// Counts without a decimal point; JSON has no NaN, so that becomes null.
ordered_json number_json(double value) {
  constexpr double kLargestExact = 9007199254740992.0;
  if (value == std::floor(value) && std::abs(value) < kLargestExact) {
    return static_cast<std::int64_t>(value);
  }
  return value;
}

ordered_json stage_json(const StageReport& report) {
  ordered_json object{{"stage", report.stage}, {"status", to_string(report.status)}};
  if (!report.reason.empty()) object["reason"] = report.reason;
  object["ms"] = rounded(report.took.ms, 1000.0);
  object["processor_ms"] = rounded(report.took.processor_ms, 1000.0);
  for (const auto& [name, value] : report.numbers) object[name] = number_json(value);
  return object;
}

/// The sum over a component's calls, for each that was called.
ordered_json time_by_component(const host::Timings& timings, double host::Spent::*part) {
  std::map<std::string, double> sums;
  for (const host::Timing& timing : timings) sums[timing.component] += timing.took.*part;
  ordered_json times = ordered_json::object();
  for (const auto& [component, sum] : sums) times[component] = rounded(sum, 1000.0);
  return times;
}

/// The confidence of the shape, as a whole and at each vertex.
void add_certainty(const host::RecordPtr& record, ordered_json& line) {
  constexpr double kMmPerM = 1000.0;
  const auto shape =
      record == nullptr ? Result<Shape>(no_result("none")) : host::view_as<Shape>(*record);
  line["confidence"] = shape ? ordered_json(rounded(shape->confidence, 1e4)) : ordered_json();
  std::vector<double> stds_mm = shape ? vertex_stds_m(*shape) : std::vector<double>();
  if (stds_mm.empty()) return;
  for (double& each : stds_mm) each = rounded(kMmPerM * each, 100.0);
  line["std_median_mm"] = median(stds_mm);
  line["std_worst_mm"] = *std::max_element(stds_mm.begin(), stds_mm.end());
  line["std_mm"] = stds_mm;
}

}  // namespace

double rounded(double value, double parts) { return std::round(value * parts) / parts; }

std::string frame_json(const FrameResult& frame, std::optional<std::size_t> records) {
  ordered_json stages = ordered_json::array();
  for (const StageReport& report : frame.stages) stages.push_back(stage_json(report));
  ordered_json line{{"frame", frame.index},
                    {"stem", frame.stem},
                    {"state", to_string(frame.state)},
                    {"age", frame.age_frames}};
  if (!frame.changes.empty()) line["changes"] = frame.changes;
  add_certainty(frame.shape, line);
  if (!frame.reason.empty()) line["reason"] = frame.reason;
  line["failed"] = frame.failed();
  if (!frame.late_in.empty()) line["late_in"] = frame.late_in.str();
  if (records) line["records"] = *records;
  line["stages"] = std::move(stages);
  for (const auto& [name, value] : frame.setup) line["setup"][name] = rounded(value, 1e4);
  if (!frame.warnings.empty()) line["warnings"] = frame.warnings;
  line["ms"] = time_by_component(frame.timings, &host::Spent::ms);
  line["processor_ms"] = time_by_component(frame.timings, &host::Spent::processor_ms);
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace weft
