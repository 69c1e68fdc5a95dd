// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/known_surface.hpp>
#include <weft/geometry/types.hpp>

#include "common/cholesky/block_cholesky.hpp"
#include "common/outline/mask_outline.hpp"
#include "common/outline/outline_term.hpp"
#include "common/seen/measurement.hpp"
#include "mesh/mesh_model.hpp"

namespace weft::gauss_newton {

using solvers::BlockCholesky;
using solvers::BlockMatrix;
using solvers::MaskOutline;
using solvers::OutlinePoint;
using solvers::OutlineScales;
using solvers::OutlineTerm;
using solvers::Trust;
using solvers::Whitening;

/// A point in a face and where it was seen.
struct Observation {
  std::array<double, 3> weights{};  ///< [3] in the face, sum 1
  std::array<double, 2> seen_px{};  ///< [2] px
  Whitening white;                  ///< whitens the error of its image point
};

/// The observations of one face, which stand one after the other.
struct SeenFace {
  std::int32_t face = 0;
  std::size_t first = 0, end = 0;
};

/// The data of one frame.
struct FrameData {
  Pinhole camera;
  std::vector<Observation> observations;
  std::vector<SeenFace> faces;  ///< ascending
  std::vector<KnownSurfacePoint> spheres;
  MaskOutline outline;                ///< absent without a mask
  std::vector<std::uint8_t> covered;  ///< [V] 1 for vertices that something hides; or empty
};

/// How far things are usually off: standard deviations.
struct Scales {
  Trust trust;
  double strain = 0.002;  ///< [] of an edge
  double pair_strain =
      0.005;              ///< [] of the distance of opposite vertices of adjacent faces; 0: any
  double bend_rad = 0.7;  ///< [] rad, of a square of the mesh that bends, whatever its size; 0: any
  double known_m = 1e-5;  ///< [] m, of a known point beyond its radius
  double previous_m = 0.0;  ///< [] m, of a vertex from where it was; 0: any
  OutlineScales outline;    ///< distance of the rim from the outline of the mask
};

/// The prior of a shape.
struct Expectation {
  std::vector<double> bends_rad;  ///< [H] angle of each hinge
  Points3 previous_m;             ///< [V,3] m, read where Scales::previous_m is not 0
};

struct FaceSums;

/// The sum of squares that a shape X minimises,
///   sum_i rho(|W_i (pi(p_i(X)) - u_i)|)                             observations, rho of Trust
///   + sum_edges ((|d| - c) / (strain l0))^2                         lengths of edges
///   + sum_pairs ((|d| - c) / (pair_strain l0))^2                    and of opposite vertices
///   + sum_hinges w ((angle - expected) / bend_rad)^2 / 3            bends
///   + sum_p ((|X(p) - p| - radius_p)+ / known_m)^2                  known points
///   + sum_v |X_v - previous_v|^2 / previous_m^2
///   + the sum of OutlineTerm                                        outline of a mask.
/// The vertices lie on a smooth surface: edges are its chords, and faces cut off a rise. With the
/// curvature k of the surface along an arc that is s long, its chord is c = s (1 - k^2 s^2 / 24).
/// Over the point with the weights b the surface rises by sum_(i<j) b_i b_j k_ij s_ij^2 / 2 against
/// the hollow side: p_i(X) lies on the surface. Derivatives treat curvatures as constant, and
/// follow() reads them off a shape.
class Energy {
 public:
  /// Structure and memory for a mesh, which must outlive it.
  void prepare(const MeshModel& mesh);

  /// Reads the curvatures of a shape [V,3]. With a share below 1 they go only that part of the way
  /// from those that were read before.
  void follow(const Points3& vertices_m, double share = 1.0);

  /// The energy; infinite where an observed point is not in front of the camera.
  double value(const FrameData& frame, const Expectation& expected, const Scales& scales,
               const Points3& vertices_m);

  /// The same, with half the gradient [V,3] and the Gauss-Newton matrix.
  double linearise(const FrameData& frame, const Expectation& expected, const Scales& scales,
                   const Points3& vertices_m, Points3& gradient, BlockMatrix& matrix);

  /// Adds the Gauss-Newton matrix of the observations alone.
  void add_observations(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
                        BlockMatrix& matrix);

  /// Finds which points of the rim of a shape [V,3] and of the mask's outline meet. With 30
  /// observations or more, the trace of the outline's matrix is at most half the trace of their
  /// matrix.
  void meet_outline(const FrameData& frame, const Scales& scales, const Points3& vertices_m);

  /// Adds the Gauss-Newton matrix of the outline alone, as it was met last.
  void add_outline(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
                   BlockMatrix& matrix) const;
  const OutlineTerm& outline() const { return outline_; }

  /// Where the surface is seen over a point of a face.
  Eigen::Vector3d surface_point_m(const Points3& vertices_m, std::int32_t face,
                                  const std::array<double, 3>& weights) const;

 private:
  /// Where derivatives go; null where only the value is wanted.
  struct Derivatives {
    Points3* gradient = nullptr;
    BlockMatrix* matrix = nullptr;
  };

  template <bool wants_derivatives>
  double observed(const FrameData& frame, const Trust& trust, const Points3& vertices_m,
                  const Derivatives& to) const;
  template <bool wants_derivatives>
  double outlined(const FrameData& frame, const Scales& scales, const Points3& vertices_m,
                  const Derivatives& to) const;
  void add_sums(const FaceSums& sums, std::int32_t face, const Derivatives& to) const;
  template <bool wants_derivatives>
  double stretched(const std::vector<Arc>& arcs, const std::vector<double>& chords_m, double strain,
                   const Points3& vertices_m, const Derivatives& to) const;
  template <bool wants_derivatives>
  double bent(const std::vector<double>& expected_rad, double bend_rad, const Points3& vertices_m,
              const Derivatives& to);
  template <bool wants_derivatives>
  double known_energy(const FrameData& frame, double known_m, const Points3& vertices_m,
                      const Derivatives& to) const;
  template <bool wants_derivatives>
  double sum(const FrameData& frame, const Expectation& expected, const Scales& scales,
             const Points3& vertices_m, const Derivatives& to);

  const MeshModel* mesh_ = nullptr;
  Points3 normals_;                 ///< [F,3] of the shape that is looked at
  std::vector<double> angles_rad_;  ///< [H]
  std::vector<double> edge_chords_m_, pair_chords_m_;
  std::vector<double> rises_m_;  ///< rises of the edges, k s^2 / 2
  Points3 fronts_;               ///< [F,3] unit normals, of the shape that is followed
  OutlineTerm outline_;
  BlockMatrix outline_matrix_;  ///< for traces
};

}  // namespace weft::gauss_newton
