// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lab/calibration/board.hpp"
#include "lab/calibration/view.hpp"
#include "support/lens.hpp"

namespace weft::calibration {

inline const Board kBoard{7, 5, 0.03};

using testing::usual_lens;

inline ImageSize size_of(const testing::Lens& lens) { return {lens.width_px, lens.height_px}; }

/// The corners of the board in this pose, those that lie in the image, with noise.
inline View view_at(const testing::Lens& lens, const testing::BoardPose& pose, double noise_px,
                    Rng& rng, const std::string& name = "view") {
  std::vector<Eigen::Vector2d> on_board, seen;
  for (int row = 1; row < kBoard.rows; ++row) {
    for (int column = 1; column < kBoard.columns; ++column) {
      const Eigen::Vector2d at = kBoard.square_m * Eigen::Vector2d(column, row);
      const Eigen::Vector2d px = lens.project(pose * Eigen::Vector3d(at.x(), at.y(), 0.0));
      if (px.x() < 0 || px.y() < 0 || px.x() > lens.width_px - 1 || px.y() > lens.height_px - 1) {
        continue;
      }
      on_board.push_back(at);
      seen.emplace_back(px.x() + noise_px * rng.normal(), px.y() + noise_px * rng.normal());
    }
  }
  const auto count = static_cast<Eigen::Index>(seen.size());
  View view{name, Eigen::MatrixX2d(count, 2), Eigen::MatrixX2d(count, 2)};
  for (Eigen::Index i = 0; i < count; ++i) {
    view.board_m.row(i) = on_board[static_cast<std::size_t>(i)];
    view.image_px.row(i) = seen[static_cast<std::size_t>(i)];
  }
  return view;
}

inline Eigen::Vector2d middle_m() {
  return 0.5 * Eigen::Vector2d(kBoard.width_m(), kBoard.height_m());
}

inline std::vector<View> good_views(const testing::Lens& lens, int count, double noise_px,
                                    Rng& rng) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    views.push_back(view_at(lens, testing::good_pose(lens, middle_m(), 0.35, i, rng), noise_px, rng,
                            "view " + std::to_string(i)));
  }
  return views;
}

}  // namespace weft::calibration
