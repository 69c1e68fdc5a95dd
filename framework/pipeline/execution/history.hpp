// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "host/records/record.hpp"
#include "pipeline/graph/graph.hpp"

namespace weft {

/// Records that the graph may read back: for each type the record after each of the last frames,
/// which is the last one produced until then.
class History {
 public:
  /// Keeps as many frames of each type as the graph looks back.
  explicit History(const Graph& graph);

  /// The record of "previous.T" as it stood `lag` frames before the frame `place`, counted from 0;
  /// null when there was none. That frame has been remembered, the frame `place` has not. From any
  /// thread.
  host::RecordPtr find(const std::string& slot, int lag, std::uint64_t place) const;

  /// The frame's values become the past; an absent one leaves the one before it.
  void remember(std::span<const host::RecordPtr> values);

  /// As if no frame had been.
  void forget();

 private:
  struct Past {
    std::size_t depth = 0;            ///< [frames]
    std::vector<std::size_t> values;  ///< indices into Graph::values of the values that become it
    std::vector<host::RecordPtr> frames;  ///< the latest first, none before the first record
  };
  mutable std::mutex mutex_;
  std::uint64_t remembered_ = 0;         ///< [frames]
  std::map<std::string, Past> by_slot_;  ///< "previous.shape"
};

}  // namespace weft
