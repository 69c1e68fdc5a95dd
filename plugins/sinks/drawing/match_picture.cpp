// SPDX-License-Identifier: Apache-2.0
#include "match_picture.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/mesh_topology.hpp>

namespace weft::drawing {
namespace {

constexpr int kFraction = 4;        // positions are given to OpenCV in 1/16 px
constexpr double kBeyond_px = 1e6;  // beyond this its fixed-point numbers overflow
constexpr double kPaler = 0.5;
const cv::Scalar kShapeColour(97, 222, 64);  // BGR, as in the other images
const cv::Scalar kSeen(200, 60, 0), kOff(0, 110, 255);

void trace_line(cv::Mat& picture, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                const cv::Scalar& colour) {
  if (!(from.cwiseAbs().maxCoeff() < kBeyond_px && to.cwiseAbs().maxCoeff() < kBeyond_px)) return;
  const auto point = [](const Eigen::Vector2d& at) -> cv::Point {
    return {static_cast<int>(std::lround(at.x() * (1 << kFraction))),
            static_cast<int>(std::lround(at.y() * (1 << kFraction)))};
  };
  cv::line(picture, point(from), point(to), colour, 1, cv::LINE_AA, kFraction);
}

cv::Mat pale_image(const Image& image) {
  const Array<std::uint8_t>& pixels = image.pixels;
  const cv::Mat given(static_cast<int>(pixels.dim(0)), static_cast<int>(pixels.dim(1)),
                      pixels.ndim() == 2 ? CV_8UC1 : CV_8UC3,
                      const_cast<std::uint8_t*>(pixels.data()), to_index(pixels.row_stride()));
  cv::Mat picture;
  given.convertTo(picture, -1, 1.0 - kPaler, kPaler * 255.0);
  if (picture.channels() == 1) cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  return picture;
}

}  // namespace

cv::Mat draw_matches(const SinkInput& in) {
  cv::Mat picture = pale_image(*in.image);
  const Pinhole camera{in.camera->fx, in.camera->fy, in.camera->cx, in.camera->cy};
  const Points3 vertices_m = in.shape->vertices_m.matrix<3>();
  const Faces faces = in.templ->faces.matrix<3>();
  const Points2 seen = project_points(camera, vertices_m);
  if (const auto topology = build_topology(faces, vertices_m.rows())) {
    for (Eigen::Index e = 0; e < topology->edges.rows(); ++e) {
      trace_line(picture, seen.row(topology->edges(e, 0)), seen.row(topology->edges(e, 1)),
                 kShapeColour);
    }
  }
  const Correspondences& matches = *in.correspondences;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (!matches.kept(i)) continue;
    const Eigen::Vector2d at(matches.image_px(i, 0), matches.image_px(i, 1));
    if (matches.face(i) >= 0) {
      const Eigen::Vector3d place_m =
          interpolate(vertices_m, faces, matches.face(i), matches.barycentrics.matrix<3>().row(i));
      trace_line(picture, at, project(camera, place_m), kOff);
    }
    trace_line(picture, at - Eigen::Vector2d(1.5, 0.0), at + Eigen::Vector2d(1.5, 0.0), kSeen);
    trace_line(picture, at - Eigen::Vector2d(0.0, 1.5), at + Eigen::Vector2d(0.0, 1.5), kSeen);
  }
  return picture;
}

}  // namespace weft::drawing
