// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/board_finder.hpp"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>
#include <weft/core/index.hpp>

#include "lab/calibration/board_recognition.hpp"
#include "lab/calibration/charuco.hpp"

namespace weft::calibration {
namespace {

constexpr int kFewestCorners = 6;

/// True if corners are near one line of the board, which leaves its orientation ambiguous.
bool on_a_line(const Eigen::MatrixX2d& board_m, double square_m) {
  const Eigen::MatrixX2d around = board_m.rowwise() - board_m.colwise().mean();
  const Eigen::Matrix2d spread = around.transpose() * around / static_cast<double>(around.rows());
  const auto narrowest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread, Eigen::EigenvaluesOnly).eigenvalues();
  return narrowest.x() < 0.04 * square_m * square_m;  // two rows have a quarter
}

/// Moves corners to where the gradients meet: OpenCV stops within a tenth of a pixel. The window
/// ends before the corners of markers, to which those of a larger one may run.
void refine(const cv::Mat& grey, const std::vector<std::vector<cv::Point2f>>& markers,
            std::vector<cv::Point2f>& corners) {
  constexpr int kLargest_px = 10;
  for (cv::Point2f& corner : corners) {
    float nearest_px = kLargest_px + 2;
    for (const auto& marker : markers) {
      for (const cv::Point2f& other : marker) {
        nearest_px = std::min(nearest_px,
                              std::max(std::abs(other.x - corner.x), std::abs(other.y - corner.y)));
      }
    }
    const int half = std::clamp(static_cast<int>(nearest_px) - 1, 2, kLargest_px);
    std::vector<cv::Point2f> moved{corner};
    cv::cornerSubPix(grey, moved, {half, half}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3});
    if (cv::norm(moved.front() - corner) < 1.0) corner = moved.front();
  }
}

}  // namespace

BoardFinder::BoardFinder(const Board& board)
    : board_(board),
      charuco_(board.pattern == Pattern::charuco ? make_charuco(board) : nullptr),
      parameters_(cv::aruco::DetectorParameters::create()) {
  parameters_->minMarkerPerimeterRate = 0.02;  // boards that are small in the image, too
}

Result<View> BoardFinder::find(const cv::Mat& grey, const std::string& name) const {
  return board_.pattern == Pattern::charuco ? find_charuco(grey, name) : find_whole(grey, name);
}

Result<View> BoardFinder::find_whole(const cv::Mat& grey, const std::string& name) const {
  std::vector<cv::Point2f> seen;
  const bool chessboard = board_.pattern == Pattern::chessboard;
  const bool asymmetric = board_.pattern == Pattern::asymmetric_circles;
  const cv::Size size(board_.columns - chessboard, board_.rows - chessboard);
  if (chessboard) {
    cv::findChessboardCornersSB(grey, size, seen, cv::CALIB_CB_NORMALIZE_IMAGE);
  } else if (!cv::findCirclesGrid(
                 grey, size, seen,
                 asymmetric ? cv::CALIB_CB_ASYMMETRIC_GRID : cv::CALIB_CB_SYMMETRIC_GRID,
                 circle_detector(grey))) {
    seen.clear();
  }
  if (seen.size() != to_index(board_.corners())) {
    return no_result(fmt::format("no whole {} is seen with {} x {} {}",
                                 chessboard ? "chessboard" : "grid", size.width, size.height,
                                 chessboard ? "inner corners" : "circles"));
  }
  const auto count = static_cast<Eigen::Index>(seen.size());
  View view{name, Eigen::MatrixX2d(count, 2), Eigen::MatrixX2d(count, 2)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = i / size.width, column = i % size.width;
    view.image_px.row(i) << seen[to_index(i)].x, seen[to_index(i)].y;
    view.board_m.row(i) << static_cast<double>(asymmetric ? 2 * column + row % 2 : column),
        static_cast<double>(row);
  }
  view.board_m *= board_.square_m;
  return view;
}

Result<View> BoardFinder::find_charuco(const cv::Mat& grey, const std::string& name) const {
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> ids, corner_ids;
  std::vector<cv::Point2f> corners;
  cv::aruco::detectMarkers(grey, charuco_->dictionary, markers, ids, parameters_);
  if (ids.empty()) return no_result("no marker of the board is seen");
  if (const auto wrong = mistake_in_markers(markers, ids, *charuco_, board_)) {
    return no_result(*wrong);
  }
  cv::aruco::interpolateCornersCharuco(markers, ids, grey, charuco_, corners, corner_ids);
  if (to_index(kFewestCorners) > corners.size()) {
    return no_result(fmt::format("only {} corners of the board are seen, of at least {}",
                                 corners.size(), kFewestCorners));
  }
  refine(grey, markers, corners);
  const auto count = static_cast<Eigen::Index>(corners.size());
  View view{name, Eigen::MatrixX2d(count, 2), Eigen::MatrixX2d(count, 2)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const cv::Point2f& seen = corners[to_index(i)];
    const cv::Point3f& on_board = charuco_->chessboardCorners[to_index(corner_ids[to_index(i)])];
    view.image_px.row(i) << seen.x, seen.y;
    view.board_m.row(i) << on_board.x, on_board.y;
  }
  if (on_a_line(view.board_m, board_.square_m)) {
    return no_result("the corners that are seen lie on one line of the board");
  }
  return view;
}

}  // namespace weft::calibration
