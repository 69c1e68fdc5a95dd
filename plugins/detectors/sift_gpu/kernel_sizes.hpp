// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The constants that the kernels and their callers share; the kernels are compiled with them.
namespace weft::sift_gpu {

inline constexpr int kGroup = 32;              ///< items of a group
inline constexpr int kDescriptorLength = 128;  ///< elements
inline constexpr int kTileSide = 32;           ///< queries and trains whose distances a group finds
inline constexpr int kTileBlock = 4;           ///< side of the square of pairs that one item finds

}  // namespace weft::sift_gpu
