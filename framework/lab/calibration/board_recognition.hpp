// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/features2d.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lab/calibration/board.hpp"

namespace weft::calibration {

using Markers = std::vector<std::vector<cv::Point2f>>;  ///< the corners of each

/// Finds dark spots of any size in an image; circularity is 4 pi area / perimeter^2.
cv::Ptr<cv::FeatureDetector> circle_detector(const cv::Mat& grey, double least_circularity = 0.0);

/// Layout error of the detected markers: the median distance from their places on a board, in
/// squares, up to a homography. Nothing for fewer than 6 markers.
std::optional<double> layout_error(const Markers& markers, const std::vector<int>& ids,
                                   const cv::aruco::CharucoBoard& charuco);

/// Why markers are not those of the board: it has other squares, or markers of another size.
std::optional<std::string> mistake_in_markers(const Markers& markers, const std::vector<int>& ids,
                                              const cv::aruco::CharucoBoard& charuco,
                                              const Board& board);

/// The other board that grey images show, with the options that declare it; nothing if none is
/// recognized. Recognizes ChArUco boards of any dictionary and number of squares, mirrored ones,
/// chessboards without markers, and grids of circles.
std::optional<std::string> other_board(const Board& declared, const std::vector<cv::Mat>& images);

}  // namespace weft::calibration
