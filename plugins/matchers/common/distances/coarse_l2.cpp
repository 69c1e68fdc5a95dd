// SPDX-License-Identifier: Apache-2.0
#include "common/distances/coarse_l2.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <weft/core/index.hpp>

#include "common/workers/sharing.hpp"

namespace weft::matchers {
namespace {

/// Added to the errors of two rows, for what is rounded when they are computed [bytes].
constexpr double kMargin = 0.01;
/// Rows that a thread takes together.
constexpr int kRowsAtATime = 128;

int rounded_up(int count, int multiple) { return (count + multiple - 1) / multiple * multiple; }

}  // namespace

void CoarseL2::Side::load(const Array<float>& descriptors, bool with_root,
                          std::uint64_t new_revision, Workers& workers, int threads) {
  const bool is_kept = new_revision != 0 && new_revision == revision && with_root == root &&
                       count() == descriptors.dim(0);
  const int length = static_cast<int>(descriptors.dim(1));
  if (is_kept) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i].numbers = descriptors.row(static_cast<std::int64_t>(i));
    }
    return;
  }
  revision = 0;  // until all is there
  rows.resize(to_index(descriptors.dim(0)));
  rounding = {};
  range = {0.0F, with_root ? 1.0 : 0.0};
  share_out(workers, {count(), kRowsAtATime, threads}, [&](int, int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const float* numbers = descriptors.row(i);
      rows[to_index(i)] = with_root ? root_of(numbers, length) : ComparedRow{numbers, length};
    }
    return true;
  });
  if (!with_root) {
    for (const ComparedRow& row : rows) {
      const RowSurvey survey = survey_row(row.numbers, length);
      range.lowest = std::min(range.lowest, survey.lowest);
      range.largest_norm = std::max(range.largest_norm, survey.norm);
    }
  }
  revision = new_revision;
  root = with_root;
}

CoarseL2::Range CoarseL2::range_of_both() const {
  const Range &a = query_side_.range, &b = train_side_.range;
  Range range{std::min(a.lowest, b.lowest), std::max(a.largest_norm, b.largest_norm)};
  if (range.lowest == 0.0F) return range;
  for (const Side* side : {&query_side_, &train_side_}) {
    for (const ComparedRow& row : side->rows) {
      range.largest_norm =
          std::max(range.largest_norm, norm_above(range.lowest, row.numbers, row.length));
    }
  }
  return range;
}

void CoarseL2::Side::quantise(const Rounding& wanted, Workers& workers, int threads) {
  if (rounding == wanted) return;
  const auto padded = to_index(rounded_up(count(), kCodeBlock));
  const int row_bytes = wanted.row_bytes;
  bytes.resize(padded * to_index(row_bytes));
  fine.resize(to_index(count()) * to_index(row_bytes));
  // Numbers beyond the end of a row, and rows beyond the last, are zero.
  const bool is_padded = !rows.empty() && rows.front().length != row_bytes;
  const std::size_t written = is_padded ? 0 : to_index(count()) * to_index(row_bytes);
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(written), bytes.end(), std::uint8_t{0});
  if (is_padded) std::fill(fine.begin(), fine.end(), std::int16_t{0});
  // Halves for rows beyond the last, so large that their codes become kBeyond.
  halves.assign(padded, 1 << 20);
  errors.resize(rows.size());
  fine_errors.resize(rows.size());
  share_out(workers, {count(), kRowsAtATime, threads}, [&](int, int begin, int end) {
    for (std::size_t i = to_index(begin); i < to_index(end); ++i) {
      const std::size_t first = i * to_index(row_bytes);
      const Rounded rounded = round_row(rows[i], wanted.lowest, wanted.scale, bytes.data() + first,
                                        fine.data() + first);
      halves[i] = (rounded.squared_norm + 1) / 2;
      errors[i] = rounded.error;
      fine_errors[i] = rounded.fine_error;
    }
    return true;
  });
  largest_error = largest_fine_error = 0.0F;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    largest_error = std::max(largest_error, errors[i]);
    largest_fine_error = std::max(largest_fine_error, fine_errors[i]);
  }
  is_packed = false;
  rounding = wanted;
}

void CoarseL2::Side::pack() {
  if (std::exchange(is_packed, true)) return;
  panels.resize(bytes.size());
  const std::ptrdiff_t length = rounding.row_bytes, panel_bytes = kPanelTrains * length;
  for (std::size_t first = 0; first < bytes.size(); first += to_index(panel_bytes)) {
    const std::uint8_t* from = bytes.data() + first;
    std::uint8_t* to = panels.data() + first;
    for (std::ptrdiff_t k = 0; k < length; k += kGroupBytes) {
      for (std::ptrdiff_t train = 0; train < kPanelTrains; ++train) {
        std::memcpy(to + k * kPanelTrains + train * kGroupBytes, from + train * length + k,
                    kGroupBytes);
      }
    }
  }
}

void CoarseL2::load(const Array<float>& queries, const Array<float>& trains, bool root,
                    std::uint64_t query_revision, std::uint64_t train_revision, int threads) {
  query_side_.load(queries, root, query_revision, workers_, threads);
  train_side_.load(trains, root, train_revision, workers_, threads);
  queries_ = query_side_.count();
  trains_ = train_side_.count();
  length_ = static_cast<int>(queries.dim(1));
  row_bytes_ = rounded_up(length_, kRowBytes);
  const Range range = range_of_both();
  // Rounding may lengthen a row by half a byte in each of its numbers.
  const double room = std::max(1.0, 255.0 - 0.5 * std::sqrt(static_cast<double>(length_)) - 1.0);
  constexpr double kSmallestScale = 1e-37, kLargestScale = 1e37;
  double fitting = range.largest_norm > 0.0 ? room / range.largest_norm : 1.0;
  // In steps of a sixteenth of an octave, so that a side that is kept seldom needs another one.
  constexpr double kSteps = 16.0;
  fitting = std::exp2(std::floor(kSteps * std::log2(fitting)) / kSteps);
  const auto scale = static_cast<float>(std::clamp(fitting, kSmallestScale, kLargestScale));
  scale_ = static_cast<double>(scale);
  query_side_.quantise({range.lowest, scale, row_bytes_}, workers_, threads);
  train_side_.quantise({range.lowest, scale, row_bytes_}, workers_, threads);
}

void CoarseL2::pack_trains() { train_side_.pack(); }

void CoarseL2::swap_sides() {
  std::swap(query_side_, train_side_);
  std::swap(queries_, trains_);
}

void CoarseL2::fill(std::span<const int> queries, Scratch& scratch, std::int16_t* codes) const {
  const std::ptrdiff_t groups = row_bytes_ / kGroupBytes;
  scratch.groups.resize(to_index(groups * kBlockQueries));
  scratch.halves.resize(kBlockQueries);
  for (std::size_t i = 0; i < to_index(kBlockQueries); ++i) {
    const int query = queries[std::min(i, queries.size() - 1)];
    const std::uint8_t* row =
        query_side_.bytes.data() + static_cast<std::ptrdiff_t>(query) * row_bytes_;
    for (std::ptrdiff_t k = 0; k < groups; ++k) {
      std::memcpy(&scratch.groups[to_index(k * kBlockQueries) + i], row + k * kGroupBytes,
                  kGroupBytes);
    }
    scratch.halves[i] = query_side_.halves[to_index(query)];
  }
  kernels_->fill(scratch.groups.data(), scratch.halves.data(), train_side_.panels.data(),
                 train_side_.halves.data(), row_length(), row_bytes_, codes);
}

void CoarseL2::fill_some(int query, std::span<const int> trains, std::int16_t* codes) const {
  kernels_->fill_some(query_side_.bytes.data() + static_cast<std::ptrdiff_t>(query) * row_bytes_,
                      query_side_.halves[to_index(query)], train_side_.bytes.data(),
                      train_side_.halves.data(), trains.data(), static_cast<int>(trains.size()),
                      row_bytes_, codes);
}

double CoarseL2::slack(int query) const {
  return static_cast<double>(query_side_.errors[to_index(query)]) +
         static_cast<double>(train_side_.largest_error) + kMargin;
}

double CoarseL2::lower(int query, int code) const {
  return std::max(0.0, std::sqrt(std::max(0.0, 4.0 * code - 2.0)) - slack(query)) / scale_;
}

double CoarseL2::upper(int query, int code) const {
  return (std::sqrt(4.0 * code + 2.0) + slack(query)) / scale_;
}

int CoarseL2::last_code(int query, double distance) const {
  const double bytes = distance * scale_ + slack(query);
  return static_cast<int>(std::min(0.25 * (bytes * bytes + 2.0), kBeyond - 1.0));
}

double CoarseL2::fine_distance(int query, int train) const {
  const auto row = [&](const Side& side, int i) {
    return side.fine.data() + static_cast<std::ptrdiff_t>(i) * row_bytes_;
  };
  const std::int32_t squared =
      fine_squared_distance(row(query_side_, query), row(train_side_, train), row_bytes_);
  return std::sqrt(static_cast<double>(squared)) / (kFineUnit * scale_);
}

double CoarseL2::fine_slack(int query) const {
  return (static_cast<double>(query_side_.fine_errors[to_index(query)]) +
          static_cast<double>(train_side_.largest_fine_error) + kMargin) /
         scale_;
}

double CoarseL2::distance(int query, int train) const {
  return l2_distance(query_side_.rows[to_index(query)], train_side_.rows[to_index(train)]);
}

}  // namespace weft::matchers
