// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lab/results/cell_record.hpp"
#include "lab/results/plan_record.hpp"

/// The results folder of an ablation, read for tables and figures; see docs/results.md.
namespace weft::lab {

/// Frames of a sequence, as reported by the cells that completed it.
struct SequenceSize {
  std::int64_t frames = 0, truth_frames = 0;  ///< [] frames; frames with truth
};

struct Results {
  std::string folder;
  std::string version;          ///< version of weft, with its commit
  bool accept_rebuilt = false;  ///< results of differently built components may stand side by side
  std::string alignment = "none";        ///< that every error was measured with
  double match_tolerance_px = kUnknown;  ///< [] px, up to which a match is correct
  PlanRecord plan;
  CellRecords records;                        ///< includes cells of other plans
  std::map<std::string, SequenceSize> sizes;  ///< by sequence
  std::set<std::string> processors;           ///< that computed them

  /// Takes what was read, and what follows from it.
  void take(CellRecords read);

  /// The record of a cell; outcome `missing` if there is none.
  const CellRecord& record(const PlanCell& cell) const;
  /// Frames that the cell was to solve: those of its sequence, where it failed before the first.
  SequenceSize size(const PlanCell& cell) const;
};

/// Reads a results folder; truncated or damaged results are omitted. Fails with not_found if the
/// folder is none, with incompatible for another schema, with invalid_data for a damaged plan.
Result<Results> read_results(const std::string& folder);

}  // namespace weft::lab
