// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::calibration {

/// A chessboard with markers in its white squares (ChArUco), a plain one, and grids of circles. In
/// the asymmetric grid, every second row is shifted by half the distance of two circles in a row.
enum class Pattern { charuco, chessboard, circles, asymmetric_circles };

/// Side of a marker, of that of its square. Smaller ones leave more room around the corners, which
/// are then found more exactly.
inline constexpr double kMarkerShare = 0.6;

struct Board {
  int columns = 7, rows = 5;  ///< squares, or circles in a row and rows
  double square_m = 0.03;     ///< side of a square, as printed; of circles, from row to row
  Pattern pattern = Pattern::charuco;
  std::string dictionary = "4x4_250";  ///< dictionary of ChArUco's markers
  double marker_share = kMarkerShare;  ///< the same: side of a marker, of that of its square

  double width_m() const { return columns * square_m; }
  double height_m() const { return rows * square_m; }
  /// Places where four squares meet, or circles: what calibration looks for.
  int corners() const {
    const bool squares = pattern == Pattern::charuco || pattern == Pattern::chessboard;
    return squares ? (columns - 1) * (rows - 1) : columns * rows;
  }
};

/// "7x5" as columns and rows.
Result<Board> parse_board(const std::string& squares, double square_m);

/// The same of a pattern and a dictionary by name, such as "charuco" and "5x5_100".
Result<Board> parse_board(const std::string& squares, double square_m, const std::string& pattern,
                          const std::string& dictionary, double marker_share);

/// "--board chessboard --squares 9x6": the options that differ from the defaults.
std::string options_of(const Board& board);

/// A sheet of paper, upright.
struct Paper {
  std::string name;
  double width_mm = 0.0, height_mm = 0.0;
};

/// a4, a3, a2 or letter.
Result<Paper> find_paper(const std::string& name);

/// The board as a PDF of exact size, centred on a paper in the better orientation, with a caption
/// and a bar of known length below. Errc::invalid_value if the paper is too small.
Result<std::string> board_page(const Board& board, const Paper& paper);

}  // namespace weft::calibration
