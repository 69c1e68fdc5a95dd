// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/types.hpp>
#include <weft/truth/moving_least_squares.hpp>

namespace weft {

/// True position of a template point.
struct TruePlace {
  Eigen::Vector3d point_m;  ///< [3] m, camera frame
  bool hidden = false;      ///< true if the camera sees no corner of its face
};

/// The truth of one frame at any template point: barycentric interpolation on the faces of the true
/// surface, if there are any. Otherwise moving least squares between the true points; then no point
/// is marked as hidden.
class TruthMap {
 public:
  /// Copies the data. Fails with invalid_data if the faces are not a valid mesh over the points.
  static Result<TruthMap> create(const GroundTruth& truth) {
    TruthMap map(truth);
    if (!truth.faces.present()) return map;
    map.faces_ = truth.faces.matrix<3>();
    auto locator = FaceLocator::create(map.points_.xy_m(), map.faces_);
    if (!locator) {
      return Error{Errc::invalid_data, "the faces of the truth: " + locator.error().message};
    }
    map.locator_ = *std::move(locator);
    return map;
  }

  /// The true position of the point with template_xy_m = `xy_m`, in m. Nothing beside the surface,
  /// or if true points without a surface do not surround it.
  std::optional<TruePlace> at(const Eigen::Vector2d& xy_m) const {
    if (!locator_) {
      const auto point_m = points_.at(xy_m);
      return point_m ? std::optional(TruePlace{*point_m}) : std::nullopt;
    }
    const FaceLocation location = locator_->locate(xy_m);
    if (location.face < 0) return std::nullopt;
    return TruePlace{interpolate(points_.points_m(), faces_, location.face, location.weights),
                     hidden(location.face)};
  }

  /// Leave-one-out error of the true points in px: the median over about 100 of them. NaN if it
  /// cannot be computed, and for a surface, which needs no interpolation.
  double leave_one_out_px(const Pinhole& camera) const {
    constexpr Eigen::Index kPredicted = 100;
    if (locator_) return std::numeric_limits<double>::quiet_NaN();
    const Eigen::Index count = points_.xy_m().rows();
    const Eigen::Index step = std::max<Eigen::Index>(1, count / kPredicted);
    std::vector<double> errors_px;
    for (Eigen::Index i = 0; i < count; i += step) {
      const auto predicted_m = points_.at(points_.xy_m().row(i), i);
      if (!predicted_m) continue;
      const Eigen::Vector3d true_m = points_.points_m().row(i);
      errors_px.push_back((project(camera, *predicted_m) - project(camera, true_m)).norm());
    }
    return median(errors_px);
  }

  /// True images of the source's matches [N,2] px; NaN where unknown; empty without matches.
  const Points2& match_xy_px() const { return match_xy_px_; }

  /// Labels of the source's matches [N]: 1 inlier, 0 outlier, else unknown; may be empty.
  const std::vector<std::int8_t>& match_labels() const { return match_labels_; }

 private:
  explicit TruthMap(const GroundTruth& truth)
      : points_(truth.template_xy_m.matrix<2>(), truth.points_m.matrix<3>()),
        visible_(truth.visible.data(), truth.visible.data() + truth.visible.rows()) {
    if (truth.match_xy_px.present()) match_xy_px_ = truth.match_xy_px.matrix<2>();
    for (std::int64_t n = 0; n < truth.match_label.rows(); ++n) {
      match_labels_.push_back(truth.match_label(n));
    }
  }

  bool hidden(std::int32_t face) const {
    if (visible_.empty()) return false;
    for (int k = 0; k < 3; ++k) {
      if (visible_[to_index(faces_(face, k))] != 0) return false;
    }
    return true;
  }

  MovingLeastSquares points_;
  Faces faces_;
  std::vector<std::uint8_t> visible_;  ///< [T] 1 where visible, or empty
  std::optional<FaceLocator> locator_;
  Points2 match_xy_px_;
  std::vector<std::int8_t> match_labels_;
};

}  // namespace weft
