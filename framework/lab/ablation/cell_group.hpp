// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/records/npz.hpp"
#include "lab/ablation/plan/grid.hpp"
#include "lab/metrics/metrics.hpp"

namespace weft::lab {

/// How long the calls of a stage took, of frames in which it was not skipped.
struct StageTiming {
  std::string stage;
  std::vector<double> ms, processor_ms;  ///< one for each frame, see host::Spent
};

/// Outcome of a cell.
struct CellResult {
  std::string failure;      ///< why it failed; empty where it is done
  std::string left;         ///< why there is no result: nothing that the cell is to blame for
  std::string first_error;  ///< error of a frame, with frame and stage; empty if there was none
  std::optional<RunMetrics> metrics;  ///< all metrics that could be measured
  std::vector<std::string> executed;  ///< stages that it ran itself
  std::vector<StageTiming> timings;   ///< times of these stages and of the source
  double seconds = 0.0;               ///< [s] its process took since its cell before
  std::string pipeline;               ///< the effective configuration, as YAML
  std::vector<std::pair<std::string, std::string>> pictures;  ///< images of the worst frames, by
                                                              ///< file name
  host::NamedRecords shapes;  ///< template, and shape and truth of some of the frames
};

/// Receives the results of a group, from the thread that runs it.
class GroupObserver {
 public:
  virtual ~GroupObserver() = default;
  /// A cell is about to use time that it does not share.
  virtual void cell_works() {}
  /// `frames` is -1 when unknown.
  virtual void frame_done(std::int64_t done, std::int64_t frames) = 0;
  /// An Error ends the group: the result could not be kept.
  virtual Result<void> cell_done(const Cell& cell, const CellResult& result) = 0;
  /// The cell has no result, and is to be run again another time.
  virtual void cell_left(const Cell& cell, const std::string& reason) = 0;
};

/// Runs cells that read the same frames, in step: each frame is read once, and each stage key is
/// executed once. Errors of a cell are its result: it has failed if a run of its pipeline would end
/// with exit code 1 or 2. Errors that do not depend on the cell are returned: lack of memory, a
/// file that disappeared or changed meanwhile, a library that cannot be loaded.
///
/// A cell fails, and runs no further frame, when its stages have taken longer than the plan's
/// deadline. Work that cells share counts for the first of them.
Result<void> run_group(const Grid& grid, const std::vector<const Cell*>& cells,
                       GroupObserver& observer);

}  // namespace weft::lab
