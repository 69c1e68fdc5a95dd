// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tests/sightline_scene.hpp"

namespace weft::gauss_newton {

inline constexpr const char* kId = "solvers/gauss_newton";
inline constexpr std::uint64_t kSeed = 20240917;

using solvers::BentPose;
using solvers::known_points;
using solvers::reference_camera;
using solvers::reference_poses;
using solvers::reference_sheet;
using solvers::shape_of;
using Scene = solvers::SightlineScene;

}  // namespace weft::gauss_newton
