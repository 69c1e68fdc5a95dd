// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

#include "common/outline/mask_outline.hpp"
#include "common/outline/outline_term.hpp"
#include "common/seen/measurement.hpp"
#include "elasticity.hpp"
#include "solid_model.hpp"

namespace weft::volume {

/// A point of the surface and where it was seen.
struct Observation {
  BodyPoint point;
  Eigen::Vector2d seen_px;
  solvers::Whitening white;  ///< whitens the error of its image point
};

/// A point of the surface whose place is known.
struct KnownPlace {
  BodyPoint point;
  Eigen::Vector3d centre_m;
  double radius_m = 0.0;  ///< [] m, it lies within
};

/// The data of one frame.
struct FrameData {
  Pinhole camera;
  std::vector<Observation> observations;
  std::vector<KnownPlace> known;
  solvers::MaskOutline outline;  ///< absent without a mask
};

/// How far things are usually off: standard deviations.
struct Scales {
  solvers::Trust trust;
  Material material;
  double strain = 0.3;             ///< [] of a part of the body that is independent of the others
  double mean_strain = 0.04;       ///< [] of the mean over the thickness of the body
  double unevenness = 0.004;       ///< [] of nodes from a map of second degree, in radii
  double known_m = 1e-4;           ///< [] m, of a known point beyond its radius
  solvers::OutlineScales outline;  ///< distance of the rim from the outline of the mask
};

/// Number of independent parts of a body, each a sixth of the diagonal of its box wide.
double part_count(const SolidModel& body);

/// The sum of squares that the nodes x minimise,
///   (n / strain^2) sum_e v_e psi(F_e)                    deformation, psi of Material
///   + (n / mean_strain^2) sum_b v_b psi(mean F in b)     mean deformation of thick parts
///   + (n / unevenness^2) sum_b v_b U_b(x)               uneven deformation of thick parts
///   + sum_i rho(|W_i (pi(p_i(x)) - u_i)|)                observations, rho of Trust
///   + the sum of OutlineTerm                            outline of a mask
///   + sum_p ((|p(x) - c_p| - radius_p)+ / known_m)^2     known points,
/// over the tetrahedra e and the thick parts b with the shares v of the volume, and n parts
/// (part_count()). The deformations of neighbouring tetrahedra are alike, so that a finer lattice
/// is no stiffer.
class Energy {
 public:
  /// `body` must outlive it.
  void prepare(const SolidModel& body);

  /// Finds where the rim of a shape meets the outline; until then it has the points of the last
  /// one. With 30 observations or more the trace of its curvature is at most half of theirs.
  void meet_outline(const FrameData& frame, const Scales& scales, const Points3& nodes_m);
  const solvers::OutlineTerm& outline() const { return outline_; }

  /// The energy of nodes [K,3] m; infinite where an observed point is not in front of the camera.
  double value(const FrameData& frame, const Scales& scales, const Points3& nodes_m) const;

  /// The same, with half the gradient [K,3] and half the curvature, which is at least positive
  /// semidefinite.
  double linearise(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
                   Points3& gradient, solvers::BlockMatrix& matrix) const;

  /// Mean of psi over the volume.
  double mean_deformation(const Material& material, const Points3& nodes_m) const;

 private:
  /// Where derivatives go; null where only the value is wanted.
  struct Derivatives {
    Points3* gradient = nullptr;
    solvers::BlockMatrix* matrix = nullptr;
  };

  double sum(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
             const Derivatives& to) const;
  double deformed(const Scales& scales, const Points3& nodes_m, const Derivatives& to) const;
  double observed(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
                  const Derivatives& to) const;
  double outlined(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
                  const Derivatives& to) const;
  double known(const FrameData& frame, const Scales& scales, const Points3& nodes_m,
               const Derivatives& to) const;
  template <class Cell>
  double deformed(const std::vector<Cell>& cells, double strain, const Material& material,
                  const Points3& nodes_m, const Derivatives& to) const;
  double uneven(double unevenness, const Points3& nodes_m, const Derivatives& to) const;
  template <class Cell>
  void add_cell(const Cell& in, double weight, const Linearised& at, const Derivatives& to) const;
  void add_point(const BodyPoint& point, const Eigen::Vector3d& half_gradient,
                 const Eigen::Matrix3d& half_curvature, const Derivatives& to) const;

  const SolidModel* body_ = nullptr;
  solvers::OutlineTerm outline_;
  std::vector<BodyPoint> outline_points_;  ///< body points of the points of outline_
  solvers::BlockMatrix trace_matrix_;
};

}  // namespace weft::volume
