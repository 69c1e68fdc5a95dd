// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// Two vertices and their distance at rest.
struct DistanceConstraint {
  std::int32_t i = 0;          ///< [] index of the first vertex
  std::int32_t j = 0;          ///< [] index of the second vertex
  double rest_length_m = 0.0;  ///< [] m, > 0
};

/// Makes one constraint per pair [E,2] (edges or bending pairs), in their order, with the lengths
/// at rest from vertices [V,3] m. Fails on an invalid index and on a length that is 0 or not
/// finite.
inline Result<std::vector<DistanceConstraint>> distance_constraints(
    const EdgesView& pairs, const Points3View& rest_vertices_m) {
  std::vector<DistanceConstraint> constraints;
  constraints.reserve(to_index(pairs.rows()));
  for (Eigen::Index e = 0; e < pairs.rows(); ++e) {
    const std::int32_t i = pairs(e, 0), j = pairs(e, 1);
    const auto name = [i, j] {
      return "the pair of vertices " + std::to_string(i) + " and " + std::to_string(j);
    };
    worked_in_loop(e);
    if (i < 0 || j < 0 || i >= rest_vertices_m.rows() || j >= rest_vertices_m.rows()) {
      return Error{Errc::invalid_data, name() + " is outside the mesh of " +
                                           std::to_string(rest_vertices_m.rows()) +
                                           " vertices: correct the index"};
    }
    const double length = (rest_vertices_m.row(i) - rest_vertices_m.row(j)).norm();
    if (!(length > 0.0) || !std::isfinite(length)) {
      return Error{Errc::invalid_data,
                   name() + " has no length at rest: separate the vertices or merge them"};
    }
    constraints.push_back({i, j, length});
  }
  return constraints;
}

/// Relative length errors. All are NaN without constraints or with a NaN vertex.
struct StrainStatistics {
  double mean = std::numeric_limits<double>::quiet_NaN();  ///< [] mean |l / l0 - 1|
  double p95 = std::numeric_limits<double>::quiet_NaN();   ///< [] 95th percentile of |l / l0 - 1|
  double max = std::numeric_limits<double>::quiet_NaN();   ///< [] largest |l / l0 - 1|
};

/// |l / l0 - 1| of each constraint on vertices [V,3] m of the same mesh.
inline std::vector<double> strains(std::span<const DistanceConstraint> constraints,
                                   const Points3View& vertices_m) {
  std::vector<double> values;
  values.reserve(constraints.size());
  for (const DistanceConstraint& c : constraints) {
    worked_in_loop(static_cast<std::int64_t>(values.size()));
    const double length = (vertices_m.row(c.i) - vertices_m.row(c.j)).norm();
    values.push_back(std::abs(length / c.rest_length_m - 1.0));
  }
  return values;
}

inline StrainStatistics strain_statistics(std::span<const DistanceConstraint> constraints,
                                          const Points3View& vertices_m) {
  const std::vector<double> values = strains(constraints, vertices_m);
  return {mean(values), percentile(values, 95.0), percentile(values, 100.0)};
}

}  // namespace weft
