// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>
#include <weft/geometry/types.hpp>

#include "common/seen/seen_points.hpp"

namespace weft::famouri_local {

/// Where a match lies on the template at rest.
struct RestPlace {
  Eigen::Vector3d at_m;    ///< [3] m, template frame
  Eigen::Vector3d normal;  ///< [3] unit, of its face, towards a camera that sees the front

  /// Unit vectors x and y of the tangent plane, turned as the template's u and v are: [3,2].
  Eigen::Matrix<double, 3, 2> axes() const;

  /// Another place in the coordinates of the tangent plane, [2] m: in the direction of its
  /// projection, at its straight distance. On a flat template these are plane coordinates; on one
  /// of curvature k, lengths r along the surface come out short by k^2 r^3 / 24.
  Eigen::Vector2d laid_out(const Eigen::Vector3d& other_m,
                           const Eigen::Matrix<double, 3, 2>& axes) const;
};

/// The rest places of the matches [n], from the vertices at rest [V,3] m.
std::vector<RestPlace> rest_places(std::span<const solvers::SeenPoint> points,
                                   const Points3View& rest_m);

/// A neighbour of a place.
struct NearPlace {
  double distance2_m2 = 0.0;  ///< [] m^2, straight
  std::int32_t index = 0;     ///< [] of the place
};

/// A k-d tree (Bentley, CACM 18, 1975) over places, which finds those that are nearest. Places
/// whose faces look another way are no neighbours, such as those on the back of a thin object.
class NearestPlaces {
 public:
  void build(std::vector<RestPlace> places);

  const std::vector<RestPlace>& places() const { return places_; }

  /// Up to `count` places within `reach_m` of a place, itself among them, the nearest first and the
  /// smaller index first among equals.
  void find(std::int32_t of, std::size_t count, double reach_m, std::vector<NearPlace>& near) const;

 private:
  struct Query {
    std::int32_t of;
    std::size_t count;
    double reach2_m2;
    std::vector<NearPlace>& near;
  };

  void split(std::size_t first, std::size_t end);
  void search(std::size_t first, std::size_t end, const Query& query) const;
  void consider(std::int32_t index, const Query& query) const;

  std::vector<RestPlace> places_;
  std::vector<std::int32_t> order_;  ///< [n] the middle of each range parts it
  std::vector<std::uint8_t> axis_;   ///< [n] along which
};

}  // namespace weft::famouri_local
