// SPDX-License-Identifier: Apache-2.0
#include "grid_nodes.hpp"

#include <limits>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

namespace weft::shards {

Result<GridNodes::Places> GridNodes::at(const GroundTruth& truth) {
  if (auto located = locate(truth); !located) return located.error();
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const auto points_m = truth.points_m.matrix<3>();
  Places places;
  for (const FaceLocation& location : locations_) {
    if (location.face < 0) {
      places.points_m.insert(places.points_m.end(), 3, kNone);
      places.visible.push_back(0);
      continue;
    }
    Eigen::RowVector3d point_m = Eigen::RowVector3d::Zero();
    bool is_visible = truth.visible.present();
    for (int k = 0; k < 3; ++k) {
      const std::int32_t corner = faces_(location.face, k);
      point_m += location.weights[k] * points_m.row(corner);
      is_visible = is_visible && truth.visible(corner) != 0;
    }
    for (int k = 0; k < 3; ++k) places.points_m.push_back(static_cast<float>(point_m[k]));
    places.visible.push_back(is_visible ? 1 : 0);
  }
  return places;
}

Result<void> GridNodes::locate(const GroundTruth& truth) {
  if (!truth.faces.present()) {
    return no_result(
        "the truth has no faces: take a source that gives its surface, such as "
        "sources/frex_samples");
  }
  const Points2 xy_m = truth.template_xy_m.matrix<2>();
  const Faces faces = truth.faces.matrix<3>();
  const bool is_same = xy_m.rows() == points_xy_m_.rows() && faces.rows() == faces_.rows() &&
                       xy_m == points_xy_m_ && faces == faces_;
  if (is_same && !locations_.empty()) return {};
  const auto locator = FaceLocator::create(xy_m, faces);
  if (!locator) {
    return Error{Errc::invalid_data, "the faces of the truth: " + locator.error().message};
  }
  points_xy_m_ = xy_m;
  faces_ = faces;
  locations_.clear();
  for (Eigen::Index n = 0; n < nodes_m_.rows(); ++n) {
    locations_.push_back(locator->locate(nodes_m_.row(n).transpose()));
  }
  return {};
}

}  // namespace weft::shards
