// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco/charuco.hpp>
#include <string>
#include <vector>

#include "lab/calibration/board.hpp"

namespace weft::calibration {

/// The board in OpenCV's representation, in metres, x right and y down from its top left corner.
cv::Ptr<cv::aruco::CharucoBoard> make_charuco(const Board& board);

/// A predefined dictionary of ArUco markers.
struct Dictionary {
  std::string name;
  int number = 0;   ///< that OpenCV gives it
  int markers = 0;  ///< [] number of markers
};
const std::vector<Dictionary>& dictionaries();
/// Null where none has this name.
const Dictionary* find_dictionary(const std::string& name);

}  // namespace weft::calibration
