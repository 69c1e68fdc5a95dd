// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/ablation.hpp"

#include <algorithm>
#include <set>

namespace weft::lab {
namespace {

bool is_finished(const std::map<std::string, CellRecord>& stored, const Cell& cell, bool timed) {
  const auto found = stored.find(cell.identity.key);
  return found != stored.end() && (found->second.timed || !timed);
}

void adopt_rebuilt(Grid& grid, const std::map<std::string, CellRecord>& stored) {
  std::map<std::string, std::string> keys;  // by rebuilt key
  for (const auto& [key, cell] : stored) keys.emplace(cell.rebuilt_key, key);
  for (std::size_t i = 0; i < grid.cells().size(); ++i) {
    const CellIdentity& identity = grid.cells()[i].identity;
    const auto known = keys.find(identity.rebuilt_key);
    if (stored.count(identity.key) == 0 && known != keys.end()) grid.adopt(i, known->second);
  }
}

/// Keys with nothing but a damaged result.
std::set<std::string> damaged_keys(const CellRecords& stored) {
  std::set<std::string> keys;
  for (const Damage& damage : stored.damaged) {
    if (!damage.key.empty() && stored.cells.count(damage.key) == 0) keys.insert(damage.key);
  }
  return keys;
}

/// Cells without a result, each key once, those that read the same frames together.
std::vector<std::vector<const Cell*>> pending(const Grid& grid, const CellRecords& stored,
                                              bool timed) {
  std::vector<std::vector<const Cell*>> groups;
  std::map<std::string, std::size_t> group_of;
  std::set<std::string> keys = damaged_keys(stored);
  for (const Cell& cell : grid.cells()) {
    if (is_finished(stored.cells, cell, timed)) continue;
    if (!keys.insert(cell.identity.key).second) continue;
    const auto [known, is_new] = group_of.emplace(cell.identity.group, groups.size());
    if (is_new || timed) groups.emplace_back();
    groups[timed ? groups.size() - 1 : known->second].push_back(&cell);
  }
  return groups;
}

/// The lines of the grid's cells that failed.
std::vector<Damage> failed_lines(const Grid& grid, const CellRecords& stored) {
  std::vector<Damage> lines;
  std::set<std::string> keys;
  for (const Cell& cell : grid.cells()) {
    const auto found = stored.cells.find(cell.identity.key);
    if (found == stored.cells.end() || !found->second.failed()) continue;
    if (!keys.insert(found->first).second) continue;
    const CellRecord& failed = found->second;
    lines.push_back(
        {{}, "it failed: " + failed.reason, failed.key, failed.place.file, failed.place.number});
  }
  return lines;
}

/// Results in the folder, without those to be tried again. A key may have several lines: a valid
/// one may follow one that is withdrawn.
Result<CellRecords> read_and_withdraw(Grid& grid, const ResultsFolder& folder,
                                      const AblationOptions& options) {
  for (;;) {
    auto stored = read_cell_records(folder.path(), {{}, false, options.retry_damaged, false});
    if (!stored) return stored;
    if (options.accept_rebuilt) adopt_rebuilt(grid, stored->cells);
    std::vector<Damage> lines;
    if (options.retry_damaged) lines = stored->damaged;
    if (options.retry_failed) {
      for (Damage& line : failed_lines(grid, *stored)) lines.push_back(std::move(line));
    }
    if (lines.empty()) return stored;
    if (auto withdrawn = folder.withdraw(lines); !withdrawn) return withdrawn.error();
  }
}

AblationState state_from(const Grid& grid, PlanRecord plan, CellRecords records, bool timed) {
  AblationState state;
  const std::set<std::string> damaged = damaged_keys(records);
  std::set<std::string> keys;
  for (const Cell& cell : grid.cells()) {
    ++state.cells;
    const bool is_new = keys.insert(cell.identity.key).second;
    if (!is_finished(records.cells, cell, timed)) {
      ++(damaged.count(cell.identity.key) > 0 ? state.damaged : state.left);
      continue;
    }
    const CellRecord& record = records.cells.at(cell.identity.key);
    ++(record.failed() ? state.failed : state.done);
    const bool crashed = record.failed() && record.executed.empty();
    if (!is_new || crashed) continue;
    state.stages += cell.stages.size();
    state.stages_executed += record.executed.size();
  }
  state.keys = keys.size();
  state.results.plan = std::move(plan);
  state.results.take(std::move(records));
  return state;
}

}  // namespace

Result<AblationState> state_of(Grid& grid, const ResultsFolder& folder,
                               const AblationOptions& options) {
  PlanRecord plan = grid.record(options.command);
  auto records = read_cell_records(folder.path(), {plan.metrics(), false, false});
  if (!records) return records.error();
  if (options.accept_rebuilt) {
    adopt_rebuilt(grid, records->cells);
    plan = grid.record(options.command);
  }
  return state_from(grid, std::move(plan), *std::move(records), options.timed);
}

Result<AblationState> run_ablation(Grid& grid, const ResultsFolder& folder, Engine& engine,
                                   const AblationOptions& options, const Engine::Progress& progress,
                                   const std::atomic<bool>& cancel) {
  const auto before = read_and_withdraw(grid, folder, options);
  if (!before) return before.error();
  const auto described = folder.describe(grid, options.command, options.accept_rebuilt);
  if (!described) return described.error();
  const Order order{grid, folder, pending(grid, *before, options.timed), options.timed};
  std::vector<std::string> reasons;
  if (!order.groups.empty()) {
    auto left = engine.run(order, progress, cancel);
    if (!left) return left.error();
    reasons = *std::move(left);
  }
  auto state = state_of(grid, folder, options);
  if (state) state->reasons = std::move(reasons);
  return state;
}

}  // namespace weft::lab
