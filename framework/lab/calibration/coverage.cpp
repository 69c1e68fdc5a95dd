// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/coverage.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>
#include <weft/core/index.hpp>

namespace weft::calibration {
namespace {

constexpr double kTurned_rad = 15.0 * std::numbers::pi / 180.0;
constexpr std::array kRows{"top", "middle", "bottom"};
constexpr std::array kColumns{"left", "centre", "right"};
constexpr std::array kSides{"right", "left", "lower", "upper"};
constexpr int kCellsOfPart = Coverage::kCells / 3;

double along(Turn turn, const Eigen::Vector2d& tilt_rad) {
  switch (turn) {
    case Turn::right:
      return tilt_rad.x();
    case Turn::left:
      return -tilt_rad.x();
    case Turn::lower:
      return tilt_rad.y();
    case Turn::upper:
      return -tilt_rad.y();
  }
  return 0.0;
}

std::string part_of_image(int row, int column) {
  if (row == 1 && column == 1) return "middle of the image";
  return fmt::format("{} {} of the image", kRows[to_index(row)], kColumns[to_index(column)]);
}

}  // namespace

void Coverage::add(const View& view, const ImageSize& size) {
  const auto cell = [](double place_px, int length_px) {
    return std::clamp(static_cast<int>((place_px + 0.5) / length_px * kCells), 0, kCells - 1);
  };
  for (Eigen::Index i = 0; i < view.image_px.rows(); ++i) {
    ++corners(cell(view.image_px(i, 1), size.height_px), cell(view.image_px(i, 0), size.width_px));
  }
  const Eigen::Vector2d tilt_rad = placement_of(view, size).tilt_rad;
  for (const Turn turn : kTurns) {
    if (along(turn, tilt_rad) > kTurned_rad) ++turned[to_index(turn)];
  }
  largest_tilt_rad = std::max(largest_tilt_rad, tilt_rad.norm());
}

double Coverage::share() const {
  return static_cast<double>((corners.array() > 0).count()) / static_cast<double>(corners.size());
}

std::vector<std::string> Coverage::missing() const {
  std::vector<std::string> missing;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const auto part =
          corners.block<kCellsOfPart, kCellsOfPart>(kCellsOfPart * row, kCellsOfPart * column);
      if (part.sum() == 0) missing.push_back(part_of_image(row, column) + ": no corner yet");
    }
  }
  for (const Turn turn : kTurns) {
    if (turned[to_index(turn)] > 0) continue;
    missing.push_back(
        fmt::format("no view with the {} side of the board farther away: turn it by 20 to 40 "
                    "degrees",
                    kSides[to_index(turn)]));
  }
  return missing;
}

std::string Coverage::grid() const {
  std::string text;
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      const int count = corners(row, column);
      text += count == 0 ? "    ." : fmt::format("{:5}", count);
    }
    text += '\n';
  }
  return text;
}

Coverage coverage_of(const std::vector<View>& views, const ImageSize& size) {
  Coverage coverage;
  for (const View& view : views) coverage.add(view, size);
  return coverage;
}

}  // namespace weft::calibration
