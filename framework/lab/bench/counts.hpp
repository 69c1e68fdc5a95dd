// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "lab/bench/schedule.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::bench {

/// Allocations of one part, in each frame that counts and in which it was not skipped.
struct PartCount {
  std::string name;                   ///< the source's too, host and frame as in figures.hpp
  std::vector<double> blocks, bytes;  ///< [frames] allocations; [frames] bytes
};

/// Resources of a process that did nothing else but run a pipeline.
struct Counts {
  bool allocations = false;      ///< true if they were counted; `parts` is empty otherwise
  std::vector<PartCount> parts;  ///< [.] one per part of a frame
  double loaded_kib = 0.0;       ///< with the libraries loaded, before anything was made
  double peak_kib = 0.0;         ///< at most, from then on until the last frame
};

/// Runs `settings.all_frames()` frames, one after the other as `weft run` does, and counts. To be
/// called once in a process: peaks do not come down by themselves. Memory of workers is not in it.
Result<Counts> count_here(const CheckedPipeline& pipeline, const Settings& settings,
                          const std::atomic<bool>& cancel);

/// As text that another process reads.
std::string text_of(const Counts& counts);
Result<Counts> counts_in(const std::string& text);

/// Starts the command, whose first word is the path of a program, and reads the counts that it
/// prints. The process loads this library first, or none if the file does not exist. `cancel` ends
/// it.
Result<Counts> count_in_child(const std::vector<std::string>& command, const std::string& library,
                              const std::atomic<bool>& cancel);

}  // namespace weft::bench
