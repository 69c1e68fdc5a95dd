// SPDX-License-Identifier: Apache-2.0
#include "picture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rigid_alignment.hpp>
#include <weft/geometry/surface_distance.hpp>

namespace weft::drawing {
namespace {

constexpr double kPanel_px = 1600.0, kLeastPanel_px = 700.0;
constexpr double kPaleness = 0.6;
constexpr int kFine = 2;             // panels are rendered this many times larger, and averaged
constexpr int kShift = 4;            // positions are given to OpenCV in 1/16 px
constexpr double kFarAway_px = 1e6;  // beyond this the fixed-point numbers of OpenCV overflow
const cv::Scalar kMeshColour(97, 222, 64), kFaceBorder(51, 115, 26);

/// A position on the panel, whose pixels begin at whole numbers, on the finer one of OpenCV, whose
/// pixels are centred there.
cv::Point fine_point(double x_px, double y_px) {
  const auto fixed = [](double px) {
    return static_cast<int>(std::lround((kFine * px - 0.5) * (1 << kShift)));
  };
  return {fixed(x_px), fixed(y_px)};
}

/// The soft rims of OpenCV's lines make them about a pixel wider than the requested width.
int fine_width(double px) { return std::max(1, static_cast<int>(std::lround(kFine * px)) - 1); }

cv::Mat pale_texture(const Template& templ) {
  const cv::Mat texture = texture_of(templ);
  cv::Mat bgr, pale;
  if (texture.channels() == 1) {
    cv::cvtColor(texture, bgr, cv::COLOR_GRAY2BGR);
  } else {
    texture.copyTo(bgr);
  }
  bgr.convertTo(pale, -1, 1.0 - kPaleness, kPaleness * 255.0);
  const cv::Mat mask(texture.size(), CV_8U, const_cast<std::uint8_t*>(templ.mask.data()),
                     to_index(templ.mask.row_stride()));
  pale.copyTo(bgr, mask == 0);
  return bgr;
}

/// Over a dark halo; the border is wider.
void draw_edges(cv::Mat& fine, const Points2& at_px, const MeshTopology& topology) {
  const auto trace = [&](cv::Mat& canvas, bool border, const cv::Scalar& colour, double width_px) {
    for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
      worked(1000);
      if ((topology.edge_faces(e, 1) < 0) != border) continue;
      const auto a = at_px.row(topology.edges(e, 0)), b = at_px.row(topology.edges(e, 1));
      if (!(a.cwiseAbs().maxCoeff() < kFarAway_px && b.cwiseAbs().maxCoeff() < kFarAway_px)) {
        continue;
      }
      cv::line(canvas, fine_point(a.x(), a.y()), fine_point(b.x(), b.y()), colour,
               fine_width(width_px), cv::LINE_AA, kShift);
    }
  };
  for (const bool border : {false, true}) {
    constexpr double kHaloOpacity = 0.35;
    cv::Mat halo = fine.clone();
    trace(halo, border, cv::Scalar::all(0), border ? 4.5 : 3.0);
    cv::addWeighted(halo, kHaloOpacity, fine, 1.0 - kHaloOpacity, 0.0, fine);
    trace(fine, border, kMeshColour, border ? 2.6 : 1.3);
  }
}

cv::Mat averaged(const cv::Mat& fine, cv::Size size) {
  cv::Mat panel;
  cv::resize(fine, panel, size, 0.0, 0.0, cv::INTER_AREA);
  return panel;
}

cv::Mat texture_panel(const Template& templ, double scale) {
  const cv::Mat texture = pale_texture(templ);
  const cv::Size size(std::max(1, static_cast<int>(scale * texture.cols)),
                      std::max(1, static_cast<int>(scale * texture.rows)));
  cv::Mat panel, fine;
  cv::resize(texture, panel, size, 0.0, 0.0, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  cv::resize(panel, fine, size * kFine, 0.0, 0.0, cv::INTER_NEAREST);
  const Points2 at_px = scale * (templ.flat_px.matrix<2>().array() + 0.5);
  draw_edges(fine, at_px, *build_topology(templ.faces.matrix<3>(), at_px.rows()));
  return averaged(fine, size);
}

/// Mean colour of a face in the texture, at its middle and half-way to its corners.
cv::Scalar face_colour(const cv::Mat& texture, const Points2& flat_px, const Faces& faces,
                       Eigen::Index f) {
  Eigen::RowVector2d middle = Eigen::RowVector2d::Zero();
  for (int k = 0; k < 3; ++k) middle += flat_px.row(faces(f, k)) / 3.0;
  cv::Scalar sum;
  for (int k = 0; k < 4; ++k) {
    const Eigen::RowVector2d at = k == 3 ? middle : 0.5 * (middle + flat_px.row(faces(f, k)));
    const auto within = [](double value, int size) {
      return static_cast<int>(std::clamp<long>(std::lround(value), 0, size - 1));
    };
    const int u = within(at.x(), texture.cols), v = within(at.y(), texture.rows);
    sum += texture.channels() == 1 ? cv::Scalar::all(texture.at<std::uint8_t>(v, u))
                                   : cv::Scalar(texture.at<cv::Vec3b>(v, u));
  }
  return sum / 4.0;
}

/// The object at rest as the camera of its texture sees it, turned so that its depth shows, in
/// units of the panel's size; x right, y down, z away.
Points3 seen_from_above(const Template& templ) {
  const Points3 vertices_m = templ.vertices_m.matrix<3>();
  Points3 flat = Points3::Zero(vertices_m.rows(), 3);
  flat.leftCols<2>() = templ.flat_px.matrix<2>();
  const auto facing = align_points(vertices_m, flat);
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(-0.6, Eigen::Vector3d::UnitY()))
                                   .toRotationMatrix();
  Points3 seen = facing ? transform_points(*facing, vertices_m) : vertices_m;
  seen = (seen * turn.transpose()).eval();
  seen.rowwise() -= 0.5 * (seen.colwise().maxCoeff() + seen.colwise().minCoeff()).eval();
  return seen / (seen.leftCols<2>().colwise().maxCoeff().maxCoeff() * 2.0);
}

void draw_face(cv::Mat& fine, const Points3& seen_px, const Faces& faces, Eigen::Index f,
               cv::Scalar colour) {
  const Eigen::RowVector3d a = seen_px.row(faces(f, 0));
  const Eigen::RowVector3d normal =
      (seen_px.row(faces(f, 1)) - a).cross(seen_px.row(faces(f, 2)) - a).normalized();
  if (normal.z() > 0.0) colour = cv::Scalar::all(209);  // the back is blank
  colour *= 0.55 + 0.45 * std::abs(normal.z());
  std::array<cv::Point, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const auto corner = seen_px.row(faces(f, k));
    corners[to_index(k)] = fine_point(corner.x(), corner.y());
  }
  cv::fillConvexPoly(fine, corners.data(), 3, colour, cv::LINE_AA, kShift);
  for (std::size_t k = 0; k < 3; ++k) {
    cv::line(fine, corners[k], corners[(k + 1) % 3], 0.8 * kFaceBorder + 0.2 * colour,
             fine_width(1.2), cv::LINE_AA, kShift);
  }
}

/// From the furthest face to the nearest.
cv::Mat object_panel(const Template& templ, int size_px) {
  const cv::Mat texture = texture_of(templ);
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  Points3 seen_px = seen_from_above(templ) * (0.9 * size_px);
  seen_px.leftCols<2>().array() += 0.5 * size_px;
  const auto depth = [&](Eigen::Index f) {
    return seen_px(faces(f, 0), 2) + seen_px(faces(f, 1), 2) + seen_px(faces(f, 2), 2);
  };
  std::vector<Eigen::Index> order(to_index(faces.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return depth(a) > depth(b); });
  cv::Mat fine(kFine * size_px, kFine * size_px, CV_8UC3, cv::Scalar::all(255));
  for (const Eigen::Index f : order) {
    worked(3000);
    draw_face(fine, seen_px, faces, f, face_colour(texture, flat_px, faces, f));
  }
  return averaged(fine, {size_px, size_px});
}

}  // namespace

cv::Mat texture_of(const Template& templ) {
  return {static_cast<int>(templ.texture.dim(0)), static_cast<int>(templ.texture.dim(1)),
          templ.texture.ndim() == 2 ? CV_8UC1 : CV_8UC3,
          const_cast<std::uint8_t*>(templ.texture.data()), to_index(templ.texture.row_stride())};
}

cv::Mat draw_mesh(const Template& templ) {
  const auto width = static_cast<double>(templ.texture.dim(1));
  const auto height = static_cast<double>(templ.texture.dim(0));
  const double largest = std::max(width, height);
  const double scale = std::clamp(largest, kLeastPanel_px, kPanel_px) / largest;
  cv::Mat texture = texture_panel(templ, scale);
  if (coplanar(templ.vertices_m.matrix<3>())) return texture;
  const int side_px =
      std::max(texture.rows, static_cast<int>(scale * std::max(height, 0.6 * width)));
  cv::Mat both(side_px, texture.cols + side_px, CV_8UC3, cv::Scalar::all(255));
  texture.copyTo(both(cv::Rect({0, 0}, texture.size())));
  object_panel(templ, side_px).copyTo(both(cv::Rect(texture.cols, 0, side_px, side_px)));
  return both;
}

}  // namespace weft::drawing
