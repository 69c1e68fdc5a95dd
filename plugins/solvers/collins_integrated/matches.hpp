// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/visibility.hpp>

#include "energy.hpp"
#include "mesh_model.hpp"

namespace weft::collins_integrated {

/// The kept matches that lie on faces which are not hidden. Each has its own covariance and 0.25 px
/// beside it, where there is one, else `noise_px` along u and v. Fails on faces that the mesh
/// lacks, on numbers that are not finite and on covariances that are none.
Result<void> read_matches(const Correspondences& matches, const MeshModel& mesh, double noise_px,
                          const std::vector<std::uint8_t>& hidden_faces,
                          std::vector<Observation>& observations);

/// [F] 1 for faces of which a visibility says that no corner is seen, those outside the image not
/// counted. Fails on a visibility of another mesh.
Result<void> read_hidden_faces(const Visibility& visibility, const MeshModel& mesh,
                               std::vector<std::uint8_t>& hidden_faces);

/// Whether points lie on a line of the image, or in one place.
bool lie_on_a_line(const std::vector<Observation>& observations);

}  // namespace weft::collins_integrated
