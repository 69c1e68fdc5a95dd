// SPDX-License-Identifier: Apache-2.0
#include "side_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>
#include <weft/core/stop_check.hpp>

namespace weft::photo {
namespace {

constexpr double kMostPlaces = 200.0;  // along a side
constexpr double kOutside = 0.1;       // share of its length, beyond each of its ends
constexpr double kCorner = 0.02;       // share of its length, where two sides blur into one another
constexpr double kEnd = 0.12;          // share of its length, next to a corner
// Paper on a table that looks like it differs by some 6 levels; the noise of means is below 2.
constexpr double kLeastContrast = 4.0;

/// One side: places on it are measured along it from its first corner, and outwards.
struct Side {
  Eigen::Vector2d from, direction, outwards;
  double length_px = 0.0;

  Side(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
      : from(a), direction((b - a).normalized()), length_px((b - a).norm()) {
    outwards = {direction.y(), -direction.x()};
  }
  Eigen::Vector2d at(double along_px, double outwards_px) const {
    return from + along_px * direction + outwards_px * outwards;
  }
};

/// The steepest change across a side at one place along it.
struct EdgePoint {
  double along_px = 0.0, outwards_px = 0.0;
  double contrast = 0.0;  ///< difference of the colours on both sides of it
};

/// outwards_px = offset_px + slope (along_px - half of the side).
struct FittedLine {
  double offset_px = 0.0, slope = 0.0;

  double at(const Side& side, double along_px) const {
    return offset_px + slope * (along_px - 0.5 * side.length_px);
  }
};

/// Mean of five places along the side, at distances of a pixel: noise shrinks, and the edge does
/// not move.
Eigen::Vector3d smooth_colour(const Colours& colours, const Side& side, double along_px,
                              double outwards_px) {
  constexpr int kBeside = 2;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = -kBeside; i <= kBeside; ++i) sum += colours(side.at(along_px + i, outwards_px));
  return sum / (2 * kBeside + 1);
}

EdgePoint find_edge(const Colours& colours, const Side& side, double along_px, int reach_px) {
  // colour[i] is at i - reach - 3 px; contrast[i], of two px outside against two inside, at
  // i - reach - 1 px.
  std::vector<Eigen::Vector3d> colour;
  for (int i = -reach_px - 3; i <= reach_px + 3; ++i) {
    colour.push_back(smooth_colour(colours, side, along_px, i));
  }
  std::vector<double> contrast;
  for (std::size_t i = 2; i + 2 < colour.size(); ++i) {
    contrast.push_back(0.5 *
                       (colour[i + 1] + colour[i + 2] - colour[i - 1] - colour[i - 2]).norm());
  }
  const auto peak = std::max_element(contrast.begin() + 1, contrast.end() - 1);
  const double before = *(peak - 1), after = *(peak + 1);
  const double bend = before - 2.0 * *peak + after;
  const double shift = bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
  const auto place = static_cast<double>(peak - contrast.begin()) - reach_px - 1.0;
  return {along_px, place + shift, *peak};
}

bool is_inside(const EdgePoint& edge, const Side& side) {
  return edge.along_px >= kCorner * side.length_px &&
         edge.along_px <= (1.0 - kCorner) * side.length_px;
}

/// Iterated weighted least squares, from the side as it is, with a scale that narrows.
FittedLine fitted_line(const std::vector<EdgePoint>& edges, const Side& side, const Reach& reach) {
  constexpr int kRounds = 15;
  constexpr double kNarrowing = 0.7;
  const double least_scale_px = 0.4 * reach.on_line_px;
  constexpr double kFewest = 8.0;  // places that agree
  FittedLine line;
  double scale_px = std::max(0.5 * reach.search_px, least_scale_px);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double agreeing = 0.0;
    for (const EdgePoint& edge : edges) {
      if (edge.contrast < kLeastContrast || !is_inside(edge, side)) continue;
      const double off = (edge.outwards_px - line.at(side, edge.along_px)) / scale_px;
      const double weight = std::pow(1.0 + off * off, -2.0);
      const Eigen::Vector2d by(1.0, edge.along_px - 0.5 * side.length_px);
      normal += weight * by * by.transpose();
      right += weight * edge.outwards_px * by;
      agreeing += weight;
    }
    if (agreeing < kFewest) return line;
    const double determinant = normal.determinant();
    if (!(determinant > 1e-9 * normal(0, 0) * normal(1, 1))) return line;
    line.offset_px = (normal(1, 1) * right[0] - normal(0, 1) * right[1]) / determinant;
    line.slope = (normal(0, 0) * right[1] - normal(0, 1) * right[0]) / determinant;
    scale_px = std::max(kNarrowing * scale_px, least_scale_px);
  }
  return line;
}

/// A fitted line, and how near it an edge is on it.
struct Band {
  FittedLine line;
  double reach_px;

  bool holds(const EdgePoint& edge, const Side& side) const {
    const double off_px = edge.outwards_px - line.at(side, edge.along_px);
    return edge.contrast >= kLeastContrast && std::abs(off_px) <= reach_px;
  }
};

/// Share of the edges between two places along the side that are on the line.
double share_on_line(const std::vector<EdgePoint>& edges, const Side& side, const Band& band,
                     double from_px, double to_px) {
  int all = 0, on_line = 0;
  for (const EdgePoint& edge : edges) {
    if (edge.along_px < from_px || edge.along_px > to_px) continue;
    ++all;
    if (band.holds(edge, side)) ++on_line;
  }
  return all > 0 ? static_cast<double>(on_line) / all : 0.0;
}

/// Share of the side in long runs of edges on the line. A gap of one place ends no run.
double share_in_runs(const std::vector<EdgePoint>& edges, const Side& side, const Band& band) {
  constexpr double kShortest = 1.0 / 12.0;  // share of the side
  double sum_px = 0.0, begin_px = 0.0, end_px = -1.0;
  int missing = 2;  // places in a row; at 2 no run is open
  const auto close = [&] {
    if (end_px - begin_px >= kShortest * side.length_px) sum_px += end_px - begin_px;
  };
  for (const EdgePoint& edge : edges) {
    if (!is_inside(edge, side)) continue;
    if (band.holds(edge, side)) {
      if (missing > 1) begin_px = edge.along_px;
      end_px = edge.along_px;
      missing = 0;
    } else if (++missing == 2) {
      close();
    }
  }
  if (missing < 2) close();
  return sum_px / ((1.0 - 2.0 * kCorner) * side.length_px);
}

SideEvidence evidence_of(const std::vector<EdgePoint>& edges, const Side& side, const Band& band) {
  const auto share = [&](double from, double to) {
    return share_on_line(edges, side, band, from * side.length_px, to * side.length_px);
  };
  return {share(kCorner, 1.0 - kCorner),        share(kCorner, kEnd),
          share(1.0 - kEnd, 1.0 - kCorner),     share(-kOutside, -kCorner),
          share(1.0 + kCorner, 1.0 + kOutside), share_in_runs(edges, side, band)};
}

Eigen::Vector2d crossing_of(const std::array<Eigen::Vector2d, 2>& a,
                            const std::array<Eigen::Vector2d, 2>& b) {
  const Eigen::Vector2d along_a = a[1] - a[0], along_b = b[1] - b[0], between = b[0] - a[0];
  return a[0] + cross(between, along_b) / cross(along_a, along_b) * along_a;
}

}  // namespace

Eigen::Vector3d colour_at(const cv::Mat& picture, const Eigen::Vector2d& place_px) {
  const double x = std::clamp(place_px.x(), 0.0, picture.cols - 1.0);
  const double y = std::clamp(place_px.y(), 0.0, picture.rows - 1.0);
  const int i = std::min(static_cast<int>(x), picture.cols - 2);
  const int j = std::min(static_cast<int>(y), picture.rows - 2);
  const double s = x - i, t = y - j;
  const auto* above = picture.ptr<cv::Vec3b>(j) + i;
  const auto* below = picture.ptr<cv::Vec3b>(j + 1) + i;
  Eigen::Vector3d colour;
  for (int c = 0; c < 3; ++c) {
    colour[c] = (1.0 - t) * ((1.0 - s) * above[0][c] + s * above[1][c]) +
                t * ((1.0 - s) * below[0][c] + s * below[1][c]);
  }
  return colour;
}

FittedSides fit_sides(const Colours& colours, const Corners& corners_px, const Reach& reach,
                      std::optional<std::size_t> fixed) {
  const int search_px = static_cast<int>(std::ceil(reach.search_px));
  FittedSides fitted;
  std::array<std::array<Eigen::Vector2d, 2>, 4> lines;
  for (std::size_t k = 0; k < 4; ++k) {
    const Side side(corners_px[k], corners_px[(k + 1) % 4]);
    if (k == fixed) {
      lines[k] = {corners_px[k], corners_px[(k + 1) % 4]};
      continue;
    }
    const double step_px = std::max(1.0, side.length_px / kMostPlaces);
    std::vector<EdgePoint> edges;
    const int steps = static_cast<int>((1.0 + 2.0 * kOutside) * side.length_px / step_px);
    for (int i = 0; i <= steps; ++i) {
      worked(200 * (2 * std::int64_t{search_px} + 7));
      edges.push_back(find_edge(colours, side, i * step_px - kOutside * side.length_px, search_px));
    }
    const FittedLine line = fitted_line(edges, side, reach);
    fitted.sides[k] = evidence_of(edges, side, {line, reach.on_line_px});
    lines[k] = {side.at(0.0, line.at(side, 0.0)),
                side.at(side.length_px, line.at(side, side.length_px))};
  }
  for (std::size_t k = 0; k < 4; ++k)
    fitted.corners_px[k] = crossing_of(lines[(k + 3) % 4], lines[k]);
  return fitted;
}

}  // namespace weft::photo
