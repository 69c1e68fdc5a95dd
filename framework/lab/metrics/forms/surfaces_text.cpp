// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "lab/metrics/forms/table_columns.hpp"
#include "lab/metrics/forms/table_parts.hpp"

namespace weft::lab {
namespace {

std::string short_text(const SurfaceSummary& surface) {
  if (surface.frames_both_ways == 0) return "";
  return fmt::format(
      "mesh and truth as surfaces, not aligned\n"
      "  Chamfer distance: {} mm from the truth, {} mm to it; squared, both ways: {} mm^2 mean, {} "
      "mm^2 worst of {} frames\n",
      decimal(surface.from_truth_mm, 2), decimal(surface.to_truth_mm, 2),
      decimal(surface.chamfer_squared_mm2, 3), decimal(surface.worst_chamfer_squared_mm2, 3),
      surface.frames_both_ways);
}

/// Summary is SurfaceSummary or SampledSummary.
template <class Summary>
TableRow row_of(const std::string& name, const Summary& summary) {
  TableRow row{name, std::to_string(summary.frames)};
  for (const double mm : {summary.from_truth_mm, summary.to_truth_mm, summary.chamfer_mm}) {
    row.push_back(decimal(mm, 2));
  }
  for (const double mm2 : {summary.from_truth_squared_mm2, summary.to_truth_squared_mm2,
                           summary.chamfer_squared_mm2}) {
    row.push_back(decimal(mm2, 3));
  }
  return row;
}

void add_rows(const std::string& name, const SurfaceSummary& surface, std::vector<TableRow>& rows) {
  if (surface.frames > 0) rows.push_back(row_of(name, surface));
  if (surface.sampled.frames > 0) rows.push_back(row_of(name + ", sampled", surface.sampled));
}

std::string parts_text(const std::vector<PartMetrics>& parts) {
  if (parts.empty()) return "";
  std::vector<TableRow> rows{titles_of<PartMetrics>({"part"})};
  for (const PartMetrics& part : parts) rows.push_back(values_of(part, {printable(part.part)}));
  return "parts of the truth, solved frames, each part by itself\n" + align(rows);
}

}  // namespace

std::string surfaces_text(const RunMetrics& metrics) {
  std::vector<TableRow> rows{{"", "frames", "from truth mm", "to truth mm", "Chamfer mm",
                              "from truth mm^2", "to truth mm^2", "Chamfer mm^2"}};
  const bool is_short = metrics.surface.sampled.frames == 0 && metrics.parts.empty();
  if (is_short) return short_text(metrics.surface);
  add_rows("all", metrics.surface, rows);
  for (const PartMetrics& part : metrics.parts) {
    add_rows(printable(part.part), part.surface, rows);
  }
  return parts_text(metrics.parts) + "mesh and truth as surfaces, not aligned\n" + align(rows);
}

}  // namespace weft::lab
