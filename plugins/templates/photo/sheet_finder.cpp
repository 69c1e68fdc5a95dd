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
constexpr double kBeyond = 0.15;  // share of the photograph, which a lens may show beyond the ideal
                                  // image

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

/// The requirements of find_sheet() for the sides of a surface.
struct Demands {
  double least_side, least_mean;  ///< [] share of a side, and mean over them, that is an edge
  int fewest_corners;             ///< a hand or a weight may hold one down
  bool in_runs;                   ///< true if edges count in runs only
  double beside_px;               ///< how far corners may be outside of the photograph
  Reach reach;                    ///< paper that is held is not quite straight
};

Demands demands_of(Missing missing) {
  if (missing == Missing::little) return {0.5, 0.65, 3, false, 1.0, {3.0, 1.0}};
  return {0.25, 0.6, 2, true, 15.0, {6.0, 2.5}};
}

/// The merit of a quadrilateral; nothing where its sides are no edges.
std::optional<double> merit_of_fit(const FittedSides& fitted, const Eigen::Vector2d& whole_px,
                                   const Demands& demands, std::optional<std::size_t> border) {
  constexpr double kAtCorner = 0.5;
  constexpr double kGoesOn = 0.6, kForGoingOn = 0.1, kForACorner = 0.15;
  constexpr int kByChance = 3;  // ends that seem to go on where the table has a grain
  if (!check_corners(fitted.corners_px)) return std::nullopt;
  double least = 1.0, sum = 0.0;
  int corners = 0, going_on = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const SideEvidence &side = fitted.sides[k], &last = fitted.sides[(k + 3) % 4];
    if (!is_within(fitted.corners_px[k], whole_px, demands.beside_px)) return std::nullopt;
    const bool ends = border == (k + 3) % 4 || last.at_end >= kAtCorner;
    const bool begins = border == k || side.at_start >= kAtCorner;
    corners += ends && begins ? 1 : 0;
    if (border == k) {
      // The sides beside it go on to the border, or they are not cut off by it.
      const SideEvidence& next = fitted.sides[(k + 1) % 4];
      if (last.at_end < kAtCorner || next.at_start < kAtCorner) return std::nullopt;
      continue;
    }
    const double seen = demands.in_runs ? side.in_runs : side.whole;
    least = std::min(least, seen);
    sum += seen;
    going_on += (side.before >= kGoesOn ? 1 : 0) + (side.beyond >= kGoesOn ? 1 : 0);
  }
  const double mean = sum / (border ? 3.0 : 4.0);
  if (least < demands.least_side || mean < demands.least_mean || corners < demands.fewest_corners) {
    return std::nullopt;
  }
  return signed_area_px2(fitted.corners_px) * mean *
         (1.0 - kForGoingOn * std::max(0, going_on - kByChance)) *
         (1.0 - kForACorner * (4 - corners));
}

/// True if a surface may end at the border of the photograph there. A camera like that of the
/// photograph must see its corners, in ideal px, as a rectangle, and its sides must meet the border
/// steeply.
bool may_end_at(std::size_t border, const Corners& corners_px, const Photograph& photo) {
  constexpr double kMostSkew_rad = 3.0 * M_PI / 180.0, kSteep = 0.98;  // sine of 80 degrees
  const Eigen::Vector2d &from = corners_px[border], &to = corners_px[(border + 1) % 4];
  const Eigen::Vector2d along = (to - from).normalized();
  const auto is_steep = [&](const Eigen::Vector2d& side) {
    return std::abs(cross(along, side.normalized())) >= kSteep;
  };
  if (!is_steep(corners_px[(border + 3) % 4] - from) ||
      !is_steep(corners_px[(border + 2) % 4] - to)) {
    return false;
  }
  Pinhole pinhole = photo.pinhole();
  if (!photo.is_calibrated) {
    pinhole.fx = pinhole.fy = guess_focal_length(corners_px, pinhole).focal_px;
  }
  return std::abs(view_of_sheet(corners_px, pinhole).skew_rad) <= kMostSkew_rad;
}

Corners ideal_corners(const SmallView& view, const Corners& small_px) {
  Corners corners_px;
  std::transform(small_px.begin(), small_px.end(), corners_px.begin(),
                 [&](const Eigen::Vector2d& at_px) { return view.ideal_px(at_px); });
  return corners_px;
}

/// In px of the view. Lines from `first_border` on are the borders of the photograph.
std::optional<FoundSheet> best_sheet(const Photograph& photo, const SmallView& view,
                                     const std::vector<Quadrilateral>& candidates, Missing missing,
                                     std::size_t first_border) {
  constexpr double kLeastOfPhoto = 0.25;
  const Demands demands = demands_of(missing);
  const Colours colours = [&](const Eigen::Vector2d& at_px) { return colour_at(view.lab, at_px); };
  const double least_px2 =
      missing == Missing::little ? 0.0 : kLeastOfPhoto * view.whole_px().prod();
  std::optional<FoundSheet> best;
  double most = 0.0;
  for (const Quadrilateral& each : candidates) {
    std::optional<std::size_t> border;
    for (std::size_t k = 0; k < 4; ++k) {
      if (each.lines[k] >= first_border) border = k;
    }
    const FittedSides fitted = fit_sides(colours, each.corners_px, demands.reach, border);
    const auto merit = merit_of_fit(fitted, view.whole_px(), demands, border);
    if (!merit || *merit <= most || signed_area_px2(fitted.corners_px) < least_px2) continue;
    if (missing == Missing::one_side &&
        !may_end_at(*border, ideal_corners(view, fitted.corners_px), photo)) {
      continue;
    }
    most = *merit;
    best = FoundSheet{fitted.corners_px, border};
  }
  return best;
}

/// True if a rectangle seems to continue beyond the photograph: one or two of its sides are
/// borders.
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
          "no object is found: no four straight edges make a rectangle" + hint +
              ": show all four corners on a background that differs from the object's border, or "
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

Result<FoundSheet> find_sheet(const Photograph& photo, Missing missing) {
  constexpr std::size_t kMostLines = 96, kMostCandidates = 60;
  constexpr double kFinalReach_px = 2.5;
  const SmallView view = small_view(photo);
  const std::vector<StraightLine> lines = straight_lines(view.lab, view.seen, kMostLines);
  std::vector<StraightLine> sides = lines;
  if (missing == Missing::one_side) {
    for (const StraightLine& border : borders_of(view.whole_px())) sides.push_back(border);
  }
  const Demands demands = demands_of(missing);
  Needed needed{demands.least_side, demands.fewest_corners, demands.beside_px};
  if (missing == Missing::one_side) needed.one_side_from = lines.size();
  const auto candidates = find_quadrilaterals(sides, view.whole_px(), kMostCandidates, needed);
  const auto small = best_sheet(photo, view, candidates, missing, lines.size());
  if (!small) return no_sheet(view, lines);
  FoundSheet found = *small;
  found.corners_px = ideal_corners(view, small->corners_px);
  ask_to_go_on();
  const cv::Mat lab = lab_of(photo.pixels);
  const Colours colours = [&](const Eigen::Vector2d& at_px) {
    return colour_at(lab, photo.seen_at(at_px));
  };
  const double first_reach_px = 1.5 / view.scale.minCoeff() + 1.5;
  for (const double reach_px : {first_reach_px, kFinalReach_px}) {
    const FittedSides fitted = fit_sides(colours, found.corners_px,
                                         {reach_px, demands.reach.on_line_px}, found.border_side);
    if (check_corners(fitted.corners_px)) found.corners_px = fitted.corners_px;
  }
  const Corners as_read = upright(found.corners_px);
  if (found.border_side) {
    const Eigen::Vector2d start_px = found.corners_px[*found.border_side];
    const auto at = std::find(as_read.begin(), as_read.end(), start_px);
    found.border_side = static_cast<std::size_t>(at - as_read.begin());
  }
  found.corners_px = as_read;
  return found;
}

}  // namespace weft::photo
