// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/generators/random_deformation.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {

struct DrawnDeformation {
  Points3 vertices_m;       ///< [V,3] m, camera frame
  double max_strain = 0.0;  ///< [] of an edge
  int draws = 0;            ///< [] this one included
};

/// The first accepted deformation of a template made by make_template(sheet). no_result when
/// max_draws is used up.
Result<DrawnDeformation> draw_deformation(const SheetSpec& sheet, const Camera& camera, Rng& rng,
                                          const RandomDeformationSpec& spec = {});

}  // namespace weft::testing
