// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>
#include <weft/core/rng.hpp>

namespace weft::tran {

/// Matches as points of R^4, template coordinates first, both normalised: [n,4].
using MatchPoints = Eigen::Matrix<double, Eigen::Dynamic, 4>;

/// How far a match is from an affine map: in the space of matches, or in the image.
enum class Residual { orthogonal, regression };

/// A plane in the space of matches, which is an affine map between the images (Tran et al. 2012,
/// Section 3): (x - origin) normals = 0. The distance of x is |(x - origin) normals|. Where the
/// normals are orthonormal, it is orthogonal to the plane. Where they are [M; -I], with M the slope
/// of the map, it is a distance in the image.
struct MatchPlane {
  Eigen::RowVector4d origin = Eigen::RowVector4d::Zero();
  Eigen::Matrix<double, 4, 2> normals = Eigen::Matrix<double, 4, 2>::Zero();

  /// The squares of the distances of matches, [n].
  void distances2(const MatchPoints& matches, Eigen::ArrayXd& distances2) const;
};

struct Search {
  Residual residual = Residual::orthogonal;
  double limit = 0.1;  ///< distance up to which a match agrees
  int most_draws = 1000;
  bool keep_orientation = true;  ///< the map must keep the surface's side towards the camera
};

/// The plane through three matches, or nothing where they are on a line in either image or the map
/// is not as wanted.
std::optional<MatchPlane> plane_through(const MatchPoints& matches, Eigen::Index a, Eigen::Index b,
                                        Eigen::Index c, const Search& search);

/// The plane of least squared distances to some of the matches, at least 3; nothing where these
/// are on a line.
std::optional<MatchPlane> plane_of(const MatchPoints& matches,
                                   const std::vector<std::uint8_t>& chosen, Residual residual);

struct Found {
  MatchPlane plane;
  Eigen::Index agreeing = 0;
  int draws = 0;
};

/// RANSAC over triples (Fischler and Bolles 1981) with truncated squares for equal counts (Torr and
/// Zisserman 2000), until a better plane is unlikely (1 %). Nothing where no triple makes a plane.
std::optional<Found> search(const MatchPoints& matches, const Search& search, Rng& rng);

}  // namespace weft::tran
