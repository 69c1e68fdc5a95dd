// SPDX-License-Identifier: Apache-2.0
#include "cli/results/cell_failures.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <string>

namespace weft::cli {
namespace {

constexpr std::size_t kMost = 10;

std::string name_of(const lab::Results& results, const lab::PlanCell& cell) {
  std::string name;
  for (std::size_t i = 0; i < cell.values.size(); ++i) {
    name += results.plan.axes[i].name + "=" + cell.values[i] + ", ";
  }
  return name + fmt::format("sequence={}, seed={}", cell.sequence, cell.seed);
}

}  // namespace

void print_failures(const lab::Results& results) {
  std::size_t shown = 0;
  for (const lab::PlanCell& cell : results.plan.cells) {
    const lab::CellRecord& record = results.record(cell);
    if (!record.failed() || shown++ >= kMost) continue;
    fmt::print("failed: {}: {}\n", name_of(results, cell), record.reason);
  }
  if (shown > kMost) fmt::print("failed: {} more cells\n", shown - kMost);
}

void print_errors(const lab::Results& results) {
  std::size_t shown = 0;
  for (const lab::PlanCell& cell : results.plan.cells) {
    const lab::CellRecord& record = results.record(cell);
    if (!record.done() || record.frames_in_error == 0 || shown++ >= kMost) continue;
    fmt::print("errors: {}: {} of {} frames had one{}\n", name_of(results, cell),
               record.frames_in_error, record.frames,
               record.first_error.empty() ? "" : "; the first: " + record.first_error);
  }
  if (shown > kMost) fmt::print("errors: {} more cells\n", shown - kMost);
}

}  // namespace weft::cli
