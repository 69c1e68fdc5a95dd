// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "lab/ablation/plan/grid.hpp"

namespace weft::lab {
namespace {

std::vector<std::string> keys_of(const std::string& plan) {
  const auto registry = host::Registry::scan({{WEFT_REAL_PLUGINS, "test"}});
  // One sequence and one background: what differs between the plans is in the other axes.
  const auto [grid, report] =
      load_grid(plan, registry, {"data.frex.seeds=101", "axes.background.values=[plain]"});
  EXPECT_TRUE(report.ok()) << report.text();
  std::vector<std::string> keys;
  for (const Cell& cell : grid.cells()) keys.push_back(cell.identity.key);
  std::sort(keys.begin(), keys.end());
  return keys;
}

TEST(PlanCells, AreTheSameWhetherThresholdsAreDeclaredOrWrittenOut) {
  const auto by_hand = keys_of(WEFT_PLANS "/filters_frex_by_hand.yaml");
  EXPECT_EQ(by_hand.size(), 8U * 2U * (2U + 11U * 9U));
  EXPECT_EQ(keys_of(WEFT_PIPELINES "/ablations/filters_frex.yaml"), by_hand);
}

}  // namespace
}  // namespace weft::lab
