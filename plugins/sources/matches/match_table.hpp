// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>

namespace weft::matches {

/// The columns that a file may have for a match.
enum class Column : std::size_t {
  frame,
  template_x_px,
  template_y_px,
  template_x_m,
  template_y_m,
  image_x_px,
  image_y_px,
  label,
  true_x_px,
  true_y_px,
  score,
  kept,
  distance,
  ratio,
  scale_ratio,
  angle_difference_rad
};
inline constexpr std::size_t kColumns = 16;
inline constexpr std::int64_t kMostFrames = 1'000'000;

const char* name_of(Column column);
std::optional<Column> column_named(std::string_view name);
/// "the column 'u' is unknown; did you mean ...?"
std::string unknown_column(const std::string& name);

/// The error in a value, as the text behind "'label' "; nothing for a valid one. Unknown true
/// images are NaN.
std::optional<std::string> mistake_in(Column column, double value);

/// The matches of a file, a value a row in each column that it has.
class MatchTable {
 public:
  std::vector<double>& operator[](Column column) { return values_[to_index(column)]; }
  const std::vector<double>& operator[](Column column) const { return values_[to_index(column)]; }
  void declare(Column column) { declared_[to_index(column)] = true; }
  bool has(Column column) const { return declared_[to_index(column)]; }
  std::size_t rows() const { return (*this)[Column::image_x_px].size(); }

  /// The error where a column is missing or two contradict each other.
  std::optional<std::string> mistake() const;

  /// The rows of each frame up to the last that is named; all are frame 0 where none is named.
  std::vector<std::vector<std::size_t>> rows_by_frame() const;

  /// Matches on no face yet, for the host to complete.
  Correspondences matches(const std::vector<std::size_t>& rows) const;

  bool has_truth() const { return has(Column::label) || has(Column::true_x_px); }
  /// Adds the ground truth in these rows.
  void add_truth(const std::vector<std::size_t>& rows, GroundTruth& truth) const;

 private:
  std::array<std::vector<double>, kColumns> values_;
  std::array<bool, kColumns> declared_{};
};

}  // namespace weft::matches
