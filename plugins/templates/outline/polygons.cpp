// SPDX-License-Identifier: Apache-2.0
#include "polygons.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>

namespace weft::outline {
namespace {

using Contour = std::vector<cv::Point2f>;

constexpr int kFiner = 4;  // pixels of the finer mask in one along each side
constexpr double kTolerance_px = 0.2;
// Half, less what a contour through the centres of the outermost fine pixels falls short of it.
constexpr double kLevel = 115.0;
constexpr int kMargin_px = 4;

/// The mask on a finer grid with a smooth border; `corner` is its top left pixel in the mask.
cv::Mat finer(const cv::Mat& mask, cv::Point& corner) {
  const cv::Rect box = cv::boundingRect(mask);
  corner = box.tl() - cv::Point(kMargin_px, kMargin_px);
  cv::Mat padded, large;
  cv::copyMakeBorder(mask(box) * 255, padded, kMargin_px, kMargin_px, kMargin_px, kMargin_px,
                     cv::BORDER_CONSTANT | cv::BORDER_ISOLATED, cv::Scalar(0));
  cv::GaussianBlur(padded, padded, {0, 0}, 1.0);
  cv::resize(padded, large, {}, kFiner, kFiner, cv::INTER_LINEAR);
  cv::threshold(large, large, kLevel, 1.0, cv::THRESH_BINARY);
  return large;
}

Contour simplified(const std::vector<cv::Point>& contour, const cv::Point& corner) {
  Contour points, simple;
  for (const cv::Point& fine : contour) {
    points.emplace_back(static_cast<float>((fine.x + 0.5) / kFiner - 0.5 + corner.x),
                        static_cast<float>((fine.y + 0.5) / kFiner - 0.5 + corner.y));
  }
  cv::approxPolyDP(points, simple, kTolerance_px, true);
  return simple;
}

Polygon to_polygon(const Contour& contour) {
  Polygon polygon;
  for (const cv::Point2f& p : contour) polygon.emplace_back(p.x, p.y);
  return polygon;
}

/// Indices of the corners at which the outline turns sharply, seen at the scale of the spacing.
std::vector<std::size_t> sharp_corners(const Polygon& polygon, double spacing_px) {
  constexpr double kSharp_rad = 0.7;
  Contour all, coarse;
  for (const Eigen::Vector2d& p : polygon) {
    all.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  cv::approxPolyDP(all, coarse, spacing_px / 8.0, true);
  std::vector<std::size_t> sharp;
  const std::size_t n = coarse.size();
  for (std::size_t i = 0; n > 2 && i < n; ++i) {
    const cv::Point2f in = coarse[i] - coarse[(i + n - 1) % n];
    const cv::Point2f out = coarse[(i + 1) % n] - coarse[i];
    if (std::abs(std::atan2(in.cross(out), in.dot(out))) < kSharp_rad) continue;
    const auto at = std::find(all.begin(), all.end(), coarse[i]);
    sharp.push_back(to_index(at - all.begin()));
  }
  std::sort(sharp.begin(), sharp.end());
  return sharp;
}

/// Appends points at equal distances along the arc from corner `first` up to, without, `last`.
void append_piece(const Polygon& polygon, std::size_t first, std::size_t last, double spacing_px,
                  int fewest, Polygon& result) {
  const std::size_t n = polygon.size(), corners = last > first ? last - first : last + n - first;
  std::vector<double> arc_px{0.0};
  for (std::size_t k = 0; k < corners; ++k) {
    const auto side = polygon[(first + k + 1) % n] - polygon[(first + k) % n];
    arc_px.push_back(arc_px.back() + side.norm());
  }
  const int pieces = std::max(fewest, static_cast<int>(std::lround(arc_px.back() / spacing_px)));
  std::size_t k = 0;
  for (int piece = 0; piece < pieces; ++piece) {
    const double at = arc_px.back() * piece / pieces;
    while (arc_px[k + 1] <= at) ++k;
    const double share = (at - arc_px[k]) / (arc_px[k + 1] - arc_px[k]);
    result.emplace_back((1.0 - share) * polygon[(first + k) % n] +
                        share * polygon[(first + k + 1) % n]);
  }
}

Polygon resampled(const Polygon& polygon, double spacing_px) {
  std::vector<std::size_t> stops = sharp_corners(polygon, spacing_px);
  if (stops.empty()) stops.push_back(0);
  const int fewest = stops.size() == 1 ? 3 : stops.size() == 2 ? 2 : 1;
  Polygon result;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    append_piece(polygon, stops[i], stops[(i + 1) % stops.size()], spacing_px, fewest, result);
  }
  return result;
}

}  // namespace

Outline trace_outline(const cv::Mat& mask) {
  Outline outline;
  if (cv::countNonZero(mask) == 0) return outline;
  cv::Point corner;
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> hierarchy;
  cv::findContours(finer(mask, corner), contours, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  std::size_t largest = 0;
  for (std::size_t i = 1; i < contours.size(); ++i) {
    if (cv::contourArea(contours[i]) > cv::contourArea(contours[largest])) largest = i;
  }
  outline.outer = to_polygon(simplified(contours[largest], corner));
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (hierarchy[i][3] != static_cast<int>(largest)) continue;
    const Contour hole = simplified(contours[i], corner);
    if (hole.size() > 2) outline.holes.push_back(to_polygon(hole));
  }
  return outline;
}

Outline resampled(const Outline& outline, double spacing_px) {
  Outline result{resampled(outline.outer, spacing_px), {}};
  for (const Polygon& hole : outline.holes) {
    result.holes.push_back(resampled(hole, spacing_px));
  }
  return result;
}

}  // namespace weft::outline
