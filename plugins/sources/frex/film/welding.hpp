// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft::frex {

/// The first vertex at the same place as each vertex [V], itself included: that of the template, or
/// found by equal coordinates if the template does not give it. Fails on an array that is none.
Result<std::vector<std::int32_t>> first_at_place(const Template& templ);

/// The vertices of a surface with seams, one for each place.
struct Welding {
  std::vector<std::int32_t> kept;   ///< [K] vertex that represents each place
  std::vector<std::int32_t> place;  ///< [V] place of each vertex
  Faces faces;                      ///< [F,3] over the places

  Welding(const std::vector<std::int32_t>& first, const Faces& vertex_faces);
  bool has_seams() const { return kept.size() < place.size(); }
  /// The vertices [V,3] of a surface with these places [K,3].
  Points3 spread(const Points3& places_m) const;
};

}  // namespace weft::frex
