// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/visibility.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// [F] 1 for faces without a visible corner in a visibility record. A corner outside the image does
/// not count. Fails on a visibility of another number of vertices.
Result<void> read_hidden_faces(const Visibility& visibility, const Faces& faces,
                               Eigen::Index vertex_count, std::vector<std::uint8_t>& hidden);

}  // namespace weft::solvers
