// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tests/matched_scene.hpp"

namespace weft::brunet_refine {

inline constexpr const char* kId = "solvers/brunet_refine";
using Scene = solvers::SceneOf<kId>;

}  // namespace weft::brunet_refine
