// SPDX-License-Identifier: Apache-2.0
#include "lab/results/cell_line.hpp"

#include <gtest/gtest.h>

namespace weft::lab {
namespace {

nlohmann::ordered_json cell(const std::string& reason) {
  return {{"schema", kLineSchema},
          {"key", std::string(kKeyDigits, 'a')},
          {"outcome", reason.empty() ? "done" : "failed"},
          {"reason", reason},
          {"metrics",
           {{"run", "a \"}{\\"}, {"frames", {{{"frame", 0}}}}, {"all", {{"metrics", {{"n", 1}}}}}}},
          {"stages", {{{"stage", "solvers"}}}},
          {"files", nlohmann::ordered_json::array()}};
}

TEST(CellLine, HasAllButItsMetricsWhereTheseAreNotWanted) {
  for (const char* reason : {"", ",\"metrics\":{ was \\ not closed", "}}\"{"}) {
    const std::string line = checked_line(cell(reason));
    auto whole = trusted_line(line, {true, true});
    const auto without = trusted_line(line, {false, false});
    ASSERT_TRUE(whole) << whole.error().message;
    ASSERT_TRUE(without) << without.error().message;
    EXPECT_TRUE(without->checked);
    EXPECT_TRUE(whole->object.contains("metrics"));
    whole->object.erase("metrics");
    EXPECT_EQ(without->object, whole->object) << reason;
  }
}

TEST(CellLine, IsReadWithoutMetricsWhereItHasNone) {
  nlohmann::ordered_json failed = cell("it failed");
  failed["metrics"] = nullptr;
  const auto line = trusted_line(checked_line(failed), {false, false});
  ASSERT_TRUE(line) << line.error().message;
  EXPECT_TRUE(line->object.at("metrics").is_null());
  EXPECT_EQ(failure_of(line->object), "it failed");
}

TEST(CellLine, IsCheckedAsAWholeWithoutItsMetricsToo) {
  std::string line = checked_line(cell(""));
  line[line.find("\"n\":1") + 4] = '2';
  const auto changed = trusted_line(line, {false, false});
  ASSERT_FALSE(changed);
  EXPECT_EQ(changed.error().message, "it was changed after it was written");
}

}  // namespace
}  // namespace weft::lab
