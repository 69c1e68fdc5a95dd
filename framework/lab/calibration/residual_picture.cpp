// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/residual_picture.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace weft::calibration {
namespace {

constexpr double kLongerSide_px = 1200.0, kBar_px = 100.0;
constexpr int kStrip_px = 40;
const cv::Scalar kPaper(255, 255, 255), kInk(40, 40, 40), kDot(170, 170, 170), kLine(30, 30, 200);

cv::Point rounded(const Eigen::RowVector2d& place) {
  return {static_cast<int>(std::lround(place.x())), static_cast<int>(std::lround(place.y()))};
}

/// 1, 2 or 5 times a power of ten, not above.
double round_number(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double digits = value / power;
  return power * (digits >= 5.0 ? 5.0 : digits >= 2.0 ? 2.0 : 1.0);
}

}  // namespace

Result<std::string> residual_picture(const Calibration& calibration) {
  const ImageSize& size = calibration.size;
  const double scale = kLongerSide_px / std::max(size.width_px, size.height_px);
  const int width = static_cast<int>(std::lround(scale * size.width_px));
  const int height = static_cast<int>(std::lround(scale * size.height_px));
  cv::Mat picture(height + kStrip_px, width, CV_8UC3, kPaper);
  cv::rectangle(picture, {0, 0}, {width - 1, height - 1}, kDot);
  // The bar is an error of a round number of pixels, of about twice the usual one.
  const double bar_px = round_number(std::max(1e-3, 2.0 * calibration.solution.rms_px));
  const double enlarged = kBar_px / bar_px;
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const Eigen::MatrixX2d& seen = calibration.views[i].image_px;
    const Eigen::MatrixX2d& residual = calibration.solution.errors[i].residual_px;
    for (Eigen::Index c = 0; c < seen.rows(); ++c) {
      const Eigen::RowVector2d from = scale * (seen.row(c).array() + 0.5).matrix();
      const Eigen::RowVector2d to = from - enlarged * residual.row(c);
      cv::circle(picture, rounded(from), 2, kDot, cv::FILLED, cv::LINE_AA);
      cv::line(picture, rounded(from), rounded(to), kLine, 1, cv::LINE_AA);
    }
  }
  cv::rectangle(picture, {0, height, width, kStrip_px}, kPaper, cv::FILLED);
  const int y = height + kStrip_px / 2;
  cv::line(picture, {20, y}, {20 + static_cast<int>(kBar_px), y}, kLine, 2, cv::LINE_AA);
  cv::putText(picture,
              fmt::format("{:g} px   rms {:.3f} px, {} views", bar_px, calibration.solution.rms_px,
                          calibration.views.size()),
              {30 + static_cast<int>(kBar_px), y + 5}, cv::FONT_HERSHEY_SIMPLEX, 0.5, kInk, 1,
              cv::LINE_AA);
  std::vector<std::uint8_t> bytes;
  try {
    if (cv::imencode(".png", picture, bytes)) return std::string(bytes.begin(), bytes.end());
  } catch (const cv::Exception&) {  // reported below
  }
  return Error{Errc::unsupported, "the image of the residuals cannot be encoded as PNG", {}};
}

}  // namespace weft::calibration
