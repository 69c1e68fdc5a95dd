// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/forms/table_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

namespace weft::lab {
namespace {

/// Characters of UTF-8 text: all bytes but those that continue one.
std::size_t characters(const std::string& text) {
  return to_index(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

}  // namespace

std::string align(const std::vector<TableRow>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const TableRow& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], characters(row[i]));
    }
  }
  std::string text;
  for (const TableRow& row : rows) {
    text += fmt::format("  {:<{}}", row[0], widths[0]);
    for (std::size_t i = 1; i < row.size(); ++i) text += fmt::format("  {:>{}}", row[i], widths[i]);
    text += '\n';
  }
  return text;
}

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
      "  vertices: F1 {} % of those seen, {} % of those hidden, {} classified, {} hidden in "
      "truth\n",
      visibility.frames, decimal(visibility.visible_mm, 2), decimal(visibility.hidden_mm, 2),
      visibility.hidden_points, decimal(visibility.f1_percent, 1),
      decimal(visibility.hidden_f1_percent, 1), visibility.vertices, visibility.hidden_vertices);
}

std::string registration_text(const RegistrationMetrics& registration) {
  if (registration.frames == 0) return "";
  const std::string unmeasured =
      registration.frames_unmeasured == 0
          ? ""
          : fmt::format(" ({} others could not be measured)", registration.frames_unmeasured);
  return fmt::format(
      "registration against the flat reference, {} patches in {} frames{}\n"
      "  within 1 mm: {} %, within 2 mm: {} %, found: {} %\n"
      "  distance of those found: median {} mm, P90 {} mm\n",
      registration.patches, registration.frames, unmeasured,
      decimal(registration.within_1mm_percent, 1), decimal(registration.within_2mm_percent, 1),
      decimal(registration.found_percent, 1), decimal(registration.median_mm, 2),
      decimal(registration.p90_mm, 2));
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

}  // namespace weft::lab
