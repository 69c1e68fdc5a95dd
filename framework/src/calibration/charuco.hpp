// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco/charuco.hpp>

#include "calibration/board.hpp"

namespace weft::calibration {

/// The board as OpenCV knows it, in metres, x right and y down from its top left corner.
cv::Ptr<cv::aruco::CharucoBoard> make_charuco(const Board& board);

}  // namespace weft::calibration
