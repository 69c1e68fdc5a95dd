// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <weft/evaluation/ablation.hpp>

namespace weft::evaluation {
namespace {

bool is_finished(const std::map<std::string, StoredCell>& stored, const Cell& cell, bool timed) {
  const auto found = stored.find(cell.identity.key);
  return found != stored.end() && (found->second.timed || !timed);
}

void adopt_rebuilt(Grid& grid, const std::map<std::string, StoredCell>& stored) {
  std::map<std::string, std::string> keys;  // by rebuilt key
  for (const auto& [key, cell] : stored) keys.emplace(cell.rebuilt_key, key);
  for (std::size_t i = 0; i < grid.cells().size(); ++i) {
    const CellIdentity& identity = grid.cells()[i].identity;
    const auto known = keys.find(identity.rebuilt_key);
    if (stored.count(identity.key) == 0 && known != keys.end()) grid.adopt(i, known->second);
  }
}

/// Cells without a result, each key once, those that read the same frames together.
std::vector<std::vector<const Cell*>> pending(const Grid& grid,
                                              const std::map<std::string, StoredCell>& stored,
                                              bool timed) {
  std::vector<std::vector<const Cell*>> groups;
  std::map<std::string, std::size_t> group_of;
  std::set<std::string> keys;
  for (const Cell& cell : grid.cells()) {
    if (is_finished(stored, cell, timed) || !keys.insert(cell.identity.key).second) continue;
    const auto [known, is_new] = group_of.emplace(cell.identity.group, groups.size());
    if (is_new || timed) groups.emplace_back();
    groups[timed ? groups.size() - 1 : known->second].push_back(&cell);
  }
  return groups;
}

}  // namespace

Result<AblationState> state_of(Grid& grid, const ResultsFolder& folder,
                               const AblationOptions& options) {
  auto stored = folder.read();
  if (!stored) return stored.error();
  if (options.accept_rebuilt) adopt_rebuilt(grid, *stored);
  AblationState state;
  std::set<std::string> keys;
  for (const Cell& cell : grid.cells()) {
    ++state.cells;
    const bool is_new = keys.insert(cell.identity.key).second;
    if (!is_finished(*stored, cell, options.timed)) {
      ++state.left;
      continue;
    }
    const StoredCell& result = stored->at(cell.identity.key);
    ++(result.failed ? state.failed : state.done);
    const bool crashed = result.failed && result.executed.empty();
    if (!is_new || crashed) continue;
    state.stages += cell.stages.size();
    state.stages_executed += result.executed.size();
  }
  state.keys = keys.size();
  state.stored = *std::move(stored);
  return state;
}

Result<AblationState> run_ablation(Grid& grid, const ResultsFolder& folder, Engine& engine,
                                   const AblationOptions& options, const Engine::Progress& progress,
                                   const std::atomic<bool>& cancel) {
  const auto before = state_of(grid, folder, options);
  if (!before) return before.error();
  const auto described = folder.describe(grid, options.command, options.accept_rebuilt);
  if (!described) return described.error();
  const Order order{grid, folder, pending(grid, before->stored, options.timed), options.timed};
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

}  // namespace weft::evaluation
