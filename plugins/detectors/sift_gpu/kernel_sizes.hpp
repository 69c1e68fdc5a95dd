// SPDX-License-Identifier: Apache-2.0
#pragma once

/// What the kernels and those who launch them must agree on; the kernels are compiled with it.
namespace weft::sift_gpu {

inline constexpr int kGroup = 32;              ///< items of a group
inline constexpr int kDescriptorLength = 128;  ///< elements
inline constexpr int kTileSide = 32;           ///< queries and trains whose distances a group finds
inline constexpr int kTileBlock = 4;           ///< of which an item finds as many by as many

}  // namespace weft::sift_gpu
