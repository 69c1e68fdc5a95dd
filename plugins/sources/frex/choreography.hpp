// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/geometry/types.hpp>

#include "common/scene/cloth.hpp"
#include "cross_section.hpp"
#include "film/sways.hpp"
#include "handle_pair.hpp"
#include "rest_sheet.hpp"

namespace weft::frex {

/// The deformation of the surface.
enum class Pattern { roll, s_bend, corner_fold, wave, handles, bulge, folds };

struct MotionSettings : SwaySettings {
  Pattern pattern = Pattern::wave;
  double bend = 1.0;     ///< [] size of the deformation, 1 is usual
  double stretch = 0.0;  ///< [] largest elastic strain
};

/// The target places of a surface and its lengths at each time. At time 0 it is at rest and faces
/// the camera. A surface that is curved about one direction at rest is bent about that one. Any
/// other that is not flat moves with the pattern of the plane, as a point beside it. Functions of
/// time alone.
class Choreography {
 public:
  Choreography(const MotionSettings& settings, const RestSheet& sheet);

  /// The surface [V,3] m whose edge lengths are those of the object at time t: the rest shape,
  /// stretched or bulged.
  Points3 lengths_at(double t_s) const;
  /// The guides of the surface, in the camera frame. The surface that the pattern describes pulls
  /// each vertex softly, and two patches of `handles` more firmly.
  std::vector<scene::ClothGuide> guides_at(double t_s) const;
  /// The surface at time 0 [V,3] m, camera frame.
  Points3 start() const;

 private:
  Choreography(const MotionSettings& settings, const RestSheet& sheet, Rng rng);
  double share_at(double t_s) const;
  double grown_at(double t_s) const;
  double phase_at(double t_s) const;
  Points2 stretched(double t_s) const;
  double extent_m(double ruling_rad) const;
  double curvature_per_m(double s_m, double t_s, const HandlePair::Pose& hands) const;
  Points3 bent(const Points2& flat_m, double t_s) const;
  Points3 bulged(const Points2& flat_m, double t_s) const;
  Points3 folded(const Points2& flat_m, double t_s) const;
  Points3 surface_at(double t_s) const;

  MotionSettings settings_;
  Sways sways_;
  std::vector<bool> in_hand_;  ///< [V]
  std::optional<CrossSection> section_;
  Points2 centred_m_;         ///< [V,2] surface at rest, unrolled if it has a cross-section,
                              ///< measured from its middle
  Points3 rest_m_;            ///< [V,3] surface at rest if it has a cross-section, else empty
  Eigen::VectorXd behind_m_;  ///< [V] how far it is behind the plane; 0 for a flat surface
  Eigen::Vector2d half_m_;    ///< half its width and height
  double ruling_rad_ = 0.0;   ///< direction across which the surface is curved
  double sign_ = 1.0;         ///< which way it is curved
  Eigen::Vector2d apex_m_ = Eigen::Vector2d::Zero();  ///< from which folds run, from the middle
  double folds_rad_ = 0.0;                            ///< where they begin in their period
  std::optional<HandlePair> handles_;
};

}  // namespace weft::frex
