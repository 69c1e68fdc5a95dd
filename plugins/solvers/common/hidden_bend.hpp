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
/// where nothing is hidden; vertices outside the image do not count as hidden. Fails on a
/// visibility of another mesh.
Result<std::vector<std::uint8_t>> hidden_part(const Visibility& visibility,
                                              const std::vector<std::uint8_t>& measured,
                                              const IndexLists& neighbours);

/// Adds all vertices that are not measured. On a template that is curved at rest, the distances
/// alone do not distinguish its bend from the opposite one. These vertices are therefore laid out
/// as well.
void add_unmeasured(const std::vector<std::uint8_t>& measured, std::vector<std::uint8_t>& hidden);

/// Adds the parts that are not measured, reach the border of the mesh (`border`, its vertices) and
/// are wider than one ring of vertices. The distances alone constrain parts that measured vertices
/// surround or touch.
void add_uncovered(const std::vector<std::uint8_t>& measured, const IndexLists& neighbours,
                   const std::vector<std::int32_t>& border, std::vector<std::uint8_t>& hidden);

/// The assumed shape of a hidden part.
struct HiddenBend {
  Points3 shape_m;  ///< [V,3] m, camera frame: the hidden part unrolled from the seen one, unless
                    ///< that tears it
  std::vector<DistanceConstraint> bending;  ///< those given, longer or shorter where hidden
  Eigen::Index torn_vertices = 0;           ///< hidden ones that stayed as they were
};

/// Continues the bend of a surface into its hidden part. A surface that turned away has bent. It is
/// likelier to continue than to become flat just where it is hidden, unless its bend fades already.
///
/// Across an edge of width w (a third of the two heights on it) the bend against the rest shape is
/// w times a curvature. For a hidden edge this curvature is extrapolated from edges of the seen
/// part, at least a ring away from the rim. A line in d is fitted to their curvatures, and its
/// value at d = 0 is used. Each has the weight |n . n'|^16 exp(-(d - d_min) / reach). Here n and n'
/// are the unit normals of both edges and d their distance, in the texture. The value is limited to
/// the mean of the curvatures, and is 0 where it has the opposite sign. Edges of one direction
/// therefore follow edges of that direction, and a cylinder continues exactly. The hidden vertices
/// are then laid out ring by ring, each at the mean of the places that the adjacent edges give.
///
/// A hidden part with seen parts on several sides, as in a fold, is laid out from all of them. The
/// part is torn where that strains a tenth of its edges by 30 %. The bend then does not continue
/// but reverses in the hidden part, and this part stays unchanged.
class BendContinuation {
 public:
  /// Fails on a mesh that cannot be used.
  Result<void> build(const Template& templ);

  /// `hidden` [V] is 1 for the vertices that are to be laid out from the others of the shape
  /// [V,3] m. Without a seen edge, or where the hidden part does not touch it, the shape stays.
  HiddenBend continued(const Points3View& shape_m, const std::vector<std::uint8_t>& hidden,
                       const std::vector<DistanceConstraint>& bending) const;

  /// The angles by which the surface bends across each of edges(), in rad, positive where the front
  /// is hollow. Hidden edges have the angles of the continued surface, and others their present
  /// angles. Empty where no edge is seen. With more seen edges than `most_seen`, it reads every
  /// second, third ... edge.
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
  /// The hidden parts whose edges a layout keeps: [V] 1 for their vertices.
  std::vector<std::uint8_t> parts_kept_whole(const std::vector<std::uint8_t>& hidden,
                                             const Points3& shape_m) const;

  std::vector<Hinge> hinges_;
  double reach_px_ = 0.0;  ///< px, of the texture
};

}  // namespace weft::solvers
