// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/statistics/unknown.hpp"

/// Results of several treatments side by side. Frames of a sequence resemble each other, hence a
/// sequence counts once: the mean over its seeds of the mean over the frames of a seed.
namespace weft::lab {

/// Replaces the frames of a cell that left none: a failure on every frame that some other treatment
/// has of that sequence and seed.
inline constexpr std::uint64_t kEveryFrame = std::numeric_limits<std::uint64_t>::max();

/// One result of one treatment.
struct Observation {
  std::string sequence;
  std::uint64_t frame = 0;  ///< [] index from 0, or kEveryFrame
  std::uint64_t seed = 0;   ///< [] run seed
  std::string treatment;
  double value = kUnknown;  ///< not finite: a failure
};

/// Where results of different treatments meet.
struct PanelPlace {
  std::string sequence;
  std::uint64_t seed = 0, frame = 0;  ///< [] run seed; index of the frame

  bool operator==(const PanelPlace&) const = default;
  bool operator<(const PanelPlace& other) const {
    return std::tie(sequence, seed, frame) < std::tie(other.sequence, other.seed, other.frame);
  }
};

/// "sequence plain_101, seed 1, frame 17".
std::string to_string(const PanelPlace& place);

struct PanelRow {
  PanelPlace place;
  /// [treatments]; absent: no such result, NaN: a failure.
  std::vector<std::optional<double>> results;

  bool present(std::size_t treatment) const { return results[treatment].has_value(); }
  bool failed(std::size_t treatment) const;
  bool has_value(std::size_t treatment) const;
};

struct Panel {
  std::vector<std::string> treatments;  ///< in the order of their first result
  std::vector<PanelRow> rows;           ///< in the order of their places

  /// In ascending order.
  std::vector<std::string> sequences() const;
};

/// Fails with invalid_data, naming the place, if a treatment has two results at one place, or if a
/// value claims to hold for every frame. Also fails if there are no results.
Result<Panel> make_panel(const std::vector<Observation>& observations);

struct SequenceMean {
  std::string sequence;
  double mean = kUnknown;  ///< unit of the values
  std::int64_t rows = 0;   ///< [] that entered
};

/// One entry for each sequence with at least one row for which `value` is not empty, in ascending
/// order. The entry is the mean over seeds of the mean over the frames of a seed.
std::vector<SequenceMean> sequence_means(
    const Panel& panel, const std::function<std::optional<double>(const PanelRow&)>& value);

/// The numbers alone.
std::vector<double> means_of(const std::vector<SequenceMean>& sequences);

}  // namespace weft::lab
