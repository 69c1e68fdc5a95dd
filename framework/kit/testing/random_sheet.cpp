// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/testing/random_sheet.hpp>

namespace weft::testing {

Result<DrawnDeformation> draw_deformation(const SheetSpec& sheet, const Camera& camera, Rng& rng,
                                          const RandomDeformationSpec& spec) {
  const auto deformer = SheetDeformer::create(sheet.columns, sheet.rows,
                                              make_template(sheet).vertices_m.matrix<3>(), spec);
  if (!deformer) throw std::invalid_argument(deformer.error().message);
  for (int draw = 1; draw <= spec.max_draws; ++draw) {
    RandomDeformation drawn = deformer->draw(camera, rng);
    if (drawn.accepted)
      return DrawnDeformation{std::move(drawn.vertices_m), drawn.max_strain, draw};
  }
  return no_result("no deformation within the limits in " + std::to_string(spec.max_draws) +
                   " draws");
}

}  // namespace weft::testing
