// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <weft/core/result.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/seam_places.hpp>

namespace weft {

/// Joins the vertices of a template on both sides of its texture seams for a solver: V vertices in
/// separate charts become W places of one surface. Face numbers and the order of corners stay, so
/// that positions given by face and barycentrics need no change. Only the first vertex of a place
/// keeps its texture position: `flat_px` of the joined template is invalid in faces at a seam.
///
/// The header does not include Eigen, because all solvers read it.
class Welding {
 public:
  /// Numbers the places of a template with `welded_vertex`. The result is kept while the template's
  /// revision stays.
  Result<void> update(const Template& templ) {
    if (revision_ != 0 && templ.revision == revision_) return {};
    revision_ = 0;
    if (auto numbered = places_.number(templ); !numbered) return numbered;
    vertices_m_ = places_.gathered(templ.vertices_m);
    flat_px_ = places_.gathered(templ.flat_px);
    vertex_tetrahedron_ = places_.gathered(templ.vertex_tetrahedron);
    vertex_barycentric_ = places_.gathered(templ.vertex_barycentric);
    faces_ = Array<std::int32_t>({templ.faces.rows(), 3});
    for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
      for (std::int64_t k = 0; k < 3; ++k) faces_(f, k) = places_.of(templ.faces(f, k));
    }
    revision_ = templ.revision;
    return {};
  }

  /// The template after update(), with W vertices and without `welded_vertex`. Its revision follows
  /// from the template's revision and differs from it.
  Template joined(const Template& templ) const {
    Template welded;
    welded.vertices_m = vertices_m_;
    welded.flat_px = flat_px_;
    welded.faces = faces_;
    welded.m_per_px = templ.m_per_px;
    welded.texture = templ.texture;
    welded.mask = templ.mask;
    welded.nodes_m = templ.nodes_m;
    welded.tetrahedra = templ.tetrahedra;
    welded.vertex_tetrahedron = vertex_tetrahedron_;
    welded.vertex_barycentric = vertex_barycentric_;
    welded.others = templ.others;
    make_own(welded);
    welded.revision = joined_revision(templ.revision);
    return welded;
  }

  /// The inputs after update(), for the joined template. Matches are unchanged, because they have
  /// faces. Fails if a known point is beside the template.
  Result<SolverInput> joined(const SolverInput& in) const {
    SolverInput welded = in;
    welded.templ = joined(in.templ);
    if (in.sightlines) welded.sightlines->vertex = places_.of_all(in.sightlines->vertex);
    if (in.visibility) join(*welded.visibility);
    if (in.previous_shape) {
      Shape& shape = *welded.previous_shape;
      shape.vertices_m = places_.gathered(shape.vertices_m);
      shape.source = places_.gathered(shape.source);
      shape.covariance_m2 = places_.gathered(shape.covariance_m2);
      make_own(shape);
    }
    if (in.known_points) {
      auto joined_points = join(in.templ, *welded.known_points);
      if (!joined_points) return joined_points.error();
    }
    return welded;
  }

  /// Copies the values of each place to all of its vertices. Diagnostics and nodes are unchanged.
  void spread(Shape& shape) const {
    shape.vertices_m = places_.spread(shape.vertices_m);
    shape.source = places_.spread(shape.source);
    shape.covariance_m2 = places_.spread(shape.covariance_m2);
  }

 private:
  /// A joined record has other rows than the one that was read: it passes on neither its further
  /// arrays nor its revision.
  template <class RecordType>
  static void make_own(RecordType& record) {
    record.others.drop();
    record.others.own().clear();
    record.others.seal(0, 0);
  }

  static std::uint64_t joined_revision(std::uint64_t revision) {
    if (revision == 0) return 0;
    std::uint64_t mixed = (revision ^ 0x77656C64U) * 0x9E3779B97F4A7C15U;  // an odd factor: 1 to 1
    mixed ^= mixed >> 32U;
    return mixed != 0 && mixed != revision ? mixed : ~revision;
  }

  /// A place is visible if one of its vertices is visible. Its score and its reason are those of
  /// the vertex with the best score, where a visible vertex precedes a hidden one.
  void join(Visibility& visibility) const {
    const Visibility all = visibility;
    if (all.visible.rows() != places_.vertex_count()) return;
    visibility.visible = places_.gathered(all.visible);
    visibility.score = places_.gathered(all.score);
    visibility.reason = places_.gathered(all.reason);
    for (std::int64_t v = 0; v < all.visible.rows(); ++v) {
      const std::int64_t w = places_.of(static_cast<std::int32_t>(v));
      const std::pair own(all.visible(v), all.score(v));
      if (!(own > std::pair(visibility.visible(w), visibility.score(w)))) continue;
      visibility.visible(w) = all.visible(v);
      visibility.score(w) = all.score(v);
      visibility.reason(w) = all.reason(v);
    }
    make_own(visibility);
  }

  /// Points at vertices become points at places. Points of the flat template become points in
  /// faces, because the flat mesh is valid only before its seams are joined.
  Result<void> join(const Template& templ, KnownPoints& known) const {
    const Array<std::int32_t> vertex = known.vertex;
    known.vertex = places_.of_all(vertex);
    if (!known.template_xy_m.present() || !templ.m_per_px.present()) return {};
    Array<std::int32_t> face({known.count()}, -1);
    Array<double> barycentrics({known.count(), 3}, 0.0);
    for (std::int64_t p = 0; p < known.count(); ++p) {
      const bool has_face =
          known.face.present() && known.barycentrics.present() && known.face(p) >= 0;
      if (has_face) {
        face(p) = known.face(p);
        std::copy_n(known.barycentrics.row(p), 3, barycentrics.row(p));
      } else if (vertex(p) < 0) {
        const std::array place_px{known.template_xy_m(p, 0) / templ.m_per_px(0),
                                  known.template_xy_m(p, 1) / templ.m_per_px(1)};
        face(p) = detail::face_around(place_px, templ, barycentrics.row(p));
        if (face(p) < 0) return beside_the_template(known, p);
      }
    }
    known.face = std::move(face);
    known.barycentrics = std::move(barycentrics);
    return {};
  }

  static Error beside_the_template(const KnownPoints& known, std::int64_t p) {
    return Error{Errc::invalid_data, "known point " + std::to_string(p) + " is at (" +
                                         std::to_string(1e3 * known.template_xy_m(p, 0)) + ", " +
                                         std::to_string(1e3 * known.template_xy_m(p, 1)) +
                                         ") mm, beside the template"};
  }

  std::uint64_t revision_ = 0;  ///< [] of the template; 0 keeps nothing
  SeamPlaces places_;
  Array<double> vertices_m_;                ///< [W,3] m, template frame
  Array<double> flat_px_;                   ///< [W,2] px of the texture, of the first vertices
  Array<std::int32_t> faces_;               ///< [F,3] places
  Array<std::int32_t> vertex_tetrahedron_;  ///< [W]
  Array<double> vertex_barycentric_;        ///< [W,4]
};

}  // namespace weft
