// SPDX-License-Identifier: Apache-2.0
#include "lab/report/figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace weft::lab {
namespace {

constexpr std::size_t kMostDrawn = 16;     ///< panels of a figure
constexpr std::size_t kMostInView = 8;     ///< combinations whose shapes the page holds
constexpr std::size_t kMostPictures = 8;   ///< worst frames in all
constexpr std::size_t kPicturesOfOne = 2;  ///< worst frames of one combination

std::string cell_folder(const Results& results, const PlanCell& cell) {
  return results.folder + "/cells/" + cell.key;
}

std::string place_of(const PlanCell& cell) {
  return cell.sequence + ", seed " + std::to_string(cell.seed);
}

/// The cells of a combination with an error, by mean error.
std::vector<std::size_t> ranked_cells(const Results& results, const Combination& combination) {
  std::vector<std::size_t> cells;
  for (const std::size_t cell : combination.cells) {
    if (std::isfinite(results.record(results.plan.cells[cell]).mean_mm)) cells.push_back(cell);
  }
  std::stable_sort(cells.begin(), cells.end(), [&](std::size_t a, std::size_t b) {
    return results.record(results.plan.cells[a]).mean_mm <
           results.record(results.plan.cells[b]).mean_mm;
  });
  return cells;
}

/// The best, median and worst cell of a combination, each key once.
Result<void> add_cells(const Results& results, const Combination& combination,
                       std::vector<ShownCell>& shown) {
  const std::vector<std::size_t> ranked = ranked_cells(results, combination);
  if (ranked.empty()) return {};
  const std::pair<const char*, std::size_t> choices[] = {
      {"median", ranked[ranked.size() / 2]}, {"worst", ranked.back()}, {"best", ranked.front()}};
  std::set<std::string> keys;
  for (const auto& [rank, index] : choices) {
    const PlanCell& cell = results.plan.cells[index];
    if (!keys.insert(cell.key).second) continue;
    auto view = read_cell_view(cell_folder(results, cell), {});
    if (!view) return view.error();
    if (view->frames.empty()) continue;
    const std::string name = combination.name + ": " + rank + " cell (" + place_of(cell) + ")";
    shown.push_back({index, name, *std::move(view)});
  }
  return {};
}

double error_of(const CellRecord& record, std::uint64_t frame) {
  for (const FrameError& error : record.errors) {
    if (error.frame == frame) return error.mean_mm;
  }
  return kUnknown;
}

/// A frame without an error is worse than any other.
bool worse(const ShownFrame& a, const ShownFrame& b) {
  if (std::isnan(a.mean_mm) || std::isnan(b.mean_mm)) {
    return std::isnan(a.mean_mm) && !std::isnan(b.mean_mm);
  }
  return a.mean_mm > b.mean_mm;
}

/// The worst frames of a combination that have an image.
std::vector<ShownFrame> worst_of(const Results& results, const Combination& combination,
                                 std::set<std::string>& keys) {
  std::vector<ShownFrame> frames;
  for (const std::size_t c : combination.cells) {
    const PlanCell& cell = results.plan.cells[c];
    if (!keys.insert(cell.key).second) continue;
    for (Thumbnail& picture : read_thumbnails(cell_folder(results, cell))) {
      const double mean_mm = error_of(results.record(cell), picture.frame);
      frames.push_back({c, mean_mm, std::move(picture)});
    }
    std::stable_sort(frames.begin(), frames.end(), worse);
    if (frames.size() > kPicturesOfOne) frames.resize(kPicturesOfOne);
  }
  return frames;
}

/// The worst frame of each combination, then the second of each while there is room.
std::vector<ShownFrame> worst_frames(const Results& results, const ReportTables& tables) {
  std::vector<std::vector<ShownFrame>> by_rank(kPicturesOfOne);
  std::set<std::string> keys;
  for (const Combination& combination : tables.combinations) {
    std::vector<ShownFrame> frames = worst_of(results, combination, keys);
    for (std::size_t rank = 0; rank < frames.size(); ++rank) {
      std::vector<ShownFrame>& rivals = by_rank[rank];
      rivals.push_back(std::move(frames[rank]));
      std::stable_sort(rivals.begin(), rivals.end(), worse);
      if (rivals.size() > kMostPictures) rivals.resize(kMostPictures);
    }
  }
  std::vector<ShownFrame> shown;
  for (std::vector<ShownFrame>& rivals : by_rank) {
    for (ShownFrame& frame : rivals) {
      if (shown.size() < kMostPictures) shown.push_back(std::move(frame));
    }
  }
  std::stable_sort(shown.begin(), shown.end(), worse);
  return shown;
}

/// The shape and the truth of a frame.
Result<void> add_view(const Results& results, ShownFrame& shown) {
  const ViewLimits limits{std::numeric_limits<int>::max(), ViewLimits{}.truth_points};
  auto view = read_cell_view(cell_folder(results, results.plan.cells[shown.cell]), limits);
  if (!view) return view.error();
  std::erase_if(view->frames,
                [&](const ViewFrame& frame) { return frame.frame != shown.picture.frame; });
  shown.view = *std::move(view);
  return {};
}

}  // namespace

Result<Figures> make_figures(const Results& results, const ReportTables& tables) {
  Figures figures;
  figures.drawn = best_combinations(tables.combinations, kMostDrawn);
  if (!figures.drawn.empty()) figures.reference = best_combinations(tables.combinations, 1).front();
  figures.over_frames = errors_over_frames(results, tables, figures.reference, figures.drawn);
  figures.sweeps = sweeps_of(results, tables);
  for (const std::size_t index : best_combinations(tables.combinations, kMostInView)) {
    if (auto added = add_cells(results, tables.combinations[index], figures.cells); !added) {
      return added.error();
    }
  }
  figures.worst_frames = worst_frames(results, tables);
  for (ShownFrame& frame : figures.worst_frames) {
    if (auto added = add_view(results, frame); !added) return added.error();
  }
  return figures;
}

}  // namespace weft::lab
