// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/registration_metrics.hpp"

#include <cmath>
#include <weft/core/statistics.hpp>

namespace weft::lab {
namespace {

double percent_of(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? kPercent * static_cast<double>(part) / static_cast<double>(whole) : kUnknown;
}

}  // namespace

FrameRegistration frame_registration(const Registration& measured) {
  FrameRegistration frame;
  frame.patches = measured.count();
  for (std::int64_t i = 0; i < measured.count(); ++i) {
    if (measured.found(i) == 0) continue;
    const double mm = std::hypot(measured.displacement_mm(i, 0), measured.displacement_mm(i, 1));
    frame.distances_mm.push_back(mm);
    ++frame.found;
    frame.within_1mm += mm <= 1.0;
    frame.within_2mm += mm <= 2.0;
  }
  frame.within_1mm_percent = percent_of(frame.within_1mm, frame.patches);
  frame.within_2mm_percent = percent_of(frame.within_2mm, frame.patches);
  frame.found_percent = percent_of(frame.found, frame.patches);
  frame.median_mm = median(frame.distances_mm);
  frame.p90_mm = percentile(frame.distances_mm, 90.0);
  return frame;
}

RegistrationMetrics summarise_registration(const std::vector<FrameRegistration>& frames,
                                           std::int64_t all_frames) {
  RegistrationMetrics metrics;
  if (frames.empty()) return metrics;
  metrics.frames = static_cast<std::int64_t>(frames.size());
  metrics.frames_unmeasured = all_frames - metrics.frames;
  std::int64_t found = 0, within_1mm = 0, within_2mm = 0;
  std::vector<double> distances_mm;
  for (const FrameRegistration& frame : frames) {
    metrics.patches += frame.patches;
    found += frame.found;
    within_1mm += frame.within_1mm;
    within_2mm += frame.within_2mm;
    distances_mm.insert(distances_mm.end(), frame.distances_mm.begin(), frame.distances_mm.end());
  }
  metrics.within_1mm_percent = percent_of(within_1mm, metrics.patches);
  metrics.within_2mm_percent = percent_of(within_2mm, metrics.patches);
  metrics.found_percent = percent_of(found, metrics.patches);
  metrics.median_mm = median(distances_mm);
  metrics.p90_mm = percentile(distances_mm, 90.0);
  return metrics;
}

}  // namespace weft::lab
