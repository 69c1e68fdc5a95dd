// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "local_map.hpp"

namespace weft::famouri_local {

/// How far a match is from the camera, by its local map.
struct LocalDepth {
  double distance_m = 0.0;  ///< [] m from the camera centre
  double std_m = 0.0;       ///< [] m, standard deviation
};

/// The distance theta of an isometric surface from its image point and its Jacobian J alone
/// (Bartoli et al. 2015, see isometric_point()). Its noise follows from that of J, by eight points
/// at twice the principal standard deviations of J (Julier and Uhlmann, Proc. IEEE 92, 2004). The
/// smaller one of two eigenvalues gives theta, so noise lowers it. The eight points measure this
/// bias, which is subtracted: 2 theta(J) minus their mean. Nothing where the map folds, or may as
/// well do so.
std::optional<LocalDepth> local_depth(const LocalMap& map);

}  // namespace weft::famouri_local
