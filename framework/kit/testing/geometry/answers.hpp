// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "kit/testing/contract_subject.hpp"
#include "kit/testing/geometry/moves.hpp"

namespace weft::testing {

/// The answer of a component to a scene, and its warp at points of the texture.
struct Asked {
  Answer answer;
  std::optional<Points2> warped_px{};  ///< [M,2] px, at the requested texels
};

/// Calls a new instance. Solvers get neither the last shape, nor known points, nor an optional
/// image: they must find the shape by themselves. A warp is evaluated at `texels_px`.
Asked ask(const Subject& subject, const Scene& scene, const Points2& texels_px);

/// True if it is then given an image.
bool sees_pixels(const Subject& subject);

/// Points well inside the texture, away from the borders of any grid, [25,2] px.
Points2 inner_texels(const Template& templ);

/// Evaluates at points of the texture; nothing if the warp marks a point as outside.
std::optional<Points2> warped(Performer& performer, const HostRecord& warp,
                              const Points2& texels_px);

/// How the answer of `after`, to the moved scene, is not that of `before`, moved; empty where it
/// is. Masks and flags are the same, places the same to 1e-3 mm and 1e-6 px.
std::string difference_moved(const Scene& scene, const Asked& before, const Asked& after,
                             const Move& move);

}  // namespace weft::testing
