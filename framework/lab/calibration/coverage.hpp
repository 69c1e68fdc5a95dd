// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "lab/calibration/view.hpp"

namespace weft::calibration {

/// Directions in which a board is turned: which of its sides, as seen, is farther away.
enum class Turn { right, left, lower, upper };
inline constexpr std::array kTurns{Turn::right, Turn::left, Turn::lower, Turn::upper};

/// Which parts of the image views reach, and how they are turned.
struct Coverage {
  static constexpr int kCells = 6;  ///< along each side of the image

  Eigen::MatrixXi corners =
      Eigen::MatrixXi::Zero(kCells, kCells);  ///< [6,6] in cells, from the top
  std::array<int, 4> turned{};                ///< views that are turned well, as kTurns
  double largest_tilt_rad = 0.0;

  void add(const View& view, const ImageSize& size);
  /// Share of the cells that have a corner.
  double share() const;
  /// Advice on the next view: "top right of the image: no corner yet". Empty when nothing is
  /// missing.
  std::vector<std::string> missing() const;
  /// The grid as text, a line a row: a dot where there is no corner.
  std::string grid() const;
};

Coverage coverage_of(const std::vector<View>& views, const ImageSize& size);

}  // namespace weft::calibration
