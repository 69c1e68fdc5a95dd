// SPDX-License-Identifier: Apache-2.0
#include "drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace weft::overlay {
namespace {

constexpr int kShift = 4;            // positions are given to OpenCV in 1/16 px
constexpr double kFarAway_px = 1e6;  // beyond this the fixed-point numbers of OpenCV overflow
constexpr double kHaloOpacity = 0.25;
constexpr double kUnseenOpacity = 0.5;  // relative to the others
constexpr double kDash_px = 6.0;        // drawn, and as much left out

bool drawable(const cv::Point2d& p) {
  return std::abs(p.x) < kFarAway_px && std::abs(p.y) < kFarAway_px;  // false for NaN
}

cv::Point fixed_point(const cv::Point2d& p) {
  constexpr double kScale = 1 << kShift;
  return {static_cast<int>(std::lround(p.x * kScale)), static_cast<int>(std::lround(p.y * kScale))};
}

struct Segment {
  cv::Point2d from, to;
  bool border;
};

/// Appends the dashes of a segment: one at either end, and gaps as long as they are. They are thin,
/// as their round ends eat into the gaps.
void add_dashes(const Segment& segment, std::vector<Segment>& dashes) {
  constexpr double kMost = 1000.0;  // of segments that leave the picture
  const cv::Point2d way = segment.to - segment.from;
  const double wanted = std::clamp(std::hypot(way.x, way.y) / kDash_px, 1.0, kMost);
  const int pieces = 2 * static_cast<int>(0.5 * wanted) + 1;
  for (int piece = 0; piece < pieces; piece += 2) {
    dashes.push_back({segment.from + way * (static_cast<double>(piece) / pieces),
                      segment.from + way * (static_cast<double>(piece + 1) / pieces), false});
  }
}

/// Lays `draw(layer)` over the canvas.
template <class Draw>
void blend(cv::Mat& canvas, double opacity, Draw&& draw) {
  cv::Mat layer = canvas.clone();
  draw(layer);
  cv::addWeighted(layer, opacity, canvas, 1.0 - opacity, 0.0, canvas);
}

void draw_segments(cv::Mat& canvas, const std::vector<Segment>& segments, const cv::Scalar& colour,
                   double opacity, int width_px) {
  if (segments.empty()) return;
  blend(canvas, opacity, [&](cv::Mat& layer) {
    for (const Segment& segment : segments) {
      cv::line(layer, fixed_point(segment.from), fixed_point(segment.to), colour,
               width_px + (segment.border ? 1 : 0), cv::LINE_AA, kShift);
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

MeshStyle style_of(ShapeState state, int line_width_px) {
  switch (state) {
    case ShapeState::estimated:
      return {{96, 222, 64}, 0.9, line_width_px};
    case ShapeState::weak:
      return {{32, 176, 255}, 0.9, line_width_px};
    case ShapeState::predicted:
      return {{64, 64, 240}, 0.6, line_width_px};
    case ShapeState::none:
    case ShapeState::lost:
      break;
  }
  return {{64, 64, 240}, 0.3, line_width_px};
}

void draw_mesh(cv::Mat& canvas, const Points2View& vertices_px, const FacesView& faces,
               const MeshTopology& topology, std::span<const std::uint8_t> visible,
               const MeshStyle& style) {
  std::vector<Segment> seen, unseen;
  const auto is_unseen = [&](Eigen::Index e) {
    if (!visible.empty()) {
      return visible[static_cast<std::size_t>(topology.edges(e, 0))] == 0 &&
             visible[static_cast<std::size_t>(topology.edges(e, 1))] == 0;
    }
    const std::int32_t one = topology.edge_faces(e, 0), other = topology.edge_faces(e, 1);
    return turns_away(vertices_px, faces, one) &&
           (other < 0 || turns_away(vertices_px, faces, other));
  };
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    const auto point = [&](int end) {
      const auto row = vertices_px.row(topology.edges(e, end));
      return cv::Point2d(row.x(), row.y());
    };
    const Segment segment{point(0), point(1), topology.edge_faces(e, 1) < 0};
    if (!drawable(segment.from) || !drawable(segment.to)) continue;
    if (is_unseen(e)) {
      add_dashes(segment, unseen);
    } else {
      seen.push_back(segment);
    }
  }
  draw_segments(canvas, unseen, style.colour, style.opacity * kUnseenOpacity, style.line_width_px);
  draw_segments(canvas, seen, {0, 0, 0}, style.opacity * kHaloOpacity, style.line_width_px + 2);
  draw_segments(canvas, seen, style.colour, style.opacity, style.line_width_px);
}

void draw_points(cv::Mat& canvas, const std::vector<cv::Point2d>& points_px) {
  constexpr double kOpacity = 0.75, kRadius_px = 1.4;
  constexpr int kCorners = 12;  // cv::circle draws circles as small as these as diamonds
  const cv::Scalar colour(255, 196, 64);
  blend(canvas, kOpacity, [&](cv::Mat& layer) {
    std::array<cv::Point, kCorners> corners;
    for (const cv::Point2d& point : points_px) {
      if (!drawable(point)) continue;
      for (int k = 0; k < kCorners; ++k) {
        const double angle_rad = k * 2.0 * CV_PI / kCorners;
        corners[static_cast<std::size_t>(k)] =
            fixed_point(point + kRadius_px * cv::Point2d(std::cos(angle_rad), std::sin(angle_rad)));
      }
      cv::fillConvexPoly(layer, corners.data(), kCorners, colour, cv::LINE_AA, kShift);
    }
  });
}

void draw_caption(cv::Mat& canvas, const std::string& text, const cv::Scalar& colour) {
  constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
  const double scale = std::clamp(canvas.rows / 1000.0, 0.3, 2.0);
  const int thickness = scale < 1.0 ? 1 : 2;
  int below_baseline = 0;
  const cv::Size size = cv::getTextSize(text, kFont, scale, thickness, &below_baseline);
  const int margin = size.height / 2 + 1;
  const cv::Rect band(0, canvas.rows - size.height - below_baseline - 2 * margin,
                      size.width + 3 * margin, size.height + below_baseline + 2 * margin);
  const cv::Rect visible = band & cv::Rect({}, canvas.size());
  if (visible.empty()) return;
  constexpr double kBandBrightness = 0.35;
  cv::Mat region = canvas(visible);
  region.convertTo(region, -1, kBandBrightness);
  const cv::Point baseline(margin + margin / 2, canvas.rows - margin - below_baseline);
  cv::putText(canvas, text, baseline, kFont, scale, colour, thickness, cv::LINE_AA);
}

}  // namespace weft::overlay
