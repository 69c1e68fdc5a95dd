// SPDX-License-Identifier: Apache-2.0
#include "metrics/forms/table_parts.hpp"

#include <fmt/format.h>

#include <cmath>

namespace weft::evaluation {

std::string printable(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text;
}

std::string decimal(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : kNoValue;
}

std::string visibility_text(const VisibilityMetrics& visibility) {
  if (visibility.hidden_points + visibility.vertices == 0) return "";
  return fmt::format(
      "what the camera sees, {} frames\n"
      "  3D error: {} mm at visible points, {} mm at the {} hidden ones\n"
      "  vertices: F1 {} % of those seen, {} % of those hidden, {} told, {} hidden in truth\n",
      visibility.frames, decimal(visibility.visible_mm, 2), decimal(visibility.hidden_mm, 2),
      visibility.hidden_points, decimal(visibility.f1_percent, 1),
      decimal(visibility.hidden_f1_percent, 1), visibility.vertices, visibility.hidden_vertices);
}

std::string certainty_text(const CertaintyMetrics& certainty) {
  if (certainty.frames == 0) return "";
  std::string text = fmt::format(
      "confidence, {} solved frames\n"
      "  Brier score {}; {} frames within 2 % of the diagonal; {} silently wrong\n",
      certainty.frames, decimal(certainty.brier, 3), certainty.right, certainty.silently_wrong);
  if (certainty.vertices == 0) return text;
  const auto& within = certainty.within_percent;
  return text + fmt::format("  within 1, 2, 3 standard deviations: {}, {}, {} % of {} vertices\n",
                            decimal(within[0], 1), decimal(within[1], 1), decimal(within[2], 1),
                            certainty.vertices);
}

}  // namespace weft::evaluation
