// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/board.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace weft::calibration {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Board, IsReadFromColumnsAndRows) {
  const auto board = parse_board("9x6", 0.025);
  ASSERT_TRUE(board);
  EXPECT_EQ(board->columns, 9);
  EXPECT_EQ(board->rows, 6);
  EXPECT_EQ(board->corners(), 40);
}

TEST(Board, OfOtherTextsIsRefusedWithAnExample) {
  for (const char* text : {"", "7", "7x", "x5", "7 x 5", "7x5x3", "7*5", "axb"}) {
    const auto board = parse_board(text, 0.03);
    ASSERT_FALSE(board) << text;
    EXPECT_THAT(board.error().message, HasSubstr("such as 7x5")) << text;
  }
  for (const char* text : {"2x5", "7x23", "-3x5"}) {
    ASSERT_FALSE(parse_board(text, 0.03)) << text;
    EXPECT_THAT(parse_board(text, 0.03).error().message, HasSubstr("3 to 22 squares"));
  }
  for (const double side : {0.0, -0.03, 30.0, std::nan("")}) {
    ASSERT_FALSE(parse_board("7x5", side)) << side;
    EXPECT_THAT(parse_board("7x5", side).error().message, HasSubstr("no side of a square"));
  }
}

TEST(Board, ThatThePaperDoesNotHoldIsRefusedWithTheSizeThatFits) {
  const auto page = board_page({7, 5, 0.05}, *find_paper("a4"));
  ASSERT_FALSE(page);
  EXPECT_THAT(page.error().message, AllOf(HasSubstr("350 x 250 mm"), HasSubstr("--square 0.037")));
  EXPECT_TRUE(board_page({7, 5, 0.037}, *find_paper("a4")));
  EXPECT_TRUE(board_page({7, 5, 0.05}, *find_paper("a3")));
  EXPECT_FALSE(find_paper("a5"));
}

TEST(Board, IsTheSamePageEveryTime) {
  const auto page = board_page({7, 5, 0.03}, *find_paper("a4"));
  ASSERT_TRUE(page);
  EXPECT_TRUE(page->starts_with("%PDF-1.4\n"));
  EXPECT_THAT(*page, HasSubstr("--squares 7x5 --square 0.03"));
  EXPECT_EQ(*page, *board_page({7, 5, 0.03}, *find_paper("a4")));
}

}  // namespace
}  // namespace weft::calibration
