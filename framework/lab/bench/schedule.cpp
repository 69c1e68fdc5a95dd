// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/schedule.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft::bench {
namespace {

/// The pipelines in the order of a block: rotated, and turned around every other time.
std::vector<std::size_t> order_of(std::int64_t number, std::size_t pipelines) {
  std::vector<std::size_t> order(pipelines);
  for (std::size_t i = 0; i < pipelines; ++i) order[i] = (i + to_index(number)) % pipelines;
  // Two pipelines already alternate by rotation.
  if (pipelines > 2 && (to_index(number) / pipelines) % 2 == 1) {
    std::reverse(order.begin(), order.end());
  }
  return order;
}

}  // namespace

std::vector<Turn> schedule(const Settings& settings, std::size_t pipelines) {
  std::vector<Turn> turns;
  std::int64_t number = 0;
  for (int repetition = 0; repetition < settings.repetitions; ++repetition) {
    for (std::int64_t at = 0; at < settings.frames; at += settings.block, ++number) {
      const std::int64_t first = at == 0 ? 0 : settings.warmup + at;
      const std::int64_t end = settings.warmup + std::min(at + settings.block, settings.frames);
      for (const std::size_t pipeline : order_of(number, pipelines)) {
        turns.push_back({number, repetition, pipeline, first, end});
      }
    }
  }
  return turns;
}

}  // namespace weft::bench
