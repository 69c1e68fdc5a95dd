// SPDX-License-Identifier: Apache-2.0
#include "outline_term.hpp"

#include <limits>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

constexpr double kContourShare = 0.5;
constexpr double kAlike = 0.7071;  // cosine
constexpr double kReachPerLimit = 1.25;

}  // namespace

void OutlineTerm::forget() {
  points_.clear();
  missed_ = 0.0;
  rim_met_ = rim_missed_ = 0;
  share = 1.0;
}

double OutlineTerm::met_share() const {
  const auto all = static_cast<double>(rim_met_ + rim_missed_);
  return all > 0.0 ? static_cast<double>(rim_met_) / all : 0.0;
}

void OutlineTerm::meet_rim(const MaskOutline& outline, const OutlineScales& scales,
                           const std::vector<RimPoint>& rim) {
  const double per_px = 1.0 / scales.noise_px;
  loss_.limit = std::max(scales.outlier_px, kReachPerLimit * scales.reach_px) * per_px;
  for (std::size_t b = 0; b < rim.size(); ++b) {
    worked(static_cast<std::int64_t>(scales.reach_px));
    const auto crossing = outline.cross(rim_px_[b], rim[b].outwards, scales.reach_px);
    if (crossing.found == MaskOutline::Found::unknown) continue;
    if (crossing.found == MaskOutline::Found::none) {
      missed_ += 1.0;
      ++rim_missed_;
      continue;
    }
    ++rim_met_;
    const double offset_px = rim[b].outwards.dot(rim_px_[b]) + crossing.distance_px;
    points_.push_back({rim[b].face, rim[b].weights, rim[b].outwards, offset_px, 1.0});
  }
  meet_contour(outline, scales.reach_px, rim);
}

void OutlineTerm::meet_contour(const MaskOutline& outline, double reach_px,
                               const std::vector<RimPoint>& rim) {
  for (const ContourPoint& seen : outline.contour()) {
    worked(static_cast<std::int64_t>(rim.size() / 8 + 1));
    double nearest2 = reach_px * reach_px;
    std::size_t found = rim.size();
    for (std::size_t b = 0; b < rim.size(); ++b) {
      const double distance2 = (rim_px_[b] - seen.place_px).squaredNorm();
      if (distance2 > nearest2 || rim[b].outwards.dot(seen.outwards) < kAlike) continue;
      nearest2 = distance2;
      found = b;
    }
    if (found == rim.size()) {
      missed_ += kContourShare;
      continue;
    }
    points_.push_back({rim[found].face, rim[found].weights, seen.outwards,
                       seen.outwards.dot(seen.place_px), kContourShare});
  }
}

}  // namespace weft::solvers
