// SPDX-License-Identifier: Apache-2.0
#include "match_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/core/suggest.hpp>

namespace weft::matches {
namespace {

constexpr std::array<const char*, kColumns> kNames{
    "frame",        "template_x_px", "template_y_px", "template_x_m",
    "template_y_m", "image_x_px",    "image_y_px",    "label",
    "true_x_px",    "true_y_px",     "score",         "kept",
    "distance",     "ratio",         "scale_ratio",   "angle_difference_rad"};

using Rows = std::vector<std::size_t>;

template <class T>
Array<T> gathered(const MatchTable& table, Column column, const Rows& rows) {
  Array<T> values({static_cast<std::int64_t>(rows.size())});
  for (std::size_t n = 0; n < rows.size(); ++n) {
    values(static_cast<std::int64_t>(n)) = static_cast<T>(table[column][rows[n]]);
  }
  return values;
}

/// [N,2] of two columns.
Array<double> gathered(const MatchTable& table, Column x, Column y, const Rows& rows) {
  Array<double> values({static_cast<std::int64_t>(rows.size()), 2});
  for (std::size_t n = 0; n < rows.size(); ++n) {
    values(static_cast<std::int64_t>(n), 0) = table[x][rows[n]];
    values(static_cast<std::int64_t>(n), 1) = table[y][rows[n]];
  }
  return values;
}

template <class T>
Array<T> all(std::size_t count, T value) {
  return Array<T>({static_cast<std::int64_t>(count)}, value);
}

bool is_one_of(double value, double least, double most) {
  return value >= least && value <= most && value == std::floor(value);
}

}  // namespace

const char* name_of(Column column) { return kNames[to_index(column)]; }

std::optional<Column> column_named(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Column>(found - kNames.begin());
}

std::string unknown_column(const std::string& name) {
  return "the column " + quote(name) + " is unknown" +
         did_you_mean(name, {kNames.begin(), kNames.end()}, ": remove or rename it");
}

std::optional<std::string> mistake_in(Column column, double value) {
  const bool may_lack = column == Column::true_x_px || column == Column::true_y_px;
  if (may_lack && std::isnan(value)) return std::nullopt;
  if (!std::isfinite(value)) return "must be a finite number";
  if (column == Column::frame && !is_one_of(value, 0.0, kMostFrames - 1)) {
    return "must be a whole number from 0 to " + std::to_string(kMostFrames - 1);
  }
  if (column == Column::label && !is_one_of(value, -1.0, 1.0)) {
    return "must be 1 (correct), 0 (mismatch) or -1 (unknown)";
  }
  if (column == Column::kept && !is_one_of(value, 0.0, 1.0)) return "must be 0 or 1";
  return std::nullopt;
}

std::optional<std::string> MatchTable::mistake() const {
  using enum Column;
  constexpr std::array<std::pair<Column, Column>, 4> kPairs{{{template_x_px, template_y_px},
                                                             {template_x_m, template_y_m},
                                                             {image_x_px, image_y_px},
                                                             {true_x_px, true_y_px}}};
  for (const auto& [x, y] : kPairs) {
    if (has(x) == has(y)) continue;
    return std::string("'") + name_of(has(x) ? y : x) + "' is missing beside '" +
           name_of(has(x) ? x : y) + "': add it";
  }
  if (!has(image_x_px)) return "the places in the image are missing: add image_x_px and image_y_px";
  if (has(template_x_px) && has(template_x_m)) {
    return "places on the template are given in px and in m: remove one of the two";
  }
  if (has(template_x_px) || has(template_x_m)) return std::nullopt;
  return "the places on the template are missing: add template_x_px and template_y_px, or "
         "template_x_m and template_y_m";
}

std::vector<std::vector<std::size_t>> MatchTable::rows_by_frame() const {
  const auto& frames = (*this)[Column::frame];
  std::vector<std::vector<std::size_t>> found(has(Column::frame) ? 0 : 1);
  for (std::size_t row = 0; row < rows(); ++row) {
    worked_in_loop(static_cast<std::int64_t>(row));
    const auto frame = frames.empty() ? 0 : to_index(frames[row]);
    if (frame >= found.size()) found.resize(frame + 1);
    found[frame].push_back(row);
  }
  return found;
}

Correspondences MatchTable::matches(const std::vector<std::size_t>& rows) const {
  using enum Column;
  const auto count = static_cast<std::int64_t>(rows.size());
  Correspondences matches;
  matches.template_px = Array<double>({count, 2}, 0.0);
  if (has(template_x_px)) matches.template_px = gathered(*this, template_x_px, template_y_px, rows);
  if (has(template_x_m)) matches.template_xy_m = gathered(*this, template_x_m, template_y_m, rows);
  matches.image_px = gathered(*this, image_x_px, image_y_px, rows);
  matches.face = all<std::int32_t>(rows.size(), -1);
  matches.barycentrics = Array<double>({count, 3}, 0.0);
  matches.kept =
      has(kept) ? gathered<std::uint8_t>(*this, kept, rows) : all<std::uint8_t>(rows.size(), 1);
  matches.score = has(score) ? gathered<double>(*this, score, rows) : all(rows.size(), 1.0);
  if (has(distance)) matches.distance = gathered<double>(*this, distance, rows);
  if (has(ratio)) matches.ratio = gathered<double>(*this, ratio, rows);
  if (has(scale_ratio)) matches.scale_ratio = gathered<double>(*this, scale_ratio, rows);
  if (has(angle_difference_rad)) {
    matches.angle_difference_rad = gathered<double>(*this, angle_difference_rad, rows);
  }
  return matches;
}

void MatchTable::add_truth(const std::vector<std::size_t>& rows, GroundTruth& truth) const {
  using enum Column;
  truth.match_label = has(label) ? gathered<std::int8_t>(*this, label, rows) : Array<std::int8_t>();
  truth.match_xy_px =
      has(true_x_px) ? gathered(*this, true_x_px, true_y_px, rows) : Array<double>();
}

}  // namespace weft::matches
