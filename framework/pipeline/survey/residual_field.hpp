// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/rigid_alignment.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// How far texture coordinates are off at matches with an object at rest.
struct TextureResiduals {
  Points2 at_px;   ///< [N,2] px of the texture: where the mesh has what a match shows
  Points2 off_px;  ///< [N,2] px: where the match has it, minus at_px
};

/// Residuals of the kept matches. The distance in the image from where the pose has a match is
/// converted into one in the texture by the inverse of d(image)/d(texture) there. Matches on faces
/// that are seen under less than about 12 degrees are omitted.
TextureResiduals texture_residuals(const Template& templ, const Camera& camera,
                                   const Correspondences& matches,
                                   const RigidAlignment& camera_from_template);

/// The residuals of several frames together.
TextureResiduals joined(const TextureResiduals& a, const TextureResiduals& b);

/// The smooth part of the residuals: a bicubic B-spline over the object's box in the texture,
/// fitted robustly. The weight of the bending energy is chosen by two-fold cross-validation.
struct ResidualField {
  SplineDomain domain;
  Points2 control_px;                                    ///< [nu*nv,2]
  std::int64_t matches = 0;                              ///< [] that it was fitted to
  double rms_px = 0.0;                                   ///< RMS of the field at the matches
  double most_px = 0.0;                                  ///< largest value of the field at a match
  Eigen::Vector2d most_at_px = Eigen::Vector2d::Zero();  ///< where that is
  double noise_px = 0.0;                                 ///< rms of what the field leaves
  double predicted = 0.0;  ///< share of the squares of left-out residuals that others predict

  /// Correction of texture coordinates, px.
  Eigen::Vector2d operator()(const Eigen::Vector2d& at_px) const;
  /// True if texture coordinates are off: by a pixel or more, and not by noise.
  bool is_coherent() const;
};

/// Nothing for fewer than 60 residuals.
std::optional<ResidualField> fit_residual_field(const Template& templ,
                                                const TextureResiduals& residuals);

/// The template with corrected texture coordinates, within its image.
Template corrected(const Template& templ, const ResidualField& field);

}  // namespace weft
