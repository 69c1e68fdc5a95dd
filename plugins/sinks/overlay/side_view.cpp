// SPDX-License-Identifier: Apache-2.0
#include "side_view.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>

#include "floor.hpp"
#include "palette.hpp"
#include "text.hpp"

namespace weft::overlay {
namespace {

constexpr int kMostFine_px = 2200;   // panels up to half of this size are anti-aliased
constexpr double kMargin = 0.94;     // share of the radius: a bent surface does not fill the ball
constexpr double kBackPallor = 0.8;  // how blank the back of the surface is
constexpr double kUnmeasuredPallor = 0.62;
constexpr double kHaze = 0.22;   // how far the far side fades
constexpr double kBlank = 0.93;  // paper is a little darker than what is behind it

cv::Mat bgr_texture(const Template& templ) {
  const Array<std::uint8_t>& texels = templ.texture;
  const cv::Size size(static_cast<int>(texels.dim(1)), static_cast<int>(texels.dim(0)));
  const cv::Mat given(size, texels.ndim() == 2 ? CV_8UC1 : CV_8UC3,
                      const_cast<std::uint8_t*>(texels.data()), to_index(texels.row_stride()));
  cv::Mat texture;
  if (texels.ndim() == 2) {
    cv::cvtColor(given, texture, cv::COLOR_GRAY2BGR);
  } else {
    texture = given.clone();
  }
  return texture;
}

/// For each side of a face, true if it becomes a line.
std::vector<std::array<bool, 3>> sides_of(const FacesView& faces, const MeshTopology& topology,
                                          const std::vector<std::uint8_t>& drawn) {
  std::vector<std::array<bool, 3>> sides(to_index(faces.rows()), {false});
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    worked_in_loop(e, 3);
    if (drawn[to_index(e)] == 0) continue;
    for (int side = 0; side < 2; ++side) {
      const std::int32_t face = topology.edge_faces(e, side);
      for (int k = 0; face >= 0 && k < 3; ++k) {
        const std::int32_t corner = faces(face, k);
        if (corner != topology.edges(e, 0) && corner != topology.edges(e, 1)) {
          sides[to_index(face)][to_index(k)] = true;
        }
      }
    }
  }
  return sides;
}

/// Normals of the vertices, as long as the faces around them are large.
Points3 normals_of(const Points3View& vertices, const FacesView& faces) {
  Points3 normals = Points3::Zero(vertices.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 10);
    const Eigen::Vector3d origin = vertices.row(faces(f, 0));
    const Eigen::Vector3d a = vertices.row(faces(f, 1)), b = vertices.row(faces(f, 2));
    const Eigen::RowVector3d normal = (a - origin).cross(b - origin);
    if (!normal.allFinite()) continue;
    for (int k = 0; k < 3; ++k) normals.row(faces(f, k)) += normal;
  }
  return normals;
}

/// The light on a matt surface from a lamp behind the viewer and from all around.
double light_on(const Eigen::Vector3d& normal) {
  static const Eigen::Vector3d to_lamp = Eigen::Vector3d(-0.5, -0.62, -0.6).normalized();
  constexpr double kAmbient = 0.6;
  const double length = normal.norm();
  if (!(length > 0.0)) return 1.0;
  const double towards = normal.dot(to_lamp) / length * (normal.z() > 0.0 ? -1.0 : 1.0);
  return std::min(1.08, kAmbient + 0.58 * std::max(0.0, towards));
}

}  // namespace

SideView::SideView(const Template& templ, const MeshTopology& topology,
                   const std::vector<std::uint8_t>& drawn, cv::Size size, int turn_frames)
    : faces_(templ.faces.matrix<3>()),
      sides_(sides_of(faces_, topology, drawn)),
      turn_frames_(turn_frames) {
  finer_ = 2 * std::max(size.width, size.height) <= kMostFine_px ? 2 : 1;
  const cv::Size fine_size = size * finer_;
  const Points3 rest = templ.vertices_m.matrix<3>();
  if (rest.rows() == 0) return;
  const Eigen::RowVector3d middle = rest.colwise().mean();
  radius_m_ = std::max(1e-6, kMargin * (rest.rowwise() - middle).rowwise().norm().maxCoeff());
  grid_m_ = floor_step_m(radius_m_);
  cv::Mat texture = bgr_texture(templ);
  uv_px_ = templ.flat_px.matrix<2>();
  // One texel for a pixel: more would flicker.
  const double texel_m =
      mean_edge_length(rest, topology.edges) / mean_edge_length(uv_px_, topology.edges);
  const double shrink = Orbit(middle, radius_m_, fine_size, 0, 0).scale() * texel_m;
  if (shrink < 1.0) {
    const cv::Size smaller(std::max(1, cvRound(shrink * texture.cols)),
                           std::max(1, cvRound(shrink * texture.rows)));
    const Eigen::RowVector2d factor(static_cast<double>(smaller.width) / texture.cols,
                                    static_cast<double>(smaller.height) / texture.rows);
    cv::resize(texture, texture, smaller, 0, 0, cv::INTER_AREA);
    uv_px_ = ((uv_px_.array() + 0.5).rowwise() * factor.array() - 0.5).matrix();
  }
  paint_ = Paint(texture, kBlank * kPaper, std::max(1.0, fine_size.height / 480.0));
}

Eigen::Vector3d SideView::middle_of(const Points3View& vertices_m) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    worked_in_loop(v);
    if (!vertices_m.row(v).allFinite()) continue;
    sum += vertices_m.row(v);
    count += 1.0;
  }
  return count > 0.0 ? Eigen::Vector3d(sum / count) : sum;
}

void SideView::draw_ground(cv::Mat& panel, const Points3View& vertices_m,
                           std::uint64_t frame) const {
  const Eigen::Vector3d middle_m = middle_of(vertices_m);
  double below_m = 0.3 * radius_m_;
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    below_m = std::max(below_m, vertices_m(v, 1) - middle_m.y());
  }
  const double floor_m = middle_m.y() + std::min(below_m, radius_m_) + 0.06 * radius_m_;
  panel.setTo(kPaper);
  const Orbit orbit(middle_m, radius_m_, panel.size(), frame, turn_frames_);
  draw_floor(panel, orbit, floor_m, radius_m_, grid_m_);
  if (vertices_m.rows() > 0) draw_shadow(panel, orbit, floor_m, vertices_m, faces_);
}

std::vector<Corner> SideView::corners_of(const Orbit& orbit, const Points3& moved_m,
                                         const std::vector<double>& measured) const {
  const Points3 normals = normals_of(moved_m, faces_);
  const double nearest_m = orbit.distance_m() - radius_m_;
  std::vector<Corner> corners;
  corners.reserve(to_index(moved_m.rows()));
  for (Eigen::Index v = 0; v < moved_m.rows(); ++v) {
    worked_in_loop(v, 10);
    const Eigen::Vector3d point_m = moved_m.row(v);
    const double depth = std::clamp((point_m.z() - nearest_m) / (2.0 * radius_m_), 0.0, 1.0);
    const double unmeasured = 1.0 - measured[to_index(v)];
    corners.push_back({orbit.project(point_m),
                       1.0 / point_m.z(),
                       {uv_px_(v, 0), uv_px_(v, 1)},
                       light_on(normals.row(v)),
                       1.0 - (1.0 - kHaze * depth) * (1.0 - kUnmeasuredPallor * unmeasured)});
  }
  return corners;
}

void SideView::draw_mesh(const Orbit& orbit, const Points3View& vertices_m,
                         const std::vector<double>& measured) {
  Points3 moved_m(vertices_m.rows(), 3);
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    moved_m.row(v) = orbit.moved(vertices_m.row(v)).transpose();
  }
  const std::vector<Corner> corners = corners_of(orbit, moved_m, measured);
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    worked_in_loop(f, 20);
    std::array<Corner, 3> three;
    bool drawable = true;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = faces_(f, k);
      three[to_index(k)] = corners[to_index(v)];
      drawable = drawable && moved_m.row(v).allFinite() && moved_m(v, 2) > 0.1 * radius_m_;
    }
    if (!drawable) continue;
    const cv::Point2d a = three[1].at_px - three[0].at_px, b = three[2].at_px - three[0].at_px;
    const bool is_back = a.x * b.y - a.y * b.x > 0.0;
    for (Corner& corner : three) {
      if (is_back) corner.pallor = 1.0 - (1.0 - corner.pallor) * (1.0 - kBackPallor);
    }
    raster_.draw(three, sides_[to_index(f)], paint_);
  }
}

void SideView::draw(cv::Mat panel, const Points3View& vertices_m, double confidence,
                    const std::vector<double>& measured, std::uint64_t frame) {
  draw_ground(panel, vertices_m, frame);
  const cv::Size fine_size = panel.size() * finer_;
  const Orbit orbit(middle_of(vertices_m), radius_m_, fine_size, frame, turn_frames_);
  paint_.line_colour = colour_of_confidence(confidence);
  raster_.clear(fine_size);
  draw_mesh(orbit, vertices_m, measured);
  finer_ == 2 ? raster_.lay_over<2>(panel) : raster_.lay_over<1>(panel);
  const bool is_pale = std::find(measured.begin(), measured.end(), 0.0) != measured.end();
  label(panel, is_pale ? "pale: not seen or not measured" : "");
}

void SideView::draw_nothing(cv::Mat panel, const std::string& why, std::uint64_t frame) const {
  draw_ground(panel, Points3(0, 3), frame);
  draw_text(panel, why, {0.5 * panel.cols, 0.45 * panel.rows}, Anchor::centre,
            {0.026 * panel.rows, kFaintInk, false, 0.9 * panel.cols});
  label(panel, "");
}

void SideView::label(cv::Mat& panel, const std::string& pale) const {
  const double capital_px = 0.021 * std::min(panel.rows, panel.cols);
  const double margin_px = 1.6 * capital_px, base_px = panel.rows - margin_px;
  const TextStyle style{capital_px, kFaintInk, false, 0.45 * panel.cols};
  draw_text(panel, "grid " + length_text(grid_m_), {margin_px, base_px}, Anchor::left, style);
  TextStyle right = style;
  right.most_px = 0.6 * panel.cols;
  draw_text(panel, pale, {panel.cols - margin_px, base_px}, Anchor::right, right);
}

}  // namespace weft::overlay
