// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/catalogue_page.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

namespace weft {
namespace {

/// The rows of the page that contain all of these texts.
std::vector<std::string> rows_with(const std::vector<std::string>& texts) {
  std::istringstream page(catalogue_page());
  std::vector<std::string> rows;
  for (std::string line; std::getline(page, line);) {
    bool has_all = line.starts_with("| ");
    for (const std::string& text : texts) has_all = has_all && line.find(text) != line.npos;
    if (has_all) rows.push_back(line);
  }
  return rows;
}

TEST(CataloguePageTest, MarksEachSetOfValuesAsOpenOrClosed) {
  EXPECT_EQ(rows_with({"| state |", "; closed set |"}).size(), 1U);
  EXPECT_EQ(rows_with({"| metric |", "; closed set |"}).size(), 1U);
  EXPECT_EQ(rows_with({"| match_label (optional) |", "; closed set |"}).size(), 1U);
  EXPECT_EQ(rows_with({"| reason |", "; open set |"}).size(), 1U);
  EXPECT_EQ(rows_with({"| kind |", "; open set |"}).size(), 1U);
  EXPECT_EQ(rows_with({" set |"}).size(), 5U);
}

TEST(CataloguePageTest, MarksTheOnlyInputThatCanOccurSeveralTimesInACall) {
  const std::vector<std::string> rows = rows_with({" (list)"});
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_TRUE(rows[0].starts_with("| matchers | 0 match |")) << rows[0];
  EXPECT_NE(rows[0].find("`correspondences` (list), `image`"), std::string::npos) << rows[0];
}

}  // namespace
}  // namespace weft
