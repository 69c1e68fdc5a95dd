// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/data/visibility.hpp>

#include "evidence.hpp"
#include "sight.hpp"

namespace weft::self_occlusion {

/// When a vertex changes sides.
struct Rules {
  double memory = 0.4;      ///< [] weight of the previous score
  double hide_below = 0.3;  ///< [] a seen vertex is hidden below this score ...
  double show_above = 0.7;  ///< [] ... and a hidden one seen above this
};

/// The findings of the matches of a frame.
struct MatchFindings {
  Evidence evidence;
  std::vector<std::uint8_t> unconfirmed;  ///< [V] 1 where nothing is recognised
};

/// Joins the evidence of the geometry, the matches and the previous frame. A vertex confirmed by
/// matches is visible. One without the expected matches is unconfirmed and not visible. Otherwise,
/// with s the score of this frame and s' the previous one, s_t = (1 - memory) s + memory s'. A
/// visible vertex stays so until s_t < hide_below in two frames in a row, or in one if no match
/// lies around it. A hidden one stays so until s_t > show_above. Without a previous frame the
/// geometry decides. Being inside the image needs no memory. A vertex without evidence keeps its
/// side. `evidence` is absent without matches.
Visibility settle(const Sight& sight, const std::optional<MatchFindings>& by_matches,
                  const std::optional<Visibility>& previous, const Rules& rules);

}  // namespace weft::self_occlusion
