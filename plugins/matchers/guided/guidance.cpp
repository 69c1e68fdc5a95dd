// SPDX-License-Identifier: Apache-2.0
#include "guidance.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::guided {
namespace {

/// Matches are compared with those in the same part, with this many parts along each side of the
/// template.
constexpr int kParts = 4;

int part_of(double value, double low, double high) {
  if (!(high > low)) return 0;
  return std::clamp(static_cast<int>(kParts * (value - low) / (high - low)), 0, kParts - 1);
}

}  // namespace

Fallback fallback_before(const MatcherInput& in, double least_confidence) {
  const bool complete = in.previous_shape && in.previous_correspondences && in.templ && in.camera &&
                        in.previous_shape->vertices_m.rows() == in.templ->vertices_m.rows() &&
                        in.template_keypoints && in.template_keypoints->face.present() &&
                        in.template_keypoints->barycentrics.present();
  if (!complete) return Fallback::no_previous_shape;
  if (in.previous_shape->shape_state() != ShapeState::estimated) return Fallback::not_estimated;
  return in.previous_shape->confidence >= least_confidence ? Fallback::none : Fallback::doubtful;
}

std::vector<Eigen::Vector2d> predicted_places(const Keypoints& template_keypoints,
                                              const Template& templ, const Camera& camera,
                                              const Shape& previous) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const auto faces = templ.faces.matrix<3>();
  const auto vertices_m = previous.vertices_m.matrix<3>();
  const auto weights = template_keypoints.barycentrics.matrix<3>();
  std::vector<Eigen::Vector2d> places;
  places.reserve(to_index(template_keypoints.count()));
  for (std::int64_t i = 0; i < template_keypoints.count(); ++i) {
    const std::int32_t face = template_keypoints.face(i);
    Eigen::Vector2d place = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    if (face >= 0 && face < faces.rows()) {
      Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        point_m += weights(i, k) * vertices_m.row(faces(face, k)).transpose();
      }
      place = project(pinhole, point_m);
    }
    places.push_back(place);
  }
  return places;
}

int agreeing_matches(const Correspondences& matches,
                     const std::vector<Eigen::Vector2d>& predicted_px, double radius_px) {
  const auto count = matches.count();
  if (count == 0) return 0;
  const auto template_px = matches.template_px.matrix<2>();
  const Eigen::Vector2d low = template_px.colwise().minCoeff();
  const Eigen::Vector2d high = template_px.colwise().maxCoeff();
  struct Part {
    std::vector<double> x, y;
    Eigen::Vector2d median = Eigen::Vector2d::Zero();
  };
  std::array<Part, kParts * kParts> parts;
  const auto part = [&](std::int64_t n) -> Part& {
    return parts[to_index(kParts * part_of(template_px(n, 1), low.y(), high.y()) +
                          part_of(template_px(n, 0), low.x(), high.x()))];
  };
  const auto moved = [&](std::int64_t n) -> Eigen::Vector2d {
    return matches.image_px.matrix<2>().row(n).transpose() -
           predicted_px[to_index(matches.template_keypoint(n))];
  };
  for (std::int64_t n = 0; n < count; ++n) {
    const Eigen::Vector2d motion = moved(n);
    part(n).x.push_back(motion.x());
    part(n).y.push_back(motion.y());
  }
  for (Part& each : parts) {
    if (!each.x.empty()) each.median = {median(each.x), median(each.y)};
  }
  int agreeing = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    // One match always agrees with itself, and with one other it proves nothing.
    constexpr std::size_t kFewest = 3;
    const bool agrees =
        part(n).x.size() >= kFewest && (moved(n) - part(n).median).norm() <= 0.25 * radius_px;
    agreeing += agrees ? 1 : 0;
  }
  return agreeing;
}

int kept_matches(const Correspondences& matches) {
  return static_cast<int>(matches.kept.matrix<1>().template cast<int>().sum());
}

}  // namespace weft::guided
