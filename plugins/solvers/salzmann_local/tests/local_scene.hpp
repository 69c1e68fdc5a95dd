// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/index.hpp>

#include "common/tests/matched_scene.hpp"

namespace weft::salzmann_local {

inline constexpr const char* kId = "solvers/salzmann_local";

struct Scene : solvers::SceneOf<kId> {
  using SceneOf::SceneOf;

  /// Numbers the vertices anew, so that the mesh is no grid by its numbers.
  void shuffle(std::uint64_t seed) {
    std::vector<std::int32_t> place;
    for (std::int32_t v = 0; v < truth_m.rows(); ++v) place.push_back(v);
    Rng rng(seed);
    rng.shuffle(place);
    const Points3 rest_m = templ.vertices_m.matrix<3>(), true_m = truth_m;
    const Points2 flat_px = templ.flat_px.matrix<2>();
    for (Eigen::Index v = 0; v < true_m.rows(); ++v) {
      const std::int32_t to = place[to_index(v)];
      truth_m.row(to) = true_m.row(v);
      for (int k = 0; k < 3; ++k) templ.vertices_m(to, k) = rest_m(v, k);
      for (int k = 0; k < 2; ++k) templ.flat_px(to, k) = flat_px(v, k);
    }
    for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) templ.faces(f, k) = place[to_index(templ.faces(f, k))];
    }
  }
};

}  // namespace weft::salzmann_local
