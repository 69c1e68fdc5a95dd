// SPDX-License-Identifier: Apache-2.0
#include "drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "fixed_point.hpp"
#include "palette.hpp"

namespace weft::overlay {
namespace {

constexpr double kFarAway_px = 1e6;  // beyond this the fixed-point numbers of OpenCV overflow
// Relative to the border.
constexpr double kHaloOpacity = 0.4, kInnerOpacity = 0.55, kUnseenOpacity = 0.45;
constexpr double kDash_px = 6.0;  // lengths of a dash and of a gap

bool drawable(const cv::Point2d& p) {
  return std::abs(p.x) < kFarAway_px && std::abs(p.y) < kFarAway_px;  // false for NaN
}

/// Appends the dashes of a segment: one at either end, and gaps as long as they are. They are thin,
/// as their round ends eat into the gaps.
void add_dashes(const cv::Point2d& from, const cv::Point2d& to, std::vector<cv::Point2d>& dashes) {
  constexpr double kMost = 1000.0;  // largest number of pieces, for segments that leave the image
  const cv::Point2d way = to - from;
  const double wanted = std::clamp(std::hypot(way.x, way.y) / kDash_px, 1.0, kMost);
  const int pieces = 2 * static_cast<int>(0.5 * wanted) + 1;
  for (int piece = 0; piece < pieces; piece += 2) {
    dashes.push_back(from + way * (static_cast<double>(piece) / pieces));
    dashes.push_back(from + way * (static_cast<double>(piece + 1) / pieces));
  }
}

/// Calls `draw(layer, origin)` with a copy of the part of the canvas that is less than `margin_px`
/// from a point, and lays it over the canvas.
template <class Draw>
void blend(cv::Mat& canvas, std::span<const cv::Point2d> points, int margin_px, double opacity,
           Draw&& draw) {
  cv::Rect box;
  const cv::Point margin(margin_px, margin_px);
  for (const cv::Point2d& point : points) {
    const cv::Point at(cvFloor(point.x), cvFloor(point.y));
    box |= cv::Rect(at - margin, at + margin);
  }
  box &= cv::Rect({}, canvas.size());
  if (box.empty()) return;
  cv::Mat below = canvas(box), layer = below.clone();
  draw(layer, cv::Point2d(box.tl()));
  cv::addWeighted(layer, opacity, below, 1.0 - opacity, 0.0, below);
}

/// `ends` has two points for each segment.
void draw_segments(cv::Mat& canvas, const std::vector<cv::Point2d>& ends, const cv::Scalar& colour,
                   double opacity, int width_px) {
  blend(canvas, ends, width_px + 3, opacity, [&](cv::Mat& layer, const cv::Point2d& origin) {
    for (std::size_t k = 0; k < ends.size(); k += 2) {
      cv::line(layer, fixed_point(ends[k] - origin), fixed_point(ends[k + 1] - origin), colour,
               width_px, cv::LINE_AA, kShift);
    }
  });
}

/// Faces are counter-clockwise as the camera sees their front; v grows downwards.
bool turns_away(const Points2View& px, const FacesView& faces, std::int32_t face) {
  const Eigen::RowVector2d origin = px.row(faces(face, 0));
  const Eigen::RowVector2d a = px.row(faces(face, 1)) - origin;
  const Eigen::RowVector2d b = px.row(faces(face, 2)) - origin;
  return a.x() * b.y() - a.y() * b.x() > 0.0;
}

}  // namespace

MeshStyle style_of(const Shape& shape, int line_width_px) {
  const cv::Scalar colour = colour_of_confidence(shape.confidence);
  switch (shape.shape_state()) {
    case ShapeState::estimated:
    case ShapeState::weak:
      return {colour, 1.0, line_width_px};
    case ShapeState::predicted:
      return {colour, 0.7, line_width_px};
    case ShapeState::none:
    case ShapeState::lost:
      break;
  }
  return {colour, 0.4, line_width_px};
}

std::vector<std::uint8_t> drawn_edges(const Points3View& rest_m, const MeshTopology& topology) {
  constexpr double kTolerance = 1e-3;  // share of the edge
  std::vector<std::uint8_t> drawn(to_index(topology.edges.rows()), 1);
  Eigen::Index pair = 0;  // they follow the edges that have two faces
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    worked_in_loop(e, 3);
    if (topology.edge_faces(e, 1) < 0) continue;
    const Eigen::RowVector3d a = rest_m.row(topology.edges(e, 0));
    const Eigen::RowVector3d b = rest_m.row(topology.edges(e, 1));
    const Eigen::RowVector3d c = rest_m.row(topology.bending_pairs(pair, 0));
    const Eigen::RowVector3d d = rest_m.row(topology.bending_pairs(pair, 1));
    ++pair;
    // The diagonals of a rectangle halve each other and are equally long.
    const double length_m = (a - b).norm();
    const bool halves = (a + b - c - d).norm() < kTolerance * length_m &&
                        std::abs(length_m - (c - d).norm()) < kTolerance * length_m;
    drawn[to_index(e)] = halves ? 0 : 1;
  }
  return drawn;
}

void draw_mesh(cv::Mat& canvas, const Points2View& vertices_px, const FacesView& faces,
               const MeshTopology& topology, const std::vector<std::uint8_t>& drawn,
               std::span<const std::uint8_t> visible, const MeshStyle& style) {
  std::vector<cv::Point2d> inner, border, unseen;
  const auto is_unseen = [&](Eigen::Index e) {
    if (!visible.empty()) {
      return visible[to_index(topology.edges(e, 0))] == 0 &&
             visible[to_index(topology.edges(e, 1))] == 0;
    }
    const std::int32_t one = topology.edge_faces(e, 0), other = topology.edge_faces(e, 1);
    return turns_away(vertices_px, faces, one) &&
           (other < 0 || turns_away(vertices_px, faces, other));
  };
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    worked_in_loop(e, 30);
    const auto point = [&](int end) {
      const auto row = vertices_px.row(topology.edges(e, end));
      return cv::Point2d(row.x(), row.y());
    };
    const cv::Point2d from = point(0), to = point(1);
    if (drawn[to_index(e)] == 0) continue;
    if (!drawable(from) || !drawable(to)) continue;
    if (is_unseen(e)) {
      add_dashes(from, to, unseen);
    } else {
      auto& ends = topology.edge_faces(e, 1) < 0 ? border : inner;
      ends.insert(ends.end(), {from, to});
    }
  }
  const int width_px = style.line_width_px;
  const auto draw = [&](const std::vector<cv::Point2d>& ends, const cv::Scalar& colour,
                        double opacity, int more_px) {
    draw_segments(canvas, ends, colour, style.opacity * opacity, width_px + more_px);
  };
  draw(unseen, style.colour, kUnseenOpacity, 0);
  draw(inner, style.colour, kInnerOpacity, 0);
  draw(border, kPaper, kHaloOpacity, 2);
  draw(border, style.colour, 1.0, 0);
}

void draw_points(cv::Mat& canvas, const std::vector<cv::Point2d>& points_px) {
  constexpr double kOpacity = 0.6, kRadius_px = 1.1;
  constexpr int kCorners = 12;  // cv::circle draws circles as small as these as diamonds
  const cv::Scalar colour(255, 196, 64);
  std::vector<cv::Point2d> points;
  std::copy_if(points_px.begin(), points_px.end(), std::back_inserter(points), drawable);
  blend(canvas, points, 4, kOpacity, [&](cv::Mat& layer, const cv::Point2d& origin) {
    std::array<cv::Point, kCorners> corners;
    for (const cv::Point2d& point : points) {
      for (int k = 0; k < kCorners; ++k) {
        const double angle_rad = k * 2.0 * CV_PI / kCorners;
        corners[to_index(k)] = fixed_point(
            point - origin + kRadius_px * cv::Point2d(std::cos(angle_rad), std::sin(angle_rad)));
      }
      cv::fillConvexPoly(layer, corners.data(), kCorners, colour, cv::LINE_AA, kShift);
    }
  });
}

}  // namespace weft::overlay
