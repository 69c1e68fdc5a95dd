// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>
#include <weft/core/result.hpp>

#include "grid_nodes.hpp"
#include "small_frame.hpp"

namespace weft::shards {

/// Samples that are written together, as a folder with one NumPy file for each array.
class Shard {
 public:
  Shard(const SampleFormat& format, std::int64_t nodes) : format_(format), nodes_(nodes) {}

  void add(const std::vector<std::uint8_t>& image, const CellLabels& labels,
           const GridNodes::Places& places);
  std::int64_t count() const { return count_; }

  /// The folder appears whole: its files are written beside it, under a temporary name.
  Result<void> write(const std::filesystem::path& folder) const;
  void clear();

 private:
  SampleFormat format_;
  std::int64_t nodes_, count_ = 0;
  std::vector<std::uint8_t> image_, mask_, visible_;
  std::vector<std::uint16_t> uv_, depth_;
  std::vector<float> vertices_m_;
};

}  // namespace weft::shards
