// SPDX-License-Identifier: Apache-2.0
#include "sheet_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/stop_check.hpp>

#include "quadrilaterals.hpp"
#include "side_fit.hpp"
#include "straight_lines.hpp"

namespace weft::photo {
namespace {

constexpr double kSmall_px = 1000.0;
constexpr double kBeyond = 0.15;  // of the photograph, which a lens may show beyond the ideal image

/// The photograph without distortion, made smaller.
struct SmallView {
  cv::Mat lab;                                     ///< [h,w,3] u8
  cv::Mat seen;                                    ///< [h,w] u8, 255 where the photograph shows it
  Eigen::Array2d scale = Eigen::Array2d::Ones();   ///< [2] of its px per ideal px
  Eigen::Array2d border = Eigen::Array2d::Zero();  ///< [2] px, left of and above the ideal image

  Eigen::Vector2d ideal_px(const Eigen::Vector2d& small_px) const {
    return (small_px.array() - border + 0.5) / scale - 0.5;
  }
  Eigen::Vector2d whole_px() const { return {lab.cols - 1.0, lab.rows - 1.0}; }
};

SmallView small_view(const Photograph& photo) {
  const cv::Size size = photo.pixels.size();
  const double shrink = std::min(1.0, kSmall_px / std::max(size.width, size.height));
  cv::Mat small;
  ask_to_go_on();
  cv::resize(photo.pixels, small, {}, shrink, shrink, cv::INTER_AREA);
  SmallView view;
  view.scale = {static_cast<double>(small.cols) / size.width,
                static_cast<double>(small.rows) / size.height};
  if (photo.camera.model == cameras::Distortion::none) {
    view.lab = lab_of(small);
    view.seen = cv::Mat(small.size(), CV_8U, cv::Scalar(255));
    return view;
  }
  view.border = {std::round(kBeyond * small.cols), std::round(kBeyond * small.rows)};
  const cv::Size with_border(small.cols + 2 * static_cast<int>(view.border.x()),
                             small.rows + 2 * static_cast<int>(view.border.y()));
  cv::Mat map(with_border, CV_32FC2), straight;
  view.seen = cv::Mat(with_border, CV_8U, cv::Scalar(0));
  for (int y = 0; y < map.rows; ++y) {
    worked(10L * map.cols);
    for (int x = 0; x < map.cols; ++x) {
      const Eigen::Vector2d seen = photo.seen_at(view.ideal_px({x, y}));
      const Eigen::Array2d from = (seen.array() + 0.5) * view.scale - 0.5;
      map.at<cv::Vec2f>(y, x) =
          cv::Vec2f(static_cast<float>(from.x()), static_cast<float>(from.y()));
      if (photo.camera.camera.shows(seen.x(), seen.y())) view.seen.at<std::uint8_t>(y, x) = 255;
    }
  }
  cv::remap(small, straight, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  view.lab = lab_of(straight);
  return view;
}

/// How much speaks for a quadrilateral; nothing where its sides are no edges.
std::optional<double> merit_of_fit(const FittedSides& fitted, const Eigen::Vector2d& whole_px) {
  constexpr double kLeastSide = 0.5, kLeastMean = 0.65, kAtCorner = 0.5;
  constexpr double kGoesOn = 0.6, kForGoingOn = 0.1, kForACorner = 0.15;
  constexpr int kByChance = 3;       // ends that seem to go on where the table has a grain
  constexpr int kFewestCorners = 3;  // a hand or a weight may hold one down
  if (!check_corners(fitted.corners_px)) return std::nullopt;
  double least = 1.0, sum = 0.0;
  int corners = 0, going_on = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const SideEvidence &side = fitted.sides[k], &last = fitted.sides[(k + 3) % 4];
    if (!is_within(fitted.corners_px[k], whole_px)) return std::nullopt;
    least = std::min(least, side.whole);
    sum += side.whole;
    corners += last.at_end >= kAtCorner && side.at_start >= kAtCorner ? 1 : 0;
    going_on += (side.before >= kGoesOn ? 1 : 0) + (side.beyond >= kGoesOn ? 1 : 0);
  }
  const double mean = 0.25 * sum;
  if (least < kLeastSide || mean < kLeastMean || corners < kFewestCorners) return std::nullopt;
  return signed_area_px2(fitted.corners_px) * mean *
         (1.0 - kForGoingOn * std::max(0, going_on - kByChance)) *
         (1.0 - kForACorner * (4 - corners));
}

std::optional<Corners> best_sheet(const SmallView& view,
                                  const std::vector<Quadrilateral>& candidates) {
  constexpr double kReach_px = 3.0;
  const Colours colours = [&](const Eigen::Vector2d& at_px) { return colour_at(view.lab, at_px); };
  std::optional<Corners> best;
  double most = 0.0;
  for (const Quadrilateral& each : candidates) {
    const FittedSides fitted = fit_sides(colours, each.corners_px, kReach_px);
    const auto merit = merit_of_fit(fitted, view.whole_px());
    if (!merit || *merit <= most) continue;
    most = *merit;
    best = fitted.corners_px;
  }
  return best;
}

/// Whether a rectangle seems to go on beyond the photograph: one or two of its sides are borders.
bool seems_cut_off(const SmallView& view, std::vector<StraightLine> lines) {
  constexpr std::size_t kMost = 200;
  const std::size_t first_border = lines.size();
  for (const StraightLine& border : borders_of(view.whole_px())) lines.push_back(border);
  const auto found = find_quadrilaterals(lines, view.whole_px(), kMost);
  return std::any_of(found.begin(), found.end(), [&](const Quadrilateral& each) {
    const auto borders = std::count_if(each.lines.begin(), each.lines.end(),
                                       [&](std::size_t line) { return line >= first_border; });
    return borders == 1 || borders == 2;
  });
}

Error no_sheet(const SmallView& view, const std::vector<StraightLine>& lines) {
  const std::string hint =
      seems_cut_off(view, lines) ? " (something like one is cut off by the border)" : "";
  return {Errc::invalid_data,
          "no sheet is found: no four straight edges make a rectangle" + hint +
              ": show all four corners on a background that differs from the sheet's border, or "
              "give 'corners'",
          {}};
}

}  // namespace

Corners upright(const Corners& corners_px) {
  Corners best = corners_px, turned = corners_px;
  double most = -2.0;
  for (int turn = 0; turn < 4; ++turn) {
    const Eigen::Vector2d top = (turned[1] - turned[0]).normalized();
    const Eigen::Vector2d bottom = (turned[2] - turned[3]).normalized();
    if (const double right = top.x() + bottom.x(); right > most + 1e-9) {
      most = right;
      best = turned;
    }
    std::rotate(turned.begin(), turned.begin() + 1, turned.end());
  }
  return best;
}

Result<Corners> find_sheet(const Photograph& photo) {
  constexpr std::size_t kMostLines = 96, kMostCandidates = 60;
  constexpr double kFinalReach_px = 2.5;
  const SmallView view = small_view(photo);
  const std::vector<StraightLine> lines = straight_lines(view.lab, view.seen, kMostLines);
  const auto small = best_sheet(view, find_quadrilaterals(lines, view.whole_px(), kMostCandidates));
  if (!small) return no_sheet(view, lines);
  Corners corners_px;
  std::transform(small->begin(), small->end(), corners_px.begin(),
                 [&](const Eigen::Vector2d& at_px) { return view.ideal_px(at_px); });
  ask_to_go_on();
  const cv::Mat lab = lab_of(photo.pixels);
  const Colours colours = [&](const Eigen::Vector2d& at_px) {
    return colour_at(lab, photo.seen_at(at_px));
  };
  const double first_reach_px = 1.5 / view.scale.minCoeff() + 1.5;
  for (const double reach_px : {first_reach_px, kFinalReach_px}) {
    const FittedSides fitted = fit_sides(colours, corners_px, reach_px);
    if (check_corners(fitted.corners_px)) corners_px = fitted.corners_px;
  }
  return upright(corners_px);
}

}  // namespace weft::photo
