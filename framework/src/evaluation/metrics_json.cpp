// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <weft/core/version.hpp>
#include <weft/evaluation/metrics_report.hpp>

namespace weft::evaluation {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kPercent = 100.0;

ordered_json counts_json(const FrameCounts& counts) {
  const double share = static_cast<double>(counts.solved()) / static_cast<double>(counts.frames);
  return {{"frames", counts.frames},
          {"solved", counts.solved()},
          {"solved_percent", kPercent * share},
          {"estimated", counts.estimated},
          {"weak", counts.weak},
          {"predicted", counts.predicted},
          {"lost", counts.lost},
          {"none", counts.none},
          {"invalid", counts.invalid},
          {"failed", counts.failed}};
}

ordered_json summary_json(const ErrorSummary& summary) {
  ordered_json json{{"frames", summary.frames},
                    {"mean_mm", summary.mean_mm},
                    {"standard_error_mm", summary.standard_error_mm},
                    {"median_mm", summary.median_mm},
                    {"p95_mm", summary.p95_mm},
                    {"worst_mm", summary.worst_mm},
                    {"worst_frame", nullptr},
                    {"worst_point_mm", summary.worst_point_mm}};
  if (summary.frames > 0) json["worst_frame"] = summary.worst_frame;
  return json;
}

ordered_json group_json(const GroupMetrics& group) {
  return {{"kind", group.kind},
          {"apart", group.apart},
          {"frames", group.frames},
          {"solved", group.solved},
          {"held", group.held},
          {"missing", group.missing},
          {"invalid", group.invalid},
          {"unmeasured", group.unmeasured},
          {"off", group.off},
          {"points", group.points},
          {"points_extrapolated", group.extrapolated},
          {"points_unlocated", group.unlocated},
          {"error_solved", summary_json(group.solved_error)},
          {"error_held", summary_json(group.held_error)},
          {"isometry_error_percent", kPercent * group.strain_mean}};
}

ordered_json truth_json(const FrameMetrics& frame) {
  ordered_json json{{"kind", frame.kind},
                    {"apart", frame.apart},
                    {"points", frame.points},
                    {"points_extrapolated", frame.extrapolated},
                    {"points_unlocated", frame.unlocated}};
  if (frame.error) {
    json["mean_mm"] = frame.error->mean_mm;
    json["median_mm"] = frame.error->median_mm;
    json["p95_mm"] = frame.error->p95_mm;
    json["worst_mm"] = frame.error->worst_mm;
    json["worst_point"] = frame.error->worst_point;
  } else {
    json["no_error_because"] = frame.no_error_because;
  }
  return json;
}

ordered_json frame_json(const FrameMetrics& frame) {
  ordered_json json{{"frame", frame.frame},
                    {"stem", frame.stem},
                    {"state", to_string(frame.state)},
                    {"outcome", to_string(frame.outcome)},
                    {"failed", frame.failed},
                    {"isometry_error_percent", kPercent * frame.strain_mean},
                    {"isometry_error_p95_percent", kPercent * frame.strain_p95}};
  if (frame.has_truth) json["truth"] = truth_json(frame);
  return json;
}

}  // namespace

std::string to_json(const RunMetrics& metrics) {
  ordered_json groups = ordered_json::array(), frames = ordered_json::array();
  for (const GroupMetrics& group : metrics.groups) groups.push_back(group_json(group));
  for (const FrameMetrics& frame : metrics.frames) frames.push_back(frame_json(frame));
  ordered_json all = group_json(metrics.all);
  all.erase("kind");
  all.erase("apart");
  const ordered_json json{{"weft", kVersion},
                          {"run", metrics.run},
                          {"alignment", to_string(metrics.alignment)},
                          {"interrupted", metrics.interrupted},
                          {"truth_users", metrics.truth_users},
                          {"counts", counts_json(metrics.counts)},
                          {"isometry_error_percent", kPercent * metrics.strain_mean},
                          {"groups", std::move(groups)},
                          {"all", std::move(all)},
                          {"frames", std::move(frames)}};
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string metrics_file_name(Alignment alignment) {
  if (alignment == Alignment::none) return "metrics.json";
  return std::string("metrics_") + to_string(alignment) + ".json";
}

Result<void> write_json(const RunMetrics& metrics, const std::string& file) {
  std::error_code code;
  const bool replaceable = !fs::exists(file, code) || fs::is_regular_file(file, code);
  const std::string target = replaceable ? file + ".part" : file;  // a device is written directly
  std::ofstream stream(target, std::ios::binary | std::ios::trunc);
  stream << to_json(metrics);
  stream.close();
  if (stream && replaceable) fs::rename(target, file, code);
  if (!stream || (replaceable && code)) {
    return Error{Errc::io, "cannot be written; is the folder writable and the disk not full?",
                 file};
  }
  return {};
}

}  // namespace weft::evaluation
