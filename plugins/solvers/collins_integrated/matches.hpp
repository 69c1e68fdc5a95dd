// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/correspondences.hpp>

#include "energy.hpp"
#include "mesh_model.hpp"

namespace weft::collins_integrated {

/// The kept matches that lie on faces which are not hidden. Each has its own covariance and 0.25 px
/// beside it, where there is one, else `noise_px` along u and v. Fails on faces that the mesh
/// lacks, on numbers that are not finite and on covariances that are none.
Result<void> read_matches(const Correspondences& matches, const MeshModel& mesh, double noise_px,
                          const std::vector<std::uint8_t>& hidden_faces,
                          std::vector<Observation>& observations);

}  // namespace weft::collins_integrated
