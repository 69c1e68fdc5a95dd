// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/board_recognition.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "lab/calibration/charuco.hpp"

namespace weft::calibration {
namespace {

constexpr std::size_t kFewestMarkers = 6;
constexpr double kMostOff = 0.25;         // squares: a lens moves markers by less
constexpr double kMostOtherShare = 0.06;  // fraction of the side of a square

cv::Point2f middle_of(const std::vector<cv::Point2f>& corners) {
  return 0.25F * (corners[0] + corners[1] + corners[2] + corners[3]);
}

/// As if it were a square of the same diagonals.
double side_of(const std::vector<cv::Point2f>& corners) {
  return 0.5 * (cv::norm(corners[0] - corners[2]) + cv::norm(corners[1] - corners[3])) /
         std::sqrt(2.0);
}

/// Place of a marker's middle on the board, in squares; nothing where the board has no such marker.
std::optional<cv::Point2f> place_of(int id, const cv::aruco::CharucoBoard& charuco) {
  const auto found = std::find(charuco.ids.begin(), charuco.ids.end(), id);
  if (found == charuco.ids.end()) return std::nullopt;
  const auto& corners = charuco.objPoints[to_index(found - charuco.ids.begin())];
  const cv::Point3f middle = 0.5F * (corners[0] + corners[2]);
  return cv::Point2f(middle.x, middle.y) / charuco.getSquareLength();
}

/// The markers that the board has, taken back from the image to the board, in squares.
struct OnBoard {
  Markers corners;
  std::vector<cv::Point2f> places;  ///< where the board has their middles
};

/// Computed with the homography of the markers' centres; nothing if too few are visible, or all on
/// one line.
std::optional<OnBoard> taken_back(const Markers& markers, const std::vector<int>& ids,
                                  const cv::aruco::CharucoBoard& charuco) {
  OnBoard board;
  std::vector<cv::Point2f> middles_px;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto place = place_of(ids[i], charuco);
    if (!place) continue;
    middles_px.push_back(middle_of(markers[i]));
    board.places.push_back(*place);
    board.corners.push_back(markers[i]);
  }
  if (board.places.size() < kFewestMarkers) return std::nullopt;
  const cv::Mat board_from_image = cv::findHomography(middles_px, board.places, cv::LMEDS);
  if (board_from_image.empty()) return std::nullopt;
  for (auto& corners : board.corners) cv::perspectiveTransform(corners, corners, board_from_image);
  return board;
}

/// The share that markers have of the side of their squares. It is measured on the board, since a
/// view from the side shortens markers and their distances differently.
std::optional<double> marker_share(const Markers& markers, const std::vector<int>& ids,
                                   const cv::aruco::CharucoBoard& charuco) {
  const auto board = taken_back(markers, ids, charuco);
  if (!board) return std::nullopt;
  std::vector<double> shares;
  for (const auto& corners : board->corners) shares.push_back(side_of(corners));
  return median(shares);
}

struct Recognized {
  std::string what, advice;
  std::size_t size = 0;  ///< markers, corners or circles
};

Recognized recognized(const std::string& what, const Board& board, std::size_t size) {
  return {what, "give " + options_of(board), size};
}

/// The ChArUco board whose layout fits markers of a dictionary.
std::optional<Board> charuco_board_of(const Markers& markers, const std::vector<int>& ids,
                                      Board board) {
  const int largest = *std::max_element(ids.begin(), ids.end());
  double least = kMostOff;
  std::optional<Board> best;
  for (board.columns = 3; board.columns <= 22; ++board.columns) {
    const int fewest = std::max(3, 2 * (largest + 1) / board.columns);
    for (board.rows = fewest; board.rows <= std::min(22, fewest + 1); ++board.rows) {
      const int count = board.columns * board.rows / 2;
      if (count <= largest || count > find_dictionary(board.dictionary)->markers) continue;
      const auto error = layout_error(markers, ids, *make_charuco(board));
      if (!error || *error > least - 1e-6) continue;
      least = *error;
      best = board;
    }
  }
  if (!best) return best;
  const auto share = marker_share(markers, ids, *make_charuco(*best));
  if (share && std::abs(*share - best->marker_share) > kMostOtherShare) {
    best->marker_share = 0.01 * std::round(100.0 * *share);
  }
  return best;
}

/// The smallest dictionary of this kind of marker that has a marker of this number; the declared
/// one where it does.
std::string dictionary_with(const Dictionary& largest, int id, const Board& declared) {
  const std::string kind = largest.name.substr(0, largest.name.find('_') + 1);
  const Dictionary* const usual = find_dictionary(declared.dictionary);
  if (kind.find('x') != kind.npos) {
    if (usual->name.starts_with(kind) && id < usual->markers) return usual->name;
    for (const Dictionary& each : dictionaries()) {
      if (each.name.starts_with(kind) && id < each.markers) return each.name;
    }
  }
  return largest.name;
}

std::optional<Recognized> recognize_markers(const cv::Mat& grey, const Board& declared) {
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->minMarkerPerimeterRate = 0.02;
  std::optional<Recognized> best;
  for (const Dictionary& dictionary : dictionaries()) {
    const bool largest =
        dictionary.name.find('x') == std::string::npos || dictionary.markers == 1000;
    if (!largest) continue;
    Markers markers;
    std::vector<int> ids;
    cv::aruco::detectMarkers(grey, cv::aruco::getPredefinedDictionary(dictionary.number), markers,
                             ids, parameters);
    if (ids.size() < kFewestMarkers || (best && best->size >= ids.size())) continue;
    Board board = declared;
    board.pattern = Pattern::charuco;
    board.marker_share = kMarkerShare;
    board.dictionary =
        dictionary_with(dictionary, *std::max_element(ids.begin(), ids.end()), declared);
    const auto fitting = charuco_board_of(markers, ids, board);
    best = fitting ? recognized(fmt::format("a ChArUco board of {} x {} squares with markers of "
                                            "the dictionary {}",
                                            fitting->columns, fitting->rows, board.dictionary),
                                *fitting, ids.size())
                   : Recognized{"markers of the dictionary " + board.dictionary +
                                    " that are not on a chessboard",
                                "print a board with `weft calibrate board`", ids.size()};
  }
  return best;
}

constexpr double kLeastCircularity = 0.83;  // a square has 0.785
constexpr std::size_t kFewestCircles = 9;

std::vector<cv::KeyPoint> circles_in(const cv::Mat& grey) {
  std::vector<cv::KeyPoint> circles;
  circle_detector(grey, kLeastCircularity)->detect(grey, circles);
  return circles;
}

std::optional<Recognized> recognize_chessboard(const cv::Mat& grey, const Board& declared) {
  std::vector<cv::Point2f> corners;
  cv::Mat found;
  const bool seen = cv::findChessboardCornersSB(
      grey, {3, 3}, corners, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER, found);
  if (!seen || found.cols < 2 || found.rows < 2) return std::nullopt;
  // The gaps of a grid of circles pass for corners.
  if (circles_in(grey).size() >= kFewestCircles) return std::nullopt;
  Board board = declared;
  board.pattern = Pattern::chessboard;
  board.dictionary = Board().dictionary;
  board.marker_share = kMarkerShare;
  board.columns = std::max(found.cols, found.rows) + 1;
  board.rows = std::min(found.cols, found.rows) + 1;
  return recognized(fmt::format("a chessboard without markers of {} x {} squares ({} x {} inner "
                                "corners)",
                                board.columns, board.rows, board.columns - 1, board.rows - 1),
                    board, corners.size());
}

std::optional<Recognized> recognize_circles(const cv::Mat& grey, const Board& declared) {
  const std::size_t circles = circles_in(grey).size();
  if (circles < kFewestCircles || circles > 500) return std::nullopt;
  const auto count = static_cast<int>(circles);
  const auto detector = circle_detector(grey, kLeastCircularity);
  Board board = declared;
  board.dictionary = Board().dictionary;
  board.marker_share = kMarkerShare;
  for (int columns = 3; 3 * columns <= count; ++columns) {
    if (count % columns != 0) continue;
    for (const Pattern pattern : {Pattern::asymmetric_circles, Pattern::circles}) {
      const bool asymmetric = pattern == Pattern::asymmetric_circles;
      std::vector<cv::Point2f> centres;
      const bool found = cv::findCirclesGrid(
          grey, {columns, count / columns}, centres,
          asymmetric ? cv::CALIB_CB_ASYMMETRIC_GRID : cv::CALIB_CB_SYMMETRIC_GRID, detector);
      if (!found) continue;
      board.pattern = pattern;
      board.columns = columns;
      board.rows = count / columns;
      return recognized(
          fmt::format("{} grid of {} x {} circles", asymmetric ? "an asymmetric" : "a symmetric",
                      board.columns, board.rows),
          board, centres.size());
    }
  }
  return std::nullopt;
}

std::optional<Recognized> recognize(const cv::Mat& image, const Board& declared) {
  constexpr double kLongest_px = 1600.0;
  const double scale = std::min(1.0, kLongest_px / std::max(image.cols, image.rows));
  cv::Mat grey = image, mirrored;
  if (scale < 1.0) cv::resize(image, grey, {}, scale, scale, cv::INTER_AREA);
  if (auto found = recognize_markers(grey, declared)) return found;
  cv::flip(grey, mirrored, 1);
  if (auto found = recognize_markers(mirrored, declared)) {
    found->what = "the mirror image of " + found->what;
    found->advice = "take images that are not mirrored (a setting of many programs for webcams)";
    return found;
  }
  if (auto found = recognize_circles(grey, declared)) return found;
  return recognize_chessboard(grey, declared);
}

}  // namespace

cv::Ptr<cv::FeatureDetector> circle_detector(const cv::Mat& grey, double least_circularity) {
  cv::SimpleBlobDetector::Params parameters;
  parameters.filterByCircularity = least_circularity > 0.0;
  parameters.minCircularity = static_cast<float>(least_circularity);
  parameters.minArea = 20.0F;
  parameters.maxArea = static_cast<float>(grey.total()) / 20.0F;
  parameters.minDistBetweenBlobs = 5.0F;
  return cv::SimpleBlobDetector::create(parameters);
}

std::optional<double> layout_error(const Markers& markers, const std::vector<int>& ids,
                                   const cv::aruco::CharucoBoard& charuco) {
  const auto board = taken_back(markers, ids, charuco);
  if (!board) return std::nullopt;
  std::vector<double> errors;
  for (std::size_t i = 0; i < board->places.size(); ++i) {
    errors.push_back(cv::norm(middle_of(board->corners[i]) - board->places[i]));
  }
  // LMEDS fits half of the points: the others show that the layout is another one.
  std::sort(errors.begin(), errors.end());
  return errors[errors.size() * 3 / 4];
}

std::optional<std::string> mistake_in_markers(const Markers& markers, const std::vector<int>& ids,
                                              const cv::aruco::CharucoBoard& charuco,
                                              const Board& board) {
  const auto error = layout_error(markers, ids, charuco);
  if (!error) return std::nullopt;
  if (*error > kMostOff) {
    return fmt::format("the markers are not where a board of {}x{} squares has them", board.columns,
                       board.rows);
  }
  const auto share = marker_share(markers, ids, charuco);
  if (!share || std::abs(*share - board.marker_share) <= kMostOtherShare) return std::nullopt;
  return fmt::format("the markers have {:.2f} of the side of their squares, not {:.2f}", *share,
                     board.marker_share);
}

std::optional<std::string> other_board(const Board& declared, const std::vector<cv::Mat>& images) {
  std::optional<Recognized> best;
  for (const cv::Mat& image : images) {
    auto found = recognize(image, declared);
    if (found && (!best || found->size > best->size)) best = std::move(found);
  }
  if (!best || best->advice == "give " + options_of(declared)) return std::nullopt;
  return fmt::format("the images show {}, not the board of {}: {}", best->what,
                     options_of(declared), best->advice);
}

}  // namespace weft::calibration
