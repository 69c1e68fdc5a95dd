// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/shapes/alignment.hpp"

#include <weft/geometry/rigid_alignment.hpp>

namespace weft::lab {
namespace {

Result<Points3> scaled(const Points3View& estimated_m, const Points3View& truth_m) {
  const double scale = estimated_m.cwiseProduct(truth_m).sum() / estimated_m.squaredNorm();
  if (!(scale > 0.0) || !std::isfinite(scale)) {
    return no_result("no positive scale brings the estimated points closer to the truth");
  }
  return Points3(scale * estimated_m);
}

}  // namespace

const char* to_string(Alignment alignment) {
  switch (alignment) {
    case Alignment::scale:
      return "scale";
    case Alignment::rigid:
      return "rigid";
    case Alignment::none:
      break;
  }
  return "none";
}

std::optional<Alignment> alignment_of(std::string_view name) {
  for (const Alignment each : {Alignment::none, Alignment::scale, Alignment::rigid}) {
    if (name == to_string(each)) return each;
  }
  return std::nullopt;
}

Result<Points3> align_estimate(const Points3View& estimated_m, const Points3View& truth_m,
                               Alignment alignment) {
  if (alignment == Alignment::none) return Points3(estimated_m);
  if (alignment == Alignment::scale) return scaled(estimated_m, truth_m);
  const auto transform = align_points(estimated_m, truth_m);
  if (!transform) return transform.error();
  return transform_points(*transform, estimated_m);
}

}  // namespace weft::lab
