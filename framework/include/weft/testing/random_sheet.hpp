// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/generators/random_deformation.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {

struct DrawnDeformation {
  Points3 vertices_m;       ///< [V,3] m, camera frame
  double max_strain = 0.0;  ///< [] largest edge strain |l / l0 - 1|
  int draws = 0;            ///< [] number of draws, including this one
};

/// The first accepted deformation of a template from make_template(). Returns no_result after
/// max_draws.
Result<DrawnDeformation> draw_deformation(const SheetSpec& sheet, const Camera& camera, Rng& rng,
                                          const RandomDeformationSpec& spec = {});

}  // namespace weft::testing
