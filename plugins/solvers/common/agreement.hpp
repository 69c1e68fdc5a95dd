// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/data/correspondences.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// Matches that were kept, and those of them that a shape explains.
struct Agreement {
  int kept = 0;      ///< []
  int agreeing = 0;  ///< [] seen within 3 px of their place on the shape
};

Agreement agreement(const Correspondences& matches, const Faces& faces, const Pinhole& camera,
                    const Points3& vertices_m);

/// The same where no matches are wired: of the sightlines that count.
Agreement agreement(const Sightlines& lines, const Faces& faces, const Pinhole& camera,
                    const Points3& vertices_m);

/// A filter may know of a likelier place for the object, such as a copy of it: what it said, or 1.
double confidence_of_filters(const std::optional<Correspondences>& matches);

/// 1 / (1 + exp(-logit))
double logistic(double logit);

}  // namespace weft::solvers
