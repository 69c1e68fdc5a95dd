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

/// A plane in the space of matches: x = origin + basis y. It is an affine map between the images
/// (Tran et al. 2012, Section 3).
struct MatchPlane {
  Eigen::RowVector4d origin = Eigen::RowVector4d::Zero();
  Eigen::Matrix<double, 4, 2> basis = Eigen::Matrix<double, 4, 2>::Zero();  ///< orthonormal

  /// Whether the map keeps the sheet's side towards the camera.
  bool keeps_orientation() const {
    return basis.topRows<2>().determinant() * basis.bottomRows<2>().determinant() > 0.0;
  }

  /// The squares of the distances of matches from the plane, [n].
  void distances2(const MatchPoints& matches, Eigen::ArrayXd& distances2) const;
};

/// The plane through three matches, or nothing where they are on a line in either image.
std::optional<MatchPlane> plane_through(const MatchPoints& matches, Eigen::Index a, Eigen::Index b,
                                        Eigen::Index c);

/// The plane of least squared distances to some of the matches, at least 3.
MatchPlane plane_of(const MatchPoints& matches, const std::vector<std::uint8_t>& chosen);

struct Search {
  double limit = 0.1;  ///< distance up to which a match agrees
  int most_draws = 1000;
  bool keep_orientation = true;
};

struct Found {
  MatchPlane plane;
  Eigen::Index agreeing = 0;
  int draws = 0;
};

/// RANSAC over triples (Fischler and Bolles 1981) with truncated squares for equal counts (Torr and
/// Zisserman 2000), until a better plane is unlikely (1 %). Nothing where no triple makes a plane.
std::optional<Found> search(const MatchPoints& matches, const Search& search, Rng& rng);

}  // namespace weft::tran
