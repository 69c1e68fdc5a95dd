// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/visibility.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// [F] 1 for faces of which a visibility says that no corner is seen. A corner outside the image
/// says nothing. Fails on a visibility of another number of vertices.
Result<void> read_hidden_faces(const Visibility& visibility, const Faces& faces,
                               Eigen::Index vertex_count, std::vector<std::uint8_t>& hidden);

}  // namespace weft::solvers
