// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "host/records/npz.hpp"

namespace weft::lab {

inline constexpr std::size_t kMostKeptFrames = 60;
inline constexpr std::int64_t kMostKeptPoints = 120;

/// The template without its texture, which is as large as everything else together.
host::RecordPtr without_texture(const host::Record& templ);

/// A regular subset of the points of the truth, without images and surface.
host::RecordPtr thinned(const host::Record& ground_truth);

/// Shapes and truths of frames spread evenly over a run whose length need not be known: where there
/// are too many, every other one goes.
class KeptFrames {
 public:
  /// Frames count from 0; either record may be null.
  void add(std::uint64_t index, const host::RecordPtr& shape, const host::RecordPtr& truth);

  /// "NNNNNN.shape" and "NNNNNN.ground_truth".
  host::NamedRecords records() const;

 private:
  struct Frame {
    std::uint64_t index;  ///< [] index of the frame
    host::RecordPtr shape, truth;
  };
  std::uint64_t stride_ = 1;
  std::vector<Frame> frames_;
};

}  // namespace weft::lab
