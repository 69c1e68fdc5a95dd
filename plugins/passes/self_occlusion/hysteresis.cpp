// SPDX-License-Identifier: Apache-2.0
#include "hysteresis.hpp"

#include <cstddef>
#include <weft/core/index.hpp>

namespace weft::self_occlusion {
namespace {

constexpr double kUndecided = 0.5;

/// The evidence for one vertex in this frame.
struct Finding {
  SightReason reason = SightReason::seen;
  double score = 0.0;
  bool known = true, confirmed = false, lacks_matches = false;
};

Finding finding_of(const Sight& sight, const std::optional<MatchFindings>& by_matches,
                   std::size_t v) {
  Finding found{sight.reason[v], sight.score[v], sight.known[v] != 0, false, false};
  if (!by_matches || found.reason == SightReason::outside) return found;
  found.lacks_matches = by_matches->evidence.around[v] == 0;
  if (by_matches->evidence.confirmed[v] != 0) return {SightReason::seen, 1.0, true, true, false};
  if (by_matches->unconfirmed[v] != 0) found.reason = SightReason::unconfirmed;
  return found;
}

struct Judged {
  bool visible;
  double score;
};

Judged judge(const Finding& found, const std::optional<Visibility>& previous, std::int64_t v,
             const Rules& rules) {
  if (found.reason == SightReason::outside) return {false, 0.0};
  if (found.confirmed) return {true, 1.0};
  if (found.reason == SightReason::unconfirmed) return {false, 0.0};
  if (!previous || previous->why(v) == SightReason::outside) {
    if (!found.known) return {true, kUndecided};
    return {found.reason == SightReason::seen, found.score};
  }
  const bool was_visible = previous->visible(v) != 0;
  if (!found.known) return {was_visible, previous->score(v)};
  const double score = (1.0 - rules.memory) * found.score + rules.memory * previous->score(v);
  if (!was_visible) return {score > rules.show_above, score};
  const bool twice = previous->score(v) < rules.hide_below || found.lacks_matches;
  return {!(score < rules.hide_below && twice), score};
}

}  // namespace

Visibility settle(const Sight& sight, const std::optional<MatchFindings>& by_matches,
                  const std::optional<Visibility>& previous, const Rules& rules) {
  const auto count = static_cast<std::int64_t>(sight.reason.size());
  Visibility result;
  result.visible = Array<std::uint8_t>({count});
  result.score = Array<double>({count});
  result.reason = Array<std::uint8_t>({count});
  int overruled = 0, unconfirmed = 0, visible = 0;
  for (std::int64_t v = 0; v < count; ++v) {
    const auto i = to_index(v);
    const Finding found = finding_of(sight, by_matches, i);
    const Judged judged = judge(found, previous, v, rules);
    SightReason reason = found.reason;
    if (judged.visible) {
      reason = SightReason::seen;
    } else if (reason == SightReason::seen) {  // kept from before
      reason = previous ? previous->why(v) : SightReason::hidden;
    }
    result.visible(v) = judged.visible ? 1 : 0;
    result.score(v) = judged.score;
    result.reason(v) = static_cast<std::uint8_t>(reason);
    visible += judged.visible ? 1 : 0;
    unconfirmed += reason == SightReason::unconfirmed ? 1 : 0;
    overruled += found.confirmed && sight.reason[i] != SightReason::seen ? 1 : 0;
  }
  result.diag.set("visible", visible);
  result.diag.set("unconfirmed", unconfirmed);
  result.diag.set("overruled_by_matches", overruled);
  return result;
}

}  // namespace weft::self_occlusion
