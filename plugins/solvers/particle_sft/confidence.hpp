// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/correspondences.hpp>
#include <weft/geometry/camera_model.hpp>

#include "fit.hpp"

namespace weft::particle_sft {

/// Matches that were kept, and those of them that a shape explains.
struct Agreement {
  int kept = 0;      ///< []
  int agreeing = 0;  ///< [] seen within 3 px of their place on the shape
};

Agreement agreement(const Correspondences& matches, const MeshModel& mesh, const Pinhole& camera,
                    const Points3& vertices_m);

/// The same where no matches are wired: of the sightlines.
Agreement agreement(const ParticleSystem& system, const Pinhole& camera, const Points3& vertices_m);

/// The probability that the mean error of what the camera sees is below 2 % of the template's
/// diagonal: a logistic fitted to shapes of which the truth is known, see README.md.
double confidence(const Fit& fit, const Agreement& agreement);

}  // namespace weft::particle_sft
