// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <weft/data/shape.hpp>

namespace weft::stream {

/// The content of one frame that readers receive.
struct FramePoints {
  std::uint64_t frame;  ///< [] of the source, from 0
  double time_s;        ///< [] s since the first frame; NaN where the source gives none
  const Shape& shape;
  bool covariance;  ///< true if the covariance of the shape, if it has one, is part of the message
};

/// One line of JSON, with its end; numbers are the shortest that read back as the same double.
std::string json_line(const FramePoints& points);

/// The same in bytes, as the table in the README has them: little-endian, sizes first.
std::string packed(const FramePoints& points);

}  // namespace weft::stream
