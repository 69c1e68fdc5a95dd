// SPDX-License-Identifier: Apache-2.0
// Boards besides the default one, rendered as a camera that is known sees them.
#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "board_views.hpp"
#include "lab/calibration/board_finder.hpp"
#include "lab/calibration/board_recognition.hpp"
#include "lab/calibration/calibrate.hpp"
#include "support/page_camera.hpp"

namespace weft::calibration {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::PageCamera;

constexpr int kPxPerMm = 8;
constexpr std::uint64_t kSeed = 21;

Board board_named(const std::string& squares, double square_m, const std::string& pattern,
                  const std::string& dictionary = "4x4_250", double share = kMarkerShare) {
  const auto board = parse_board(squares, square_m, pattern, dictionary, share);
  EXPECT_TRUE(board) << board.error().message;
  return board ? *board : Board();
}

cv::Mat page_of(const Board& board) {
  if (board.pattern == Pattern::charuco || board.pattern == Pattern::chessboard) {
    return testing::picture_of_page(*board_page(board, *find_paper("a4")), kPxPerMm);
  }
  const bool asymmetric = board.pattern == Pattern::asymmetric_circles;
  cv::Mat page = testing::picture_of_page("", kPxPerMm);
  const double step_px = 1e3 * board.square_m * kPxPerMm;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const double across = asymmetric ? 2.0 * column + row % 2 : column;
      const double width = asymmetric ? 2.0 * board.columns - 1.0 : board.columns - 1.0;
      const cv::Point2d centre(0.5 * page.cols + (across - 0.5 * width) * step_px,
                               0.5 * page.rows + (row - 0.5 * (board.rows - 1)) * step_px);
      cv::circle(page, centre, static_cast<int>(0.33 * step_px), 20, cv::FILLED, cv::LINE_AA);
    }
  }
  return page;
}

std::vector<cv::Mat> images_of(const Board& board, int count) {
  const testing::Lens lens = usual_lens();
  const PageCamera camera(lens, page_of(board), kPxPerMm, 2);
  Rng rng(kSeed);
  const Eigen::Vector2d middle_m =
      5e-4 * Eigen::Vector2d(testing::kPageWidth_mm, testing::kPageHeight_mm);
  std::vector<cv::Mat> images;
  for (int i = 0; i < count; ++i) {
    images.push_back(camera.image(testing::good_pose(lens, middle_m, 0.45, i, rng), rng));
  }
  return images;
}

std::string recognized(const Board& declared, const std::vector<cv::Mat>& images) {
  return other_board(declared, images).value_or("nothing");
}

TEST(OtherBoards, ChessboardsAndGridsOfCirclesGiveTheCamera) {
  RecordProperty("seed", static_cast<int>(kSeed));
  const testing::Lens lens = usual_lens();
  for (const Board& board :
       {board_named("9x6", 0.022, "chessboard"), board_named("8x5", 0.024, "circles"),
        board_named("4x9", 0.018, "asymmetric-circles")}) {
    const BoardFinder finder(board);
    std::vector<View> views;
    for (const cv::Mat& image : images_of(board, 14)) {
      if (auto view = finder.find(image, "view")) views.push_back(*std::move(view));
    }
    ASSERT_GE(views.size(), 8U) << options_of(board);
    const auto calibration = calibrate(views, size_of(lens), 4);
    ASSERT_TRUE(calibration) << options_of(board) << ": " << calibration.error().message;
    EXPECT_NEAR(calibration->solution.fx, lens.fx, 0.01 * lens.fx) << options_of(board);
    EXPECT_NEAR(calibration->solution.fy, lens.fy, 0.01 * lens.fy) << options_of(board);
    EXPECT_NEAR(calibration->solution.cx, lens.cx, 3.0) << options_of(board);
    EXPECT_NEAR(calibration->solution.cy, lens.cy, 3.0) << options_of(board);
  }
}

TEST(OtherBoards, AreNamedWithTheOptionsThatDeclareThem) {
  const std::vector<std::pair<Board, std::string>> boards{
      {board_named("9x6", 0.022, "chessboard"),
       "a chessboard without markers of 9 x 6 squares (8 x 5 inner corners), not the board of "
       "--squares 7x5: give --board chessboard --squares 9x6"},
      {board_named("8x5", 0.024, "circles"), "give --board circles --squares"},
      {board_named("4x9", 0.018, "asymmetric-circles"),
       "give --board asymmetric-circles --squares 4x9"},
      {board_named("8x6", 0.025, "charuco"),
       "a ChArUco board of 8 x 6 squares with markers of the dictionary 4x4_250, not the board of "
       "--squares 7x5: give --squares 8x6"},
      {board_named("7x5", 0.03, "charuco", "6x6_250"), "give --squares 7x5 --dictionary 6x6_50"},
      {board_named("7x5", 0.03, "charuco", "4x4_250", 0.8),
       "give --squares 7x5 --marker-share 0."}};
  for (const auto& [board, message] : boards) {
    const auto images = images_of(board, 1);
    EXPECT_THAT(recognized(Board(), images), HasSubstr(message)) << options_of(board);
    EXPECT_EQ(recognized(board, images).find("give " + options_of(board)), std::string::npos);
  }
}

TEST(OtherBoards, TheFinderDoesNotTakeThemForItsOwn) {
  const BoardFinder finder{Board()};
  for (const Board& board :
       {board_named("8x6", 0.025, "charuco"), board_named("7x5", 0.03, "charuco", "4x4_250", 0.8),
        board_named("9x6", 0.022, "chessboard")}) {
    for (const cv::Mat& image : images_of(board, 1)) {
      EXPECT_FALSE(finder.find(image, "view")) << options_of(board);
    }
  }
}

TEST(OtherBoards, AGridOfCirclesIsNeverTakenForAChessboard) {
  const Board board = board_named("4x9", 0.018, "asymmetric-circles");
  for (const cv::Mat& image : images_of(board, 6)) {
    EXPECT_EQ(recognized(Board(), {image}).find("chessboard without"), std::string::npos);
  }
}

TEST(OtherBoards, MirroredImagesAreNamed) {
  auto images = images_of(Board(), 1);
  for (cv::Mat& image : images) cv::flip(image, image, 1);
  EXPECT_THAT(recognized(Board(), images),
              AllOf(HasSubstr("the mirror image of a ChArUco board of 7 x 5 squares"),
                    HasSubstr("take images that are not mirrored")));
}

TEST(OtherBoards, NothingIsNamedInImagesWithoutABoard) {
  const cv::Mat plain(480, 640, CV_8U, cv::Scalar(128));
  EXPECT_FALSE(other_board(Board(), {plain}));
  EXPECT_FALSE(other_board(Board(), {}));
  EXPECT_FALSE(other_board(Board(), images_of(Board(), 1)));
}

TEST(OtherBoards, OptionsThatNameNoBoardAreRefusedWithTheChoices) {
  const auto refusal = [](const std::string& pattern, const std::string& dictionary, double share) {
    const auto board = parse_board("7x5", 0.03, pattern, dictionary, share);
    return board ? "" : board.error().message;
  };
  EXPECT_THAT(refusal("chess", "4x4_250", 0.6), HasSubstr("charuco, chessboard, circles"));
  EXPECT_THAT(refusal("charuco", "4x4_200", 0.6), HasSubstr("4x4_50, 4x4_100"));
  EXPECT_THAT(refusal("charuco", "4x4_250", 1.5), HasSubstr("0.2 to 0.95"));
  EXPECT_FALSE(parse_board("20x20", 0.01, "charuco", "4x4_50", 0.6));
  EXPECT_FALSE(board_page(board_named("8x5", 0.02, "circles"), *find_paper("a4")));
}

}  // namespace
}  // namespace weft::calibration
