// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco/charuco.hpp>
#include <string>
#include <weft/core/result.hpp>

#include "lab/calibration/board.hpp"
#include "lab/calibration/view.hpp"

namespace weft::calibration {

/// Finds a board in images: ChArUco by its markers, others as a whole.
class BoardFinder {
 public:
  explicit BoardFinder(const Board& board);

  /// The corners that a grey image shows. Errc::no_result, with the reason, where these are too few
  /// to locate the board.
  Result<View> find(const cv::Mat& grey, const std::string& name) const;

 private:
  Result<View> find_charuco(const cv::Mat& grey, const std::string& name) const;
  Result<View> find_whole(const cv::Mat& grey, const std::string& name) const;

  Board board_;
  cv::Ptr<cv::aruco::CharucoBoard> charuco_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
};

}  // namespace weft::calibration
