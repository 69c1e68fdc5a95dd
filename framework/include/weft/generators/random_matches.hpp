// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <weft/core/rng.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Settings for randomly generated matches, as in Shetab-Bushehri et al. 2023, Section V.
struct RandomMatchesSpec {
  int count = 1000;           ///< [] number of matches
  double correct_rate = 1.0;  ///< [] the first round((1 - rate) * count) matches are outliers
  double noise_px = 0.0;      ///< [] px, standard deviation of inliers along u and v
};

/// Matches with their true images. An outlier may lie near its true image by chance.
struct RandomMatches {
  Correspondences matches;  ///< matches with face and barycentrics, all kept; no ratio or distance
  Points2 true_px;          ///< [N,2] px, true image of each match
};

namespace detail {

inline Correspondences empty_matches(std::int64_t count) {
  Correspondences matches;
  matches.template_px = Array<double>({count, 2});
  matches.image_px = Array<double>({count, 2});
  matches.face = Array<std::int32_t>({count});
  matches.barycentrics = Array<double>({count, 3});
  matches.kept = Array<std::uint8_t>({count}, 1);
  matches.score = Array<double>({count}, 1.0);
  return matches;
}

}  // namespace detail

/// Draws template points uniformly over the mesh [V,2] px of `locator`. The true image of each is
/// the projection of `true_place(point_px, location)`, [3] m in the camera frame. Outliers are
/// uniform over the image.
template <class TruePlace>
RandomMatches draw_random_matches(const Points2View& flat_px, const FaceLocator& locator,
                                  const Camera& camera, const TruePlace& true_place,
                                  const RandomMatchesSpec& spec, Rng& rng) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const Eigen::Vector2d low = flat_px.colwise().minCoeff(), high = flat_px.colwise().maxCoeff();
  RandomMatches drawn{detail::empty_matches(spec.count), Points2(spec.count, 2)};
  for (Eigen::Index i = 0; i < spec.count; ++i) {
    FaceLocation location;
    Eigen::Vector2d point;
    do {
      point.x() = rng.uniform(low.x(), high.x());
      point.y() = rng.uniform(low.y(), high.y());
      location = locator.locate(point);
    } while (!location.inside);
    drawn.matches.template_px.matrix<2>().row(i) = point;
    drawn.matches.face(i) = location.face;
    drawn.matches.barycentrics.matrix<3>().row(i) = location.weights;
    drawn.true_px.row(i) = project(pinhole, true_place(point, location));
  }
  const std::int64_t mismatches = std::lround((1.0 - spec.correct_rate) * spec.count);
  for (Eigen::Index i = 0; i < spec.count; ++i) {
    Eigen::RowVector2d pixel = drawn.true_px.row(i);
    if (i < mismatches) {
      pixel.x() = rng.uniform(-0.5, static_cast<double>(camera.width_px) - 0.5);
      pixel.y() = rng.uniform(-0.5, static_cast<double>(camera.height_px) - 0.5);
    } else {
      pixel.x() += spec.noise_px * rng.normal();
      pixel.y() += spec.noise_px * rng.normal();
    }
    drawn.matches.image_px.matrix<2>().row(i) = pixel;
  }
  return drawn;
}

}  // namespace weft
