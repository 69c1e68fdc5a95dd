// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>
#include <weft/data/visibility.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// [V] 1 for vertices that cannot be seen, and for those that are not measured (`measured` [V] is
/// 0) and are joined to them by such vertices: next to a rim nothing is recognised either. Empty
/// where nothing is hidden; what is outside the image is not. Fails on a visibility of another
/// mesh.
Result<std::vector<std::uint8_t>> hidden_part(const Visibility& visibility,
                                              const std::vector<std::uint8_t>& measured,
                                              const IndexLists& neighbours);

/// Adds all vertices that are not measured: on a template that is curved at rest the distances
/// alone do not tell its bend from the opposite one, so they are laid out as well.
void add_unmeasured(const std::vector<std::uint8_t>& measured, std::vector<std::uint8_t>& hidden);

/// Adds the parts that are not measured, reach the border of the mesh (`border`, its vertices) and
/// are wider than one ring of vertices: what measured vertices surround, or are next to, is held
/// well enough by the distances.
void add_uncovered(const std::vector<std::uint8_t>& measured, const IndexLists& neighbours,
                   const std::vector<std::int32_t>& border, std::vector<std::uint8_t>& hidden);

/// What a hidden part is taken to look like.
struct HiddenBend {
  Points3 shape_m;  ///< [V,3] m, camera frame: the hidden part unrolled from the seen one, unless
                    ///< that tears it
  std::vector<DistanceConstraint> bending;  ///< those given, longer or shorter where hidden
  Eigen::Index torn_vertices = 0;           ///< hidden ones that stayed as they were
};

/// Goes on with the bend of a surface where it is out of sight. A surface that has turned away has
/// bent, and is likelier to go on than to become flat just where it can no longer be seen, unless
/// its bend fades already.
///
/// Across an edge of width w (a third of the two heights on it) the bend against the rest shape is
/// w times a curvature. For a hidden edge this is the value at d = 0 of the line in d through those
/// of the edges of the seen part, at least a ring away from the rim, weighted by
/// |n . n'|^16 exp(-(d - d_min) / reach): n and n' are the unit normals of both edges and d their
/// distance, in the texture; but no more than their mean, and of its sign or 0. So edges of one
/// direction follow edges of that direction, and a cylinder goes on exactly. The hidden vertices
/// are then laid out ring by ring, each at the mean of the places that the edges next to it give.
///
/// A hidden part with seen ones on several sides, as in a fold, is laid out from all of them. Where
/// that strains a tenth of its edges by 30 %, it is torn: the bend does not go on but turns back
/// out of sight, and this part stays as it was.
class BendContinuation {
 public:
  /// Fails on a mesh that cannot be used.
  Result<void> build(const Template& templ);

  /// `hidden` [V] is 1 for the vertices that are to be laid out from the others of the shape
  /// [V,3] m. Without a seen edge, or where the hidden part does not touch it, the shape stays.
  HiddenBend continued(const Points3View& shape_m, const std::vector<std::uint8_t>& hidden,
                       const std::vector<DistanceConstraint>& bending) const;

  /// By how much the surface bends across each of edges() where it goes on so, in rad, positive
  /// where the front is hollow; elsewhere as it does. Empty where no edge is seen. Of more seen
  /// edges than `most_seen` every second, third ... is read.
  std::vector<double> continued_angles(
      const Points3View& shape_m, const std::vector<std::uint8_t>& hidden,
      std::size_t most_seen = std::numeric_limits<std::size_t>::max()) const;
  /// The vertices at both ends of edge `e` of edge_count().
  std::array<std::int32_t, 2> edge(std::size_t e) const {
    return {hinges_[e].vertex[0], hinges_[e].vertex[1]};
  }
  std::size_t edge_count() const { return hinges_.size(); }

 private:
  /// The edge (a, b) between the faces (a, b, c) and (b, a, d), c left and d right of it as the
  /// camera sees the front.
  struct Hinge {
    std::array<std::int32_t, 4> vertex{};  ///< [4] a, b, c, d
    std::array<double, 2> along_m{};       ///< [2] m, of c and d from a along the edge, at rest
    std::array<double, 2> height_m{};      ///< [2] m, of c and d over the edge, at rest
    double edge_m = 0.0;                   ///< [] m, from a to b, at rest
    double rest_rad = 0.0;                 ///< [] rad, positive where the front is hollow
    Eigen::Vector2d place_px, across;      ///< middle of the edge, unit normal to it, texture
    double width_m() const { return (height_m[0] + height_m[1]) / 3.0; }
  };

  static bool touches(const Hinge& hinge, const std::vector<std::uint8_t>& marked);
  std::vector<std::uint8_t> with_rim(const std::vector<std::uint8_t>& hidden) const;
  static double angle_rad(const Hinge& hinge, const Points3View& shape_m);
  void lay_out(const std::vector<double>& angles_rad, std::vector<std::uint8_t> placed,
               Points3& shape_m) const;
  /// Of the hidden parts, those whose edges a layout keeps: [V] 1 for their vertices.
  std::vector<std::uint8_t> parts_kept_whole(const std::vector<std::uint8_t>& hidden,
                                             const Points3& shape_m) const;

  std::vector<Hinge> hinges_;
  double reach_px_ = 0.0;  ///< px, of the texture
};

}  // namespace weft::solvers
