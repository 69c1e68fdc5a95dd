// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/template.hpp>

namespace weft {

/// The W places in space of a template's V vertices. Vertices on both sides of a texture seam share
/// a place.
class SeamPlaces {
 public:
  /// Numbers the places in the order of their first vertices. Fails if `welded_vertex` of a vertex
  /// is not a first vertex.
  Result<void> number(const Template& templ) {
    const Array<std::int32_t>& welded = templ.welded_vertex;
    const std::int64_t count = templ.vertices_m.rows();
    first_vertex_.clear();
    place_of_vertex_.assign(to_index(count), 0);
    for (std::int64_t v = 0; v < count; ++v) {
      const std::int32_t first = welded(v);
      if (first < 0 || first > v || welded(first) != first) {
        return Error{Errc::invalid_data, "template: welded_vertex of vertex " + std::to_string(v) +
                                             " is " + std::to_string(first) +
                                             ", but must be the first vertex at the same place: "
                                             "at most the vertex itself, and its own first vertex"};
      }
      if (first == v) {
        place_of_vertex_[to_index(v)] = static_cast<std::int32_t>(first_vertex_.size());
        first_vertex_.push_back(v);
      } else {
        place_of_vertex_[to_index(v)] = place_of_vertex_[to_index(first)];
      }
    }
    return {};
  }

  std::int64_t vertex_count() const { return static_cast<std::int64_t>(place_of_vertex_.size()); }

  /// The place of a vertex; an index outside the template is unchanged.
  std::int32_t of(std::int32_t vertex) const {
    if (vertex < 0 || to_index(vertex) >= place_of_vertex_.size()) return vertex;
    return place_of_vertex_[to_index(vertex)];
  }

  Array<std::int32_t> of_all(const Array<std::int32_t>& vertices) const {
    Array<std::int32_t> places({vertices.rows()});
    for (std::int64_t i = 0; i < vertices.rows(); ++i) places(i) = of(vertices(i));
    return places;
  }

  /// The rows [W,...] of the first vertices, from rows [V,...]. Arrays of another length are
  /// unchanged.
  template <class T>
  Array<T> gathered(const Array<T>& rows) const {
    if (!rows.present() || to_index(rows.rows()) != place_of_vertex_.size()) return rows;
    Array<T> some = with_rows(rows, static_cast<std::int64_t>(first_vertex_.size()));
    for (std::int64_t w = 0; w < some.rows(); ++w) {
      std::copy_n(rows.row(first_vertex_[to_index(w)]), rows.row_elements(), some.row(w));
    }
    return some;
  }

  /// The rows [V,...] of all vertices, from rows [W,...]. Arrays of another length are unchanged.
  template <class T>
  Array<T> spread(const Array<T>& rows) const {
    if (!rows.present() || to_index(rows.rows()) != first_vertex_.size()) return rows;
    Array<T> all = with_rows(rows, static_cast<std::int64_t>(place_of_vertex_.size()));
    for (std::int64_t v = 0; v < all.rows(); ++v) {
      std::copy_n(rows.row(place_of_vertex_[to_index(v)]), rows.row_elements(), all.row(v));
    }
    return all;
  }

 private:
  /// An array with the row shape of another one and `count` rows.
  template <class T>
  static Array<T> with_rows(const Array<T>& like, std::int64_t count) {
    if (like.ndim() == 1) return Array<T>({count});
    if (like.ndim() == 2) return Array<T>({count, like.dim(1)});
    return Array<T>({count, like.dim(1), like.dim(2)});
  }

  std::vector<std::int32_t> place_of_vertex_;  ///< [V] place, 0 to W-1
  std::vector<std::int64_t> first_vertex_;     ///< [W] vertex
};

namespace detail {

/// The face of the flat mesh for which the smallest weight of a point is largest, with its three
/// weights; -1 if a weight would be below -1/2. Like face_around() in
/// weft/geometry/known_surface.hpp, without Eigen.
inline std::int32_t face_around(const std::array<double, 2>& place_px, const Template& templ,
                                double* weights) {
  std::int32_t found = -1;
  double largest = -0.5;
  for (std::int32_t f = 0; f < templ.faces.rows(); ++f) {
    worked_in_loop(f, 3);
    const double *a = templ.flat_px.row(templ.faces(f, 0)),
                 *b = templ.flat_px.row(templ.faces(f, 1)),
                 *c = templ.flat_px.row(templ.faces(f, 2));
    const double abx = b[0] - a[0], aby = b[1] - a[1], acx = c[0] - a[0], acy = c[1] - a[1];
    const double apx = place_px[0] - a[0], apy = place_px[1] - a[1];
    const double det = abx * acy - aby * acx;
    const double w1 = (apx * acy - apy * acx) / det, w2 = (abx * apy - aby * apx) / det;
    const double least = std::min({1.0 - w1 - w2, w1, w2});
    if (!std::isfinite(w1) || !std::isfinite(w2) || !(least > largest)) continue;
    largest = least;
    found = f;
    weights[0] = 1.0 - w1 - w2;
    weights[1] = w1;
    weights[2] = w2;
  }
  return found;
}

}  // namespace detail

}  // namespace weft
