// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/chunks.hpp"

#include <algorithm>
#include <cmath>

namespace weft::cluster {

std::vector<Chunk> cut_into_chunks(const std::vector<Group>& groups, const ChunkSize& size) {
  constexpr double kMost = 1e6;
  const double fit = std::floor(size.minutes * 60.0 / size.cell_seconds);
  const auto of_process = static_cast<std::size_t>(std::clamp(fit, 1.0, kMost));
  const std::size_t of_task = of_process * static_cast<std::size_t>(size.processes);
  std::vector<Chunk> chunks;
  std::size_t room = 0;  // [cells] in the last chunk
  for (const Group& group : groups) {
    for (std::size_t first = 0; first < group.size(); first += of_process) {
      const std::size_t last = std::min(first + of_process, group.size());
      const Group piece(group.begin() + static_cast<std::ptrdiff_t>(first),
                        group.begin() + static_cast<std::ptrdiff_t>(last));
      if (piece.size() > room) {
        chunks.emplace_back();
        room = of_task;
      }
      chunks.back().push_back(piece);
      room -= piece.size();
    }
  }
  return chunks;
}

}  // namespace weft::cluster
