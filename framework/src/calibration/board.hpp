// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::calibration {

/// A chessboard with markers in its white squares (ChArUco), of the dictionary 4x4_250.
struct Board {
  int columns = 7, rows = 5;  ///< squares
  double square_m = 0.03;     ///< side of a square, as printed

  double width_m() const { return columns * square_m; }
  double height_m() const { return rows * square_m; }
  /// Places where four squares meet, which calibration looks for.
  int corners() const { return (columns - 1) * (rows - 1); }
};

/// Side of a marker, of that of its square. Smaller ones leave more room around the corners, which
/// are then found more exactly.
inline constexpr double kMarkerShare = 0.6;

/// "7x5" as columns and rows.
Result<Board> parse_board(const std::string& squares, double square_m);

/// A sheet of paper, upright.
struct Paper {
  std::string name;
  double width_mm = 0.0, height_mm = 0.0;
};

/// a4, a3, a2 or letter.
Result<Paper> find_paper(const std::string& name);

/// The board as a PDF of exact size, in the middle of a sheet that lies as fits it, with a caption
/// and a bar of known length below. Errc::invalid_value where the paper does not hold it.
Result<std::string> board_page(const Board& board, const Paper& paper);

}  // namespace weft::calibration
