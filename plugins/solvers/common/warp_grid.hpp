// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>
#include <weft/sdk/solver.hpp>

#include "isometric_point.hpp"

namespace weft::solvers {

/// A place of the template, and the values of a warp there.
struct WarpPlace {
  int i = 0;                                           ///< [] of the grid, along u
  int j = 0;                                           ///< [] of the grid, along v
  Eigen::Vector2d place_px = Eigen::Vector2d::Zero();  ///< [2] px of the texture
  Eigen::Matrix2d metric = Eigen::Matrix2d::Zero();    ///< [2,2] m^2/px^2, of the template at rest
  Eigen::Vector2d eta = Eigen::Vector2d::Zero();       ///< [2] normalised image point
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();  ///< [2,2] 1/px, of eta by (u, v)
};

/// A warp, read where matches are near.
struct WarpReading {
  std::vector<WarpPlace> places;
  std::size_t on_mesh = 0;             ///< [] places of the grid on the template's mesh
  std::string degenerate_reason = {};  ///< reason in the warp; empty unless it is degenerate
};

/// The places where a surface that is isometric to the template can be determined, and the surface
/// there.
struct IsometricReading {
  std::vector<WarpPlace> places;       ///< [n]
  std::vector<IsometricPoint> points;  ///< [n]
  Points2 places_px;                   ///< [n,2] px of the texture
  Points3 points_m;                    ///< [n,3] m, camera frame
  int folded = 0;                      ///< [] places that are omitted
};

IsometricReading isometric_reading(const std::vector<WarpPlace>& places);

/// The input of solvers in closed form: a warp with its derivatives on a grid of the texture.
class WarpGrid {
 public:
  /// The parameters `grid`, `reach` and `warp`.
  void declare(Params& p);

  /// Fits the warp to the kept matches and reads it on the grid.
  Result<WarpReading> read(const SolverInput& in);

  /// For the template and the matches that were read last.
  bool near_match(const Eigen::RowVector2d& place_px) const;
  const std::vector<DistanceConstraint>& edges() const { return edges_; }
  /// The rectangle around the template in its texture, `control` points along u and along v.
  SplineDomain domain(int control) const;

 private:
  Result<void> prepare(const Template& templ);
  Result<void> place_grid(const Template& templ);
  std::int64_t cell_along(double px) const;
  void mark_near(const Correspondences& matches);
  std::vector<WarpPlace> places_near(const Camera& camera, const WarpSamples& samples) const;

  int grid_ = 32;
  double reach_ = 0.1;
  WarpComponent warp_{"warps/bbs"};

  std::uint64_t revision_ = 0;  ///< revision of the template to which all of this belongs
  std::vector<DistanceConstraint> edges_;
  std::vector<WarpPlace> rest_;  ///< [n] without the values of the warp
  Points2 places_px_;            ///< [n,2] px of the texture
  Eigen::RowVector2d low_px_, size_px_;
  double cell_px_ = 1.0;
  std::int64_t columns_ = 1, rows_ = 1;
  std::vector<std::uint8_t> near_;  ///< [columns * rows]
};

}  // namespace weft::solvers
