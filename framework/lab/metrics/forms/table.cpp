// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>

#include "lab/metrics/field.hpp"
#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/forms/table_columns.hpp"
#include "lab/metrics/forms/table_parts.hpp"

namespace weft::lab {
namespace {

constexpr std::ptrdiff_t kWorstFrames = 5;

std::string group_name(const GroupMetrics& group) {
  const std::string kind = group.kind.empty() ? "(no kind)" : printable(group.kind);
  return group.exclusion.empty() ? kind : kind + " (" + printable(group.exclusion) + ")";
}

/// The numbers of a frame stand behind these.
TableRow frame_row(const FrameMetrics& frame) {
  std::string truth =
      frame.exclusion.empty() ? frame.kind : frame.kind + " (" + frame.exclusion + ")";
  if (frame.motion.cut) truth += " cut";
  return values_of(frame, {printable(frame.label()), std::to_string(frame.frame),
                           frame.outcome == FrameOutcome::invalid ? to_string(frame.outcome)
                                                                  : to_string(frame.state),
                           frame.has_truth ? printable(truth) : kNoValue});
}

/// Without the numbers that no frame has; the first row has the titles.
void leave_out_empty_columns(std::vector<TableRow>& rows, std::size_t first_number) {
  for (std::size_t column = rows.front().size(); rows.size() > 1 && column-- > first_number;) {
    const bool is_empty = std::all_of(rows.begin() + 1, rows.end(),
                                      [&](const TableRow& row) { return row[column] == kNoValue; });
    if (!is_empty) continue;
    for (TableRow& row : rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(column));
  }
}

std::string counts_text(const RunMetrics& metrics) {
  const FrameCounts& counts = metrics.counts;
  const double percent =
      kPercent * static_cast<double>(counts.solved()) / static_cast<double>(counts.frames);
  std::string text = fmt::format("{}: {} frames, {} solved ({} %)\n", printable(metrics.run),
                                 counts.frames, counts.solved(), decimal(percent, 1));
  const auto share = [&](std::int64_t part) {
    const double whole = static_cast<double>(counts.frames);
    return fmt::format("{} ({} %)", part, decimal(kPercent * static_cast<double>(part) / whole, 1));
  };
  text += fmt::format("  estimated {}, weak {}, predicted {}, lost {}, none {}, not finite {}; ",
                      share(counts.estimated), share(counts.weak), share(counts.predicted),
                      share(counts.lost), share(counts.none), share(counts.invalid));
  text += fmt::format("with an error {}\n", counts.failed);
  text += fmt::format("  isometry error of solved frames, |l/l0 - 1|: mean {} %, P95 {} %\n",
                      decimal(kPercent * metrics.strain_mean, 2),
                      decimal(kPercent * metrics.strain_p95, 2));
  if (const Jitter& jitter = metrics.jitter; jitter.triples > 0) {
    text += fmt::format("  jitter |X[t] - 2 X[t-1] + X[t-2]|: mean {} mm, median {} mm, {} triples",
                        decimal(jitter.mean_mm, 2), decimal(jitter.median_mm, 2), jitter.triples);
    if (jitter.truth_triples > 0) {
      text += fmt::format("; the truth's own mean {} mm, {} triples",
                          decimal(jitter.truth_mean_mm, 2), jitter.truth_triples);
    }
    if (jitter.cuts > 0) text += fmt::format("; cuts excluded: {}", jitter.cuts);
    text += '\n';
  }
  if (metrics.interrupted) {
    const std::string of_all =
        metrics.source_frames < 0 ? "" : fmt::format(" of {}", metrics.source_frames);
    text += fmt::format("  {}{} frames; the run did not finish\n", counts.frames, of_all);
  }
  if (metrics.dropped > 0) {
    text += fmt::format(
        "  {} frames of the source were dropped (realtime: latest): another run takes others\n",
        metrics.dropped);
  }
  for (const std::string& id : metrics.truth_users) {
    text += fmt::format("  {} may read the ground truth: these figures are no measurement\n",
                        printable(id));
  }
  return text;
}

/// Frames whose shape is an older one, and what could not be measured.
std::string rest_text(const RunMetrics& metrics) {
  std::string text;
  for (const GroupMetrics& group : metrics.groups) {
    const std::string name = group_name(group);
    const auto note = [&](std::int64_t count, const std::string& sentence) {
      if (count > 0) text += fmt::format("  {}: {} {}\n", name, count, sentence);
    };
    const ErrorSummary& old = group.carried_over_error;
    if (old.frames > 0) {
      note(old.frames, fmt::format("carried over (predicted or lost): mean {}, worst {} ({})",
                                   decimal(old.mean_mm, 2), decimal(old.worst_mm, 2),
                                   printable(old.worst_frame)));
    }
    note(group.missing, "with truth but without a shape: failures, not in the means");
    note(group.invalid, "with NaN or infinity in the shape: failures, not in the means");
    note(group.unmeasured, "with a shape that could not be compared with the truth");
    note(group.off,
         fmt::format("with a mean error above {:.0f} % of the template's diagonal: failures",
                     kPercent * kOffShare));
    note(group.unlocated,
         fmt::format("of {} points not on the mesh: not in the errors", group.points));
    note(group.extrapolated,
         fmt::format("of {} points beside the mesh: extrapolated", group.points));
  }
  return text.empty() ? text : "notes\n" + text;
}

std::string filters_text(const RunMetrics& metrics) {
  std::vector<TableRow> rows{titles_of<FilterMetrics>()};
  for (const FilterMetrics& filter : metrics.filters) {
    if (filter.labelled > 0) rows.push_back(values_of(filter));
  }
  if (rows.size() == 1) return "";
  std::string title = fmt::format("filters: positive is a mismatch, correct within {} px",
                                  decimal(metrics.image.match_tolerance_px, 1));
  if (std::isfinite(metrics.image.truth_map_px)) {
    title +=
        fmt::format("; the truth predicts itself to {} px", decimal(metrics.image.truth_map_px, 2));
  }
  return title + "\n" + align(rows);
}

std::string image_text(const ImageSummary& image) {
  std::string text;
  if (image.reprojection_frames > 0) {
    text += fmt::format("  reprojection of inliers: {} px, {} matches in {} frames\n",
                        decimal(image.reprojection_px, 2), image.reprojection_matches,
                        image.reprojection_frames);
  }
  if (image.overlay_frames > 0) {
    text += fmt::format("  vertices beside their true image: {} px, {} vertices in {} frames\n",
                        decimal(image.overlay_px, 2), image.overlay_vertices, image.overlay_frames);
  }
  if (image.behind_camera_frames > 0) {
    text += fmt::format("  {} frames with a point behind the camera have no such figure\n",
                        image.behind_camera_frames);
  }
  return text.empty() ? text : "in the image, not aligned\n" + text;
}

std::string warps_text(const RunMetrics& metrics) {
  std::vector<TableRow> rows{titles_of<WarpMetrics>()};
  for (const WarpMetrics& warp : metrics.warps) {
    if (warp.salient + warp.other > 0) rows.push_back(values_of(warp));
  }
  if (rows.size() == 1) return "";
  return "warps: vertices beside their true image; salient: with a kept match in a face\n" +
         align(rows);
}

std::string depth_text(const DepthSummary& depth) {
  if (depth.frames + depth.frames_without_median == 0) return "";
  return fmt::format(
      "against depth images, not aligned\n"
      "  median distance at kept matches: {} mm mean, {} mm median, {} mm worst of {} frames\n"
      "  {} matches; {} more have no depth; {} frames without a figure\n",
      decimal(depth.mean_mm, 2), decimal(depth.median_mm, 2), decimal(depth.worst_mm, 2),
      depth.frames, depth.matches, depth.without_depth, depth.frames_without_median);
}

}  // namespace

std::string to_table(const RunMetrics& metrics) {
  const std::string text = counts_text(metrics);
  if (!metrics.has_solver) {
    return text + "no solver in this run: no shapes, no 3D errors\n" + warps_text(metrics) +
           filters_text(metrics);
  }
  if (metrics.groups.empty()) {
    return text + "no ground truth in this run: give the source `truth` to measure errors\n" +
           registration_text(metrics.registration);
  }
  return text + to_error_table(metrics) + image_text(metrics.image) + depth_text(metrics.depth) +
         surfaces_text(metrics) + visibility_text(metrics.visibility) +
         registration_text(metrics.registration) + certainty_text(metrics.certainty) +
         warps_text(metrics) + filters_text(metrics);
}

std::string to_error_table(const RunMetrics& metrics) {
  std::vector<TableRow> rows{titles_of<TruthMetrics>({"truth"})}, excluded;
  for (const GroupMetrics& group : metrics.groups) {
    (group.exclusion.empty() ? rows : excluded)
        .push_back(values_of<TruthMetrics>(group, {group_name(group)}));
  }
  rows.push_back(values_of(metrics.all, {"all"}));
  const std::size_t counted = rows.size();
  rows.insert(rows.end(), excluded.begin(), excluded.end());
  std::string table = align(rows);
  if (!excluded.empty()) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < counted; ++i) at = table.find('\n', at) + 1;
    table.insert(at, "  excluded, not in the rows above\n");
  }
  return fmt::format("3D error of solved frames in mm, alignment: {}\n",
                     to_string(metrics.alignment)) +
         table + rest_text(metrics);
}

std::string to_frames_table(const RunMetrics& metrics) {
  const TableRow start{"frame", "index", "state", "truth"};
  std::vector<TableRow> rows{titles_of<FrameMetrics>(start)};
  std::vector<const FrameMetrics*> worst;
  for (const FrameMetrics& frame : metrics.frames) {
    rows.push_back(frame_row(frame));
    if (frame.error) worst.push_back(&frame);
  }
  leave_out_empty_columns(rows, start.size());
  const auto last = worst.begin() + std::min<std::ptrdiff_t>(std::ssize(worst), kWorstFrames);
  std::partial_sort(worst.begin(), last, worst.end(), [](const auto* a, const auto* b) {
    return std::pair(-a->error->mean_mm, a->frame) < std::pair(-b->error->mean_mm, b->frame);
  });
  std::string text =
      fmt::format("frames, 3D error in mm, alignment: {}\n", to_string(metrics.alignment)) +
      align(rows);
  for (auto each = worst.begin(); each != last; ++each) {
    text += each == worst.begin() ? "worst frames: " : ", ";
    text += printable((*each)->label()) + " " + decimal((*each)->error->mean_mm, 2);
  }
  return worst.empty() ? text : text + "\n";
}

}  // namespace weft::lab
