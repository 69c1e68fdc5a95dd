// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/cluster/submission.hpp"

namespace weft::cluster {

/// How large the work of one task is.
struct ChunkSize {
  double minutes = 10.0;       ///< [min] that a task is to take
  double cell_seconds = 30.0;  ///< [s] that a cell takes
  int processes = 1;           ///< processes of a task
};

/// Cuts groups into chunks of about this size, in their order. A group stays whole where it is no
/// longer than what one process has time for: its cells share work.
std::vector<Chunk> cut_into_chunks(const std::vector<Group>& groups, const ChunkSize& size);

}  // namespace weft::cluster
