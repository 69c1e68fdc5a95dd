// SPDX-License-Identifier: Apache-2.0
#include "film/welding.hpp"

#include <array>
#include <map>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>

namespace weft::frex {

Result<std::vector<std::int32_t>> first_at_place(const Template& templ) {
  const auto count = static_cast<std::int32_t>(templ.vertices_m.rows());
  std::vector<std::int32_t> first;
  first.reserve(to_index(count));
  if (!templ.welded_vertex.present()) {
    const auto vertices_m = templ.vertices_m.matrix<3>();
    std::map<std::array<double, 3>, std::int32_t> at;
    for (std::int32_t v = 0; v < count; ++v) {
      worked_in_loop(v, 10);
      const std::array place{vertices_m(v, 0), vertices_m(v, 1), vertices_m(v, 2)};
      first.push_back(at.try_emplace(place, v).first->second);
    }
    return first;
  }
  for (std::int32_t v = 0; v < count; ++v) {
    const std::int32_t other = templ.welded_vertex.rows() == count ? templ.welded_vertex(v) : -1;
    if (other < 0 || other > v || templ.welded_vertex(other) != other) {
      return Error{Errc::invalid_data, "welded_vertex of the object is wrong at vertex " +
                                           std::to_string(v) +
                                           ": it must name the first vertex at the same place"};
    }
    first.push_back(other);
  }
  return first;
}

Welding::Welding(const std::vector<std::int32_t>& first, const Faces& vertex_faces)
    : faces(vertex_faces) {
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (to_index(first[v]) == v) {
      place.push_back(static_cast<std::int32_t>(kept.size()));
      kept.push_back(first[v]);
    } else {
      place.push_back(place[to_index(first[v])]);
    }
  }
  faces = faces.unaryExpr([&](std::int32_t v) { return place[to_index(v)]; });
}

Points3 Welding::spread(const Points3& places_m) const {
  Points3 vertices_m(static_cast<Eigen::Index>(place.size()), 3);
  for (std::size_t v = 0; v < place.size(); ++v) {
    vertices_m.row(static_cast<Eigen::Index>(v)) = places_m.row(place[v]);
  }
  return vertices_m;
}

}  // namespace weft::frex
