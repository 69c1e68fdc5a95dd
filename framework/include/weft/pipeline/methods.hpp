// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The methods of components that have several, by the numbers of weft/sdk/roles.hpp.
namespace weft {

inline constexpr int kOpenSource = 0, kCountFrames = 1, kReadFrame = 2;
inline constexpr int kOpenSink = 0, kWriteFrame = 1, kFinishSink = 2;

}  // namespace weft
