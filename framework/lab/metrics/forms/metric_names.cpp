// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "lab/metrics/forms/catalogue.hpp"

namespace weft::lab {
namespace {

struct HumanName {
  const char* ending;  ///< path, as in the catalogue
  const char* name;
};

/// Names that the words of a path do not give. `error_carried_over` has the same members as
/// `error_solved`.
constexpr HumanName kHumanNames[] = {
    {"error_solved.mean_mm", "mean 3D error"},
    {"error_solved.standard_error_mm", "standard error of the mean 3D error"},
    {"error_solved.median_mm", "median 3D error"},
    {"error_solved.p95_mm", "95th percentile of the 3D error"},
    {"error_solved.worst_mm", "3D error of the worst frame"},
    {"error_solved.worst_point_mm", "3D error of the worst point"},
    {"error_solved.of_depth_percent", "3D error over depth"},
    {"error_solved.frames", "frames with a 3D error"},
    {"solved", "frames solved"},
    {"failures", "frames failed"},
    {"failure_percent", "share of frames failed"},
    {"solved_percent", "share of frames solved"},
    {"counts.failed", "frames with an error of a stage"},
    {"isometry_error_p95_percent", "95th percentile of the isometry error"},
    {"image.reprojection_px", "reprojection error"},
    {"image.overlay_px", "error of vertices in the image"},
    {"image.truth_map_px", "error of the truth predicted by itself"},
    {"depth.depth_median_mm", "median distance to the depth image"},
    {"depth.depth_median_worst_mm", "distance to the depth image in the worst frame"},
    {"surface.surface_from_truth_mm", "distance of the truth to the mesh"},
    {"surface.surface_to_truth_mm", "distance of the mesh to the truth"},
    {"surface.chamfer_mm", "Chamfer distance"},
    {"surface.chamfer_squared_mm2", "squared Chamfer distance"},
    {"surface.chamfer_squared_worst_mm2", "squared Chamfer distance of the worst frame"},
    {"visibility.precision_percent", "precision of seen vertices"},
    {"visibility.recall_percent", "recall of seen vertices"},
    {"visibility.f1_percent", "F1 of seen vertices"},
    {"visibility.hidden_f1_percent", "F1 of hidden vertices"},
    {"visibility.visible_mm", "mean 3D error of seen points"},
    {"visibility.hidden_mm", "mean 3D error of hidden points"},
    {"registration.within_1mm_percent", "patches within 1 mm"},
    {"registration.within_2mm_percent", "patches within 2 mm"},
    {"registration.found_percent", "patches found"},
    {"registration.median_mm", "median displacement of patches"},
    {"registration.p90_mm", "90th percentile of the displacement of patches"},
    {"certainty.right", "frames that are right"},
    {"certainty.silently_wrong", "silently wrong frames"},
    {"certainty.brier", "Brier score of the confidence"},
    {"certainty.within_1_std_percent", "vertices within one standard deviation"},
    {"certainty.within_2_std_percent", "vertices within two standard deviations"},
    {"certainty.within_3_std_percent", "vertices within three standard deviations"},
    {"certainty.in_interval_percent", "vertices in their 95 % interval"},
    {"filters.STAGE.tpr_percent", "mismatches rejected (TPR)"},
    {"filters.STAGE.fpr_percent", "inliers rejected (FPR)"},
    {"filters.STAGE.kept_percent", "matches kept"},
    {"filters.STAGE.precision_percent", "precision of kept matches"},
    {"filters.STAGE.recall_percent", "inliers kept (recall)"},
    {"filters.STAGE.f1_percent", "F1 of kept matches"},
    {"warps.STAGE.salient_px", "warp error near matches"},
    {"warps.STAGE.other_px", "warp error away from matches"},
    {"jitter.mean_mm", "jitter"},
    {"jitter.median_mm", "median jitter"},
    {"jitter.truth_mean_mm", "the truth's own jitter"},
};

constexpr std::string_view kCarriedOver = "error_carried_over.";

/// True if a path is the ending or ends with a dot and the ending.
bool ends_in(const std::string& path, std::string_view ending) {
  return path.ends_with(ending) &&
         (path.size() == ending.size() || path[path.size() - ending.size() - 1] == '.');
}

/// "reprojection frames" of "image.reprojection_frames", "isometry error" of
/// "all.isometry_error_percent".
std::string last_words_of(const std::string& path) {
  std::string words = path.substr(path.rfind('.') + 1);
  if (!unit_of(path).empty()) words.resize(words.rfind('_'));
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string name_of_entry(std::string path) {
  std::string suffix;
  if (const std::size_t at = path.find(kCarriedOver); at != std::string::npos) {
    path.replace(at, kCarriedOver.size(), "error_solved.");
    suffix = " of carried-over frames";
  }
  for (const HumanName& each : kHumanNames) {
    if (ends_in(path, each.ending)) return each.name + suffix;
  }
  return last_words_of(path) + suffix;
}

}  // namespace

std::string metric_name(const std::string& path) {
  const auto [entry, label] = entry_of(path);
  if (entry == nullptr) return path;
  const std::string name = name_of_entry(entry->path);
  return label.empty() ? name : name + ", " + label;
}

std::string metric_heading(const std::string& path) {
  const std::string unit = unit_of(path);
  return unit.empty() ? metric_name(path) : metric_name(path) + ", " + unit;
}

std::vector<std::string> named_endings() {
  std::vector<std::string> endings;
  for (const HumanName& each : kHumanNames) endings.emplace_back(each.ending);
  return endings;
}

}  // namespace weft::lab
