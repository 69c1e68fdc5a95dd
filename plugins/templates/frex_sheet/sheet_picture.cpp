// SPDX-License-Identifier: Apache-2.0
#include "sheet_picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <string>

namespace weft::frex_sheet {
namespace {

constexpr int kBorderModules = 1;

/// Makes the rectangle from (x0,y0) to (x1,y1) px black, its sides in proportion to what they
/// cover.
void blacken(cv::Mat1f& white, double x0, double y0, double x1, double y1) {
  const int last_row = std::min(white.rows, static_cast<int>(std::ceil(y1)));
  const int last_column = std::min(white.cols, static_cast<int>(std::ceil(x1)));
  for (int row = std::max(0, static_cast<int>(y0)); row < last_row; ++row) {
    const double height = std::min(y1, row + 1.0) - std::max(y0, row + 0.0);
    for (int column = std::max(0, static_cast<int>(x0)); column < last_column; ++column) {
      const double width = std::min(x1, column + 1.0) - std::max(x0, column + 0.0);
      white(row, column) -= static_cast<float>(width * height);
    }
  }
}

}  // namespace

Result<cv::Mat> draw_sheet(const MarkerSheet& sheet, int px_per_mm) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(
      sheet.dictionary == "4x4_250" ? cv::aruco::DICT_4X4_250 : cv::aruco::DICT_5X5_250);
  const int modules = dictionary->markerSize + 2 * kBorderModules;
  cv::Mat1f white(static_cast<int>(std::lround(sheet.height_mm * px_per_mm)),
                  static_cast<int>(std::lround(sheet.width_mm * px_per_mm)), 1.0F);
  for (const SheetMarker& marker : sheet.markers) {
    if (marker.id >= dictionary->bytesList.rows) {
      return Error{Errc::invalid_value, "the dictionary " + sheet.dictionary + " has only " +
                                            std::to_string(dictionary->bytesList.rows) +
                                            " markers: lower 'count'"};
    }
    cv::Mat1b bits;
    dictionary->drawMarker(marker.id, modules, bits, kBorderModules);
    const Eigen::Vector2d corner = marker.corners_mm.row(0) * px_per_mm;
    const double module = (marker.corners_mm(1, 0) - marker.corners_mm(0, 0)) * px_per_mm / modules;
    for (int j = 0; j < modules; ++j) {
      for (int i = 0; i < modules; ++i) {
        if (bits(j, i) != 0) continue;
        blacken(white, corner.x() + i * module, corner.y() + j * module,
                corner.x() + (i + 1) * module, corner.y() + (j + 1) * module);
      }
    }
  }
  cv::Mat picture;
  white.convertTo(picture, CV_8U, 255.0);
  return picture;
}

}  // namespace weft::frex_sheet
