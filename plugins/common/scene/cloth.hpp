// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>

namespace weft::scene {

/// How a cloth behaves; each vertex has the mass 1, so that compliances are per unit mass.
struct ClothSettings {
  int substeps = 10;                 ///< [] in each step
  double bending_compliance = 1e-2;  ///< [] m/N, between each vertex and its second neighbour; 0 is
                                     ///< stiff
  double kept_velocity = 0.99;       ///< [] share of the velocity left after a substep
  double push_m_per_s2 = 0.3;        ///< [] m/s^2 along +z, breaks the symmetry of a flat surface
  double largest_strain = 0.0018;    ///< [] of an edge of the mesh when a step is over
  int most_sweeps = 4000;            ///< [] to get there
};

/// A vertex that is pulled to a place, as by a spring; compliance 0 fixes it there.
struct ClothGuide {
  std::int32_t vertex = 0;
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();  ///< [3] m
  double compliance = 0.0;                             ///< [] m/N
};

/// A surface of cloth or paper on a mesh, simulated by extended position-based dynamics with small
/// steps (Macklin, Mueller and Chentanez 2016; Macklin et al. 2019). For a constraint C with the
/// compliance a and unit masses, each substep of h seconds moves the vertices x by
///     d = -C / (sum |grad C|^2 + a / h^2),  x += d grad C.
/// On a grid of vertices, stretch constrains the sides and both diagonals of all cells with
/// compliance 0. Bending constrains the distance of each vertex to its second neighbour along rows
/// and columns. On any other mesh, stretch constrains its edges, and bending the distances of the
/// vertices opposite each edge. Each step ends with sweeps over the edges of the mesh alone until
/// no edge is strained by more than `largest_strain`. The same calls give the same bytes.
class Cloth {
 public:
  /// `flat_m` [V,3] is the surface at rest, vertex (column i, row j) = j * columns + i, all on the
  /// faces of rectangular_grid_faces(). Fails on a grid below 3 x 3 or of another size.
  static Result<Cloth> create(int columns, int rows, const Points3View& flat_m,
                              const ClothSettings& settings = {});

  /// Any mesh [V,3] m at rest, flat or not. Fails on one that is not manifold.
  static Result<Cloth> create(const Points3View& rest_m, const FacesView& faces,
                              const ClothSettings& settings = {});

  /// From now on the lengths are those of this surface [V,3] m, as of a cloth that is stretched.
  void set_lengths_of(const Points3View& surface_m);

  /// Advances by `duration_s`; the guides move in a straight line from their previous places. Fails
  /// when the surface cannot keep its lengths under them.
  Result<void> step(double duration_s, std::span<const ClothGuide> guides);

  const Points3& vertices_m() const { return position_m_; }
  /// Largest |l / l0 - 1| of an edge of the mesh against the lengths that are set.
  double worst_strain() const;

 private:
  struct Bonds {
    std::vector<DistanceConstraint> edges, shear, bending;
  };

  Cloth(const Points3View& rest_m, Bonds bonds, const ClothSettings& settings);
  static Bonds bonds_of_grid(int columns, int rows);
  void substep(double h_s, std::span<const ClothGuide> guides);
  void pull_to_guides(double h_s, std::span<const ClothGuide> guides);
  void project(std::span<const DistanceConstraint> constraints, double softness);
  Result<void> sweep_until_unstrained();

  ClothSettings settings_;
  Points3 position_m_, before_m_, velocity_m_per_s_;
  std::vector<double> mobility_;  ///< [V] 1, or 0 where a guide holds the vertex
  std::vector<DistanceConstraint> edges_, shear_, bending_;
  std::vector<ClothGuide> last_guides_;
};

}  // namespace weft::scene
