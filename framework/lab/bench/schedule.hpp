// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace weft::bench {

/// How pipelines are measured, beside one another in one process.
struct Settings {
  std::int64_t frames = 20;  ///< [] of each repetition whose times count
  std::int64_t warmup = 3;   ///< [] frames before them, in every repetition, whose times do not
  int repetitions = 5;       ///< [] each begins a new sequence
  std::int64_t block = 5;    ///< [frames] a pipeline runs before it is the next one's turn

  std::int64_t all_frames() const { return warmup + frames; }
  /// Number of turns of each pipeline.
  std::int64_t turns() const { return repetitions * ((frames + block - 1) / block); }
};

/// Frames that one pipeline runs at a stretch.
struct Turn {
  std::int64_t number = 0;   ///< the turns that belong together, one a pipeline, have the same
  int repetition = 0;        ///< [] index from 0
  std::size_t pipeline = 0;  ///< [] index of the pipeline
  std::int64_t first = 0, end = 0;  ///< [] frames [first, end); those below `warmup` do not count
};

/// All turns in their order: block by block, A B, then B A, so that what drifts falls on both; with
/// more pipelines each begins as often as the others. The frames that warm up belong to the first
/// block of a repetition.
std::vector<Turn> schedule(const Settings& settings, std::size_t pipelines);

}  // namespace weft::bench
