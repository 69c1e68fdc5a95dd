// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/monitor/normal_equations.hpp"

namespace weft {

/// Deviations of a set-up from its description. The focal lengths are fx exp(focal - aspect) and fy
/// exp(focal + aspect). The lens moves a point at radius r, in normalised coordinates, to r (1 +
/// lens r^2). The principal point is off by (fx centre_x, fy centre_y). Lengths on the template are
/// 1 + keystone_x x + keystone_y y + barrel (x^2 + y^2) times as long, x and y from -1 to 1 over
/// the texture. The last three are there because no template is exact to a per cent: a keystone
/// looks like the perspective of a flat surface, a barrel like a lens.
enum Part : std::uint8_t {
  kFocal,
  kAspect,
  kLens,
  kCentreX,
  kCentreY,
  kKeystoneX,
  kKeystoneY,
  kBarrel
};
/// Evidence of frames about the deviation; frames add up. A strain of the surface is the rival
/// explanation; it is 0 unless free_strain() sets it. Edges along the width are 1 + strain(0) times
/// as long, those along the height 1 - strain(0) times, and those along the diagonal 1 + strain(1)
/// times. A strain that is the same in all directions is a matter of scale, which no image shows.
struct CameraEvidence {
  PartMatrix information = PartMatrix::Zero();  ///< inverse covariance of the deviation
  PartVector weighted = PartVector::Zero();     ///< information times deviation
  PartsByStrains cross = PartsByStrains::Zero();
  StrainMatrix strain_information = StrainMatrix::Zero();
  StrainVector strain_weighted = StrainVector::Zero();

  void add(const CameraEvidence& other) {
    information += other.information;
    weighted += other.weighted;
    cross += other.cross;
    strain_information += other.strain_information;
    strain_weighted += other.strain_weighted;
  }

  /// Adds the evidence of the equations about the strain. They are solved, at that deviation.
  void add_strain(const NormalEquations& equations, const PartVector& deviation);

  /// The remaining evidence if the surface may have a strain of that standard deviation. Evidence
  /// about a further strain, which this evidence shares with others, remains too.
  CameraEvidence free_strain(double std) const;
};

/// Prior of a deviation before any frame is seen: 0, with these standard deviations.
inline PartVector prior_std() {
  return (PartVector() << 0.7, 0.3, 0.5, 0.1, 0.1, 0.01, 0.01, 0.01).finished();
}

/// The likeliest deviation and its covariance.
struct CameraDeviation {
  PartVector mean = PartVector::Zero();
  PartMatrix covariance = PartMatrix::Zero();

  PartVector stds() const { return covariance.diagonal().cwiseSqrt(); }

  static CameraDeviation of(const CameraEvidence& evidence);
};

}  // namespace weft
