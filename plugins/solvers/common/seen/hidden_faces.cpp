// SPDX-License-Identifier: Apache-2.0
#include "common/seen/hidden_faces.hpp"

#include <string>
#include <weft/core/index.hpp>

namespace weft::solvers {

Result<void> read_hidden_faces(const Visibility& visibility, const Faces& faces,
                               Eigen::Index vertex_count, std::vector<std::uint8_t>& hidden) {
  if (visibility.visible.rows() != vertex_count) {
    return Error{Errc::invalid_data, "the visibility has " +
                                         std::to_string(visibility.visible.rows()) +
                                         " vertices, the template " + std::to_string(vertex_count) +
                                         ": use one template throughout"};
  }
  hidden.assign(to_index(faces.rows()), 1);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      const std::int32_t v = faces(f, k);
      const bool is_hidden =
          visibility.visible(v) == 0 && visibility.why(v) != SightReason::outside;
      if (!is_hidden) hidden[to_index(f)] = 0;
    }
  }
  return {};
}

}  // namespace weft::solvers
