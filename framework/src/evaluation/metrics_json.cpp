// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <weft/core/version.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/evaluation/metrics_report.hpp>

#include "units.hpp"

namespace weft::evaluation {
namespace {

using nlohmann::ordered_json;

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
  ordered_json object{{"frames", summary.frames},
                      {"mean_mm", summary.mean_mm},
                      {"standard_error_mm", summary.standard_error_mm},
                      {"median_mm", summary.median_mm},
                      {"p95_mm", summary.p95_mm},
                      {"worst_mm", summary.worst_mm},
                      {"worst_frame", nullptr},
                      {"worst_point_mm", summary.worst_point_mm},
                      {"of_depth_percent", summary.of_depth_percent}};
  if (summary.frames > 0) object["worst_frame"] = summary.worst_frame;
  return object;
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
          {"failures", group.failures()},
          {"failure_percent",
           kPercent * static_cast<double>(group.failures()) / static_cast<double>(group.frames)},
          {"points", group.points},
          {"points_extrapolated", group.extrapolated},
          {"points_unlocated", group.unlocated},
          {"error_solved", summary_json(group.solved_error)},
          {"error_held", summary_json(group.held_error)},
          {"isometry_error_percent", kPercent * group.strain_mean},
          {"isometry_error_p95_percent", kPercent * group.strain_p95}};
}

ordered_json truth_json(const FrameMetrics& frame) {
  ordered_json object{{"kind", frame.kind},
                      {"apart", frame.apart},
                      {"points", frame.points},
                      {"points_extrapolated", frame.extrapolated},
                      {"points_unlocated", frame.unlocated}};
  if (frame.error) {
    object["mean_mm"] = frame.error->mean_mm;
    object["median_mm"] = frame.error->median_mm;
    object["p95_mm"] = frame.error->p95_mm;
    object["worst_mm"] = frame.error->worst_mm;
    object["rmse_mm"] = frame.error->rmse_mm;
    object["of_depth_percent"] = frame.error->of_depth_percent;
    object["worst_point"] = frame.error->worst_point;
  } else {
    object["no_error_because"] = frame.no_error_because;
  }
  return object;
}

ordered_json filter_json(const FilterMetrics& filter) {
  return {{"stage", filter.stage},
          {"frames", filter.frames},
          {"frames_without_mismatch", filter.frames_without_mismatch},
          {"frames_without_correct", filter.frames_without_correct},
          {"frames_without_kept", filter.frames_without_kept},
          {"matches", filter.entered},
          {"matches_labelled", filter.labelled},
          {"mismatches", filter.mismatches},
          {"tpr_percent", filter.tpr_percent},
          {"fpr_percent", filter.fpr_percent},
          {"kept_percent", filter.kept_percent},
          {"precision_percent", filter.precision_percent},
          {"recall_percent", filter.recall_percent},
          {"f1_percent", filter.f1_percent},
          {"scores_of_mismatches", filter.wrong_scores},
          {"scores_of_correct", filter.right_scores}};
}

ordered_json warp_json(const WarpMetrics& warp) {
  return {{"stage", warp.stage},           {"frames", warp.frames},
          {"salient_px", warp.salient_px}, {"salient_vertices", warp.salient},
          {"other_px", warp.other_px},     {"other_vertices", warp.other}};
}

ordered_json image_json(const ImageSummary& image) {
  return {{"match_tolerance_px", image.match_tolerance_px},
          {"truth_map_px", image.truth_map_px},
          {"reprojection_px", image.reprojection_px},
          {"reprojection_frames", image.reprojection_frames},
          {"reprojection_matches", image.reprojection_matches},
          {"overlay_px", image.overlay_px},
          {"overlay_frames", image.overlay_frames},
          {"overlay_vertices", image.overlay_vertices},
          {"behind_camera_frames", image.behind_camera_frames}};
}

ordered_json depth_json(const DepthSummary& depth) {
  return {{"depth_median_mm", depth.mean_mm},
          {"depth_median_of_frames_mm", depth.median_mm},
          {"depth_median_worst_mm", depth.worst_mm},
          {"frames", depth.frames},
          {"frames_without_median", depth.frames_without_median},
          {"matches", depth.matches},
          {"matches_without_depth", depth.without_depth}};
}

ordered_json visibility_json(const VisibilityMetrics& visibility) {
  return {{"frames", visibility.frames},
          {"vertices", visibility.vertices},
          {"hidden_vertices", visibility.hidden_vertices},
          {"precision_percent", visibility.precision_percent},
          {"recall_percent", visibility.recall_percent},
          {"f1_percent", visibility.f1_percent},
          {"hidden_f1_percent", visibility.hidden_f1_percent},
          {"visible_points", visibility.visible_points},
          {"hidden_points", visibility.hidden_points},
          {"visible_mm", visibility.visible_mm},
          {"hidden_mm", visibility.hidden_mm}};
}

ordered_json certainty_json(const CertaintyMetrics& certainty) {
  ordered_json bins = ordered_json::array();
  for (const ConfidenceBin& bin : certainty.bins) {
    bins.push_back({{"frames", bin.frames}, {"said", bin.said}, {"came_true", bin.came_true}});
  }
  return {{"frames", certainty.frames},
          {"right", certainty.right},
          {"silently_wrong", certainty.silently_wrong},
          {"brier", certainty.brier},
          {"bins", std::move(bins)},
          {"vertices", certainty.vertices},
          {"within_1_std_percent", certainty.within_percent[0]},
          {"within_2_std_percent", certainty.within_percent[1]},
          {"within_3_std_percent", certainty.within_percent[2]},
          {"in_interval_percent", certainty.in_interval_percent},
          {"measured_in_interval_percent", certainty.measured_in_interval_percent},
          {"filled_in_interval_percent", certainty.filled_in_interval_percent}};
}

ordered_json jitter_json(const Jitter& jitter) {
  return {{"mean_mm", jitter.mean_mm},
          {"median_mm", jitter.median_mm},
          {"triples", jitter.triples},
          {"truth_mean_mm", jitter.truth_mean_mm},
          {"truth_triples", jitter.truth_triples},
          {"cuts", jitter.cuts}};
}

ordered_json counts_json(const FilterCounts& counts) {
  return {{"entered", counts.entered},
          {"kept", counts.kept},
          {"mismatches", counts.mismatches},
          {"correct", counts.correct},
          {"rejected_wrong", counts.rejected_wrong},
          {"rejected_right", counts.rejected_right}};
}

ordered_json frame_json(const FrameMetrics& frame) {
  ordered_json object{{"frame", frame.frame},
                      {"stem", frame.stem},
                      {"state", to_string(frame.state)},
                      {"outcome", to_string(frame.outcome)},
                      {"failed", frame.failed},
                      {"isometry_error_percent", kPercent * frame.strain_mean},
                      {"isometry_error_p95_percent", kPercent * frame.strain_p95},
                      {"jitter_mm", frame.motion.jitter_mm}};
  if (!frame.has_truth) return object;
  object["truth"] = truth_json(frame);
  object["cut"] = frame.motion.cut;
  object["truth_jitter_mm"] = frame.motion.truth_jitter_mm;
  object["reprojection_px"] = frame.image.reprojection_px;
  object["reprojection_matches"] = frame.image.reprojection_matches;
  object["overlay_px"] = frame.image.overlay_px;
  object["overlay_vertices"] = frame.image.overlay_vertices;
  object["truth_map_px"] = frame.image.truth_map_px;
  if (frame.depth) {
    object["depth_median_mm"] = frame.depth->median_mm;
    object["depth_matches"] = frame.depth->matches;
    object["depth_matches_without"] = frame.depth->without_depth;
  }
  if (frame.visibility) {
    object["visibility"] = visibility_json(summarise_visibility(std::vector{*frame.visibility}));
  }
  if (frame.certainty) {
    object["confidence"] = frame.certainty->confidence;
    object["seen_mm"] = frame.certainty->seen_mm;
  }
  for (const auto& [stage, counts] : frame.filters) object["filters"][stage] = counts_json(counts);
  return object;
}

}  // namespace

std::string to_json(const RunMetrics& metrics) {
  ordered_json groups = ordered_json::array(), frames = ordered_json::array();
  for (const GroupMetrics& group : metrics.groups) groups.push_back(group_json(group));
  for (const FrameMetrics& frame : metrics.frames) frames.push_back(frame_json(frame));
  ordered_json filters = ordered_json::array();
  for (const FilterMetrics& filter : metrics.filters) filters.push_back(filter_json(filter));
  ordered_json warps = ordered_json::array();
  for (const WarpMetrics& warp : metrics.warps) warps.push_back(warp_json(warp));
  ordered_json all = group_json(metrics.all);
  all.erase("kind");
  all.erase("apart");
  const ordered_json object{{"schema", "weft-metrics/1"},
                            {"weft", kVersion},
                            {"run", metrics.run},
                            {"alignment", to_string(metrics.alignment)},
                            {"has_solver", metrics.has_solver},
                            {"interrupted", metrics.interrupted},
                            {"truth_users", metrics.truth_users},
                            {"counts", counts_json(metrics.counts)},
                            {"isometry_error_percent", kPercent * metrics.strain_mean},
                            {"isometry_error_p95_percent", kPercent * metrics.strain_p95},
                            {"groups", std::move(groups)},
                            {"all", std::move(all)},
                            {"image", image_json(metrics.image)},
                            {"depth", depth_json(metrics.depth)},
                            {"visibility", visibility_json(metrics.visibility)},
                            {"certainty", certainty_json(metrics.certainty)},
                            {"filters", std::move(filters)},
                            {"warps", std::move(warps)},
                            {"jitter", jitter_json(metrics.jitter)},
                            {"frames", std::move(frames)}};
  return object.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string metrics_file_name(Alignment alignment) {
  if (alignment == Alignment::none) return "metrics.json";
  return std::string("metrics_") + to_string(alignment) + ".json";
}

Result<void> write_json(const RunMetrics& metrics, const std::string& file) {
  return write_whole(to_json(metrics), file);
}

}  // namespace weft::evaluation
