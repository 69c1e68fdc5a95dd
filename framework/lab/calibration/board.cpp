// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/board.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <opencv2/aruco/charuco.hpp>
#include <vector>

#include "lab/calibration/charuco.hpp"
#include "lab/printing/pdf_page.hpp"

namespace weft::calibration {
namespace {

constexpr int kFewestSquares = 3, kMostSquares = 22;  // the dictionary has 250 markers
constexpr double kSmallest_m = 0.002, kLargest_m = 1.0;
constexpr double kMargin_mm = 8.0, kCaption_mm = 8.0;

/// Draws squares and the black modules of markers; (x0, y0) is the board's top left corner.
class BoardDrawing {
 public:
  BoardDrawing(PdfPage& page, double x0_mm, double y0_mm) : page_(page), x0_(x0_mm), y0_(y0_mm) {}

  void draw(const Board& board) {
    const double side = 1e3 * board.square_m, marker = board.marker_share * side;
    std::vector<bool> white(static_cast<std::size_t>(board.columns * board.rows), false);
    if (board.pattern == Pattern::chessboard) {
      for (std::size_t i = 0; i < white.size(); ++i) {
        const auto columns = static_cast<std::size_t>(board.columns);
        white[i] = (i / columns + i % columns) % 2 == 1;
      }
      return fill_black(board, white);
    }
    const auto charuco = make_charuco(board);
    for (std::size_t i = 0; i < charuco->ids.size(); ++i) {
      // Its first corner is the top left one; the square is that around its middle.
      const cv::Point3f& first = charuco->objPoints[i][0];
      const cv::Point3f& opposite = charuco->objPoints[i][2];
      const double unit = board.square_m;
      const int column = static_cast<int>((first.x + opposite.x) / (2.0 * unit));
      const int row = static_cast<int>((first.y + opposite.y) / (2.0 * unit));
      white[static_cast<std::size_t>(row * board.columns + column)] = true;
      const double inset = 0.5 * (side - marker);
      draw_marker(charuco->dictionary, charuco->ids[i], column * side + inset, row * side + inset,
                  marker);
    }
    fill_black(board, white);
  }

 private:
  void fill_black(const Board& board, const std::vector<bool>& white) {
    const double side = 1e3 * board.square_m;
    for (int row = 0; row < board.rows; ++row) {
      for (int column = 0; column < board.columns; ++column) {
        if (white[static_cast<std::size_t>(row * board.columns + column)]) continue;
        page_.fill_rectangle(x0_ + column * side, y0_ + row * side, side, side);
      }
    }
  }

  /// Runs of black modules, so that no reader shows seams inside of them along a row.
  void draw_marker(const cv::Ptr<cv::aruco::Dictionary>& dictionary, int id, double x, double y,
                   double side) {
    const int modules = dictionary->markerSize + 2;
    cv::Mat picture;
    dictionary->drawMarker(id, modules, picture, 1);
    const double module = side / modules;
    for (int j = 0; j < modules; ++j) {
      for (int i = 0, end = 0; i < modules; i = end + 1) {
        for (end = i; end < modules && picture.at<std::uint8_t>(j, end) < 128;) ++end;
        if (end == i) continue;
        page_.fill_rectangle(x0_ + x + i * module, y0_ + y + j * module, (end - i) * module,
                             module);
      }
    }
  }

  PdfPage& page_;
  double x0_, y0_;
};

void add_caption(PdfPage& page, const Board& board, double width_mm, double height_mm) {
  constexpr double kHeight_mm = 2.6, kTick_mm = 1.5, kLine_mm = 0.2, kBar_mm = 50.0;
  const double baseline_mm = height_mm - kMargin_mm;
  page.write_text(
      kMargin_mm, baseline_mm, kHeight_mm,
      fmt::format("Print at 100 %, without scaling: the bar is {:.0f} mm.  Weft calibration board, "
                  "{} --square {}",
                  kBar_mm, options_of(board), board.square_m));
  const double x1 = width_mm - kMargin_mm, x0 = x1 - kBar_mm, y = baseline_mm - 0.8;
  for (const double x : {x0, x1}) page.draw_line(x, y - kTick_mm, x, y + kTick_mm, kLine_mm);
  page.draw_line(x0, y, x1, y, kLine_mm);
}

}  // namespace

cv::Ptr<cv::aruco::CharucoBoard> make_charuco(const Board& board) {
  return cv::aruco::CharucoBoard::create(
      board.columns, board.rows, static_cast<float>(board.square_m),
      static_cast<float>(board.marker_share * board.square_m),
      cv::aruco::getPredefinedDictionary(find_dictionary(board.dictionary)->number));
}

const std::vector<Dictionary>& dictionaries() {
  static const std::vector<Dictionary> kAll = [] {
    std::vector<Dictionary> all;
    int number = 0;
    for (int bits = 4; bits <= 7; ++bits) {
      for (const int markers : {50, 100, 250, 1000}) {
        all.push_back({fmt::format("{0}x{0}_{1}", bits, markers), number++, markers});
      }
    }
    all.push_back({"original", number++, 1024});
    all.push_back({"apriltag_16h5", number++, 30});
    all.push_back({"apriltag_25h9", number++, 35});
    all.push_back({"apriltag_36h10", number++, 2320});
    all.push_back({"apriltag_36h11", number++, 587});
    return all;
  }();
  return kAll;
}

const Dictionary* find_dictionary(const std::string& name) {
  for (const Dictionary& dictionary : dictionaries()) {
    if (dictionary.name == name) return &dictionary;
  }
  return nullptr;
}

namespace {

constexpr std::pair<Pattern, const char*> kPatterns[] = {
    {Pattern::charuco, "charuco"},
    {Pattern::chessboard, "chessboard"},
    {Pattern::circles, "circles"},
    {Pattern::asymmetric_circles, "asymmetric-circles"}};

}  // namespace

std::string options_of(const Board& board) {
  std::string text;
  for (const auto& [pattern, name] : kPatterns) {
    if (pattern != board.pattern || pattern == Pattern::charuco) continue;
    text += fmt::format("--board {} ", name);
  }
  text += fmt::format("--squares {}x{}", board.columns, board.rows);
  const Board usual;
  if (board.dictionary != usual.dictionary) text += " --dictionary " + board.dictionary;
  if (board.marker_share != usual.marker_share) {
    text += fmt::format(" --marker-share {:.2g}", board.marker_share);
  }
  return text;
}

Result<Board> parse_board(const std::string& squares, double square_m, const std::string& pattern,
                          const std::string& dictionary, double marker_share) {
  auto board = parse_board(squares, square_m);
  if (!board) return board;
  const auto* const found = std::find_if(std::begin(kPatterns), std::end(kPatterns),
                                         [&](const auto& each) { return pattern == each.second; });
  if (found == std::end(kPatterns)) {
    return Error{
        Errc::invalid_value,
        "there is no board '" + pattern + "': charuco, chessboard, circles or asymmetric-circles",
        "--board"};
  }
  const Dictionary* const markers = find_dictionary(dictionary);
  if (markers == nullptr) {
    return Error{Errc::invalid_value,
                 "there is no dictionary '" + dictionary +
                     "': 4x4_50, 4x4_100, 4x4_250, 4x4_1000, the same of 5x5, 6x6 and 7x7, "
                     "original, apriltag_16h5, apriltag_25h9, apriltag_36h10 or apriltag_36h11",
                 "--dictionary"};
  }
  if (!(marker_share >= 0.2 && marker_share <= 0.95)) {
    return Error{Errc::invalid_value, "must be from 0.2 to 0.95, such as 0.75", "--marker-share"};
  }
  board->pattern = found->first;
  board->dictionary = dictionary;
  board->marker_share = marker_share;
  if (board->pattern == Pattern::charuco && board->columns * board->rows / 2 > markers->markers) {
    return Error{Errc::invalid_value,
                 fmt::format("a board of {} squares needs more markers than the {} of {}", squares,
                             markers->markers, dictionary),
                 "--dictionary"};
  }
  return board;
}

Result<Board> parse_board(const std::string& squares, double square_m) {
  Board board;
  board.square_m = square_m;
  const char* const end = squares.data() + squares.size();
  const auto columns = std::from_chars(squares.data(), end, board.columns);
  const bool has_cross = columns.ec == std::errc{} && columns.ptr != end && *columns.ptr == 'x';
  const auto rows = std::from_chars(has_cross ? columns.ptr + 1 : end, end, board.rows);
  if (!has_cross || rows.ec != std::errc{} || rows.ptr != end) {
    return Error{Errc::invalid_value,
                 "'" + squares + "' is no number of squares: write columns x rows, such as 7x5",
                 "--squares"};
  }
  const auto [fewest, most] = std::minmax(board.columns, board.rows);
  if (fewest < kFewestSquares || most > kMostSquares) {
    return Error{Errc::invalid_value,
                 fmt::format("a board of {} has {} to {} squares along each side", squares,
                             kFewestSquares, kMostSquares),
                 "--squares"};
  }
  if (!(square_m >= kSmallest_m && square_m <= kLargest_m)) {
    return Error{Errc::invalid_value,
                 fmt::format("{} m is no side of a square: give metres from {} to {}, such as 0.03",
                             square_m, kSmallest_m, kLargest_m),
                 "--square"};
  }
  return board;
}

Result<Paper> find_paper(const std::string& name) {
  const Paper known[] = {
      {"a4", 210.0, 297.0}, {"a3", 297.0, 420.0}, {"a2", 420.0, 594.0}, {"letter", 215.9, 279.4}};
  for (const Paper& paper : known) {
    if (paper.name == name) return paper;
  }
  return Error{Errc::invalid_value, "there is no paper '" + name + "': a4, a3, a2 or letter",
               "--paper"};
}

Result<std::string> board_page(const Board& board, const Paper& paper) {
  if (board.pattern != Pattern::charuco && board.pattern != Pattern::chessboard) {
    return Error{Errc::invalid_value, "circles are not printed: charuco or chessboard", "--board"};
  }
  const bool lies = board.columns > board.rows;
  const double width_mm = lies ? paper.height_mm : paper.width_mm;
  const double height_mm = lies ? paper.width_mm : paper.height_mm;
  const double room_x_mm = width_mm - 2.0 * kMargin_mm;
  const double room_y_mm = height_mm - 2.0 * kMargin_mm - kCaption_mm;
  const double x_mm = 1e3 * board.width_m(), y_mm = 1e3 * board.height_m();
  if (x_mm > room_x_mm || y_mm > room_y_mm) {
    const double side_mm = std::min(room_x_mm / board.columns, room_y_mm / board.rows);
    return Error{Errc::invalid_value,
                 fmt::format("{} holds {:.0f} x {:.0f} mm, and {}x{} squares of {} m are {:.0f} x "
                             "{:.0f} mm: give --square {:.3f} or less, or a larger --paper",
                             paper.name, room_x_mm, room_y_mm, board.columns, board.rows,
                             board.square_m, x_mm, y_mm, 1e-3 * std::floor(side_mm)),
                 "--paper"};
  }
  PdfPage page(width_mm, height_mm);
  BoardDrawing(page, 0.5 * (width_mm - x_mm), kMargin_mm + 0.5 * (room_y_mm - y_mm)).draw(board);
  add_caption(page, board, width_mm, height_mm);
  return page.file();
}

}  // namespace weft::calibration
