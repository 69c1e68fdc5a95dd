// SPDX-License-Identifier: Apache-2.0
#include "text.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace weft::overlay {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kStrokeScale = 4;       // letters are strokes: rendered larger, they become smooth
constexpr double kCapital_px = 21.0;  // height of a capital of this font at scale 1

/// The parameters of the text before it is made smaller.
struct Strokes {
  double scale;
  int thickness;
  cv::Size size;
  int below;  ///< [] px below the base line
};

Strokes strokes_of(const std::string& text, double capital_px, bool is_bold) {
  Strokes strokes{};
  strokes.scale = kStrokeScale * capital_px / kCapital_px;
  const double share = is_bold ? 0.18 : 0.13;  // share of the height of a capital
  strokes.thickness = std::max(1, static_cast<int>(std::lround(share * kStrokeScale * capital_px)));
  strokes.size = cv::getTextSize(text, kFont, strokes.scale, strokes.thickness, &strokes.below);
  strokes.below += strokes.thickness;
  return strokes;
}

double width_px(const Strokes& strokes) {
  return static_cast<double>(strokes.size.width) / kStrokeScale;
}

Strokes fitting(const std::string& text, const TextStyle& style) {
  const Strokes wanted = strokes_of(text, style.capital_px, style.is_bold);
  if (width_px(wanted) <= style.most_px) return wanted;
  return strokes_of(text, style.capital_px * std::max(style.most_px, 1.0) / width_px(wanted),
                    style.is_bold);
}

}  // namespace

double text_width_px(const std::string& text, const TextStyle& style) {
  return std::min(width_px(fitting(text, style)), style.most_px);
}

void draw_text(cv::Mat& canvas, const std::string& text, cv::Point2d base, Anchor anchor,
               const TextStyle& style) {
  if (text.empty()) return;
  const Strokes strokes = fitting(text, style);
  if (anchor == Anchor::centre) base.x -= 0.5 * width_px(strokes);
  if (anchor == Anchor::right) base.x -= width_px(strokes);
  // The box of the text on the canvas, a pixel larger on all sides.
  const int above = strokes.size.height + strokes.thickness;
  const cv::Rect box(cvFloor(base.x) - 1, cvFloor(base.y) - above / kStrokeScale - 2,
                     strokes.size.width / kStrokeScale + 4,
                     (above + strokes.below) / kStrokeScale + 4);
  const cv::Rect seen = box & cv::Rect({}, canvas.size());
  if (seen.empty()) return;
  cv::Mat fine(box.size() * kStrokeScale, CV_8U, cv::Scalar(0)), ink;
  const cv::Point origin(cvRound((base.x - box.x) * kStrokeScale),
                         cvRound((base.y - box.y) * kStrokeScale));
  cv::putText(fine, text, origin, kFont, strokes.scale, {255}, strokes.thickness, cv::LINE_AA);
  cv::resize(fine, ink, box.size(), 0, 0, cv::INTER_AREA);
  cv::Mat region = canvas(seen);
  const cv::Mat share = ink(seen - box.tl());
  for (int y = 0; y < region.rows; ++y) {
    for (int x = 0; x < region.cols; ++x) {
      const double opacity = share.at<std::uint8_t>(y, x) / 255.0;
      auto& pixel = region.at<cv::Vec3b>(y, x);
      for (int k = 0; k < 3; ++k) {
        pixel[k] =
            cv::saturate_cast<std::uint8_t>(pixel[k] + opacity * (style.colour[k] - pixel[k]));
      }
    }
  }
}

}  // namespace weft::overlay
