// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lab/bench/measure.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft::bench {

using lab::Interval;
using lab::kUnknown;

/// Order statistics, interpolated linearly at rank p/100 (n - 1); unknown for n = 0.
struct Spread {
  std::int64_t n = 0;                                        ///< [] sample size
  double median = kUnknown, p95 = kUnknown, p99 = kUnknown;  ///< unit of the sample
};
Spread spread_of(std::span<const double> values);

/// Cost of a part in a frame.
struct PartSample {
  std::int64_t turn = 0;   ///< see Turn::number
  int repetition = 0;      ///< [] index from 0
  std::int64_t frame = 0;  ///< [] index of the frame
  host::Spent took;
};

/// A part of a frame in all frames that count and in which it was not skipped.
struct Part {
  std::string name;                    ///< name of a stage or sink, or kHost or kFrame
  std::vector<PartSample> samples;     ///< [.] one per frame
  std::vector<std::int64_t> statuses;  ///< [5] frames, by StageStatus
};

/// Cost of a frame that is in none of its stages: the host's own work.
inline constexpr const char* kHost = "host";
/// Stages, sinks and host together; without the source.
inline constexpr const char* kFrame = "frame";

/// The parts in their order, then host and frame.
std::vector<Part> parts_of(const std::vector<std::string>& names,
                           const std::vector<Sample>& samples);

/// Which of the two times.
enum class Time { wall, processor };

/// Ratio of the times of two subjects: the geometric mean over the turns of the geometric mean of
/// each turn. Only frames count that both have run in the same repetition.
struct Ratio {
  double ratio = kUnknown;  ///< [] geometric mean
  Interval interval;        ///< 95 %, bootstrap over the turns; unknown for fewer than 6
  std::int64_t pairs = 0;   ///< [] frames
  std::int64_t turns = 0;   ///< [] number of turns
};
Ratio ratio_of(const Part& part, const Part& over, Time time);

}  // namespace weft::bench
