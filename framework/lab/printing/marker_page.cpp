// SPDX-License-Identifier: Apache-2.0
#include "lab/printing/marker_page.hpp"

#include <fmt/core.h>

#include "lab/printing/pdf_page.hpp"

namespace weft {
namespace {

constexpr double kBar_mm = 100.0;

/// The black modules of all markers.
void fill_modules(PdfPage& page, const MarkerSheet& sheet, int modules, int texels_per_mm,
                  const Array<std::uint8_t>& texture) {
  for (const SheetMarker& marker : sheet.markers) {
    const Eigen::Vector2d corner = marker.corners_mm.row(0);
    const double side = (marker.corners_mm(1, 0) - corner.x()) / modules;
    const auto is_black = [&](int i, int j) {
      const auto texel = [&](double mm) { return static_cast<std::int64_t>(mm * texels_per_mm); };
      return texture(texel(corner.y() + (j + 0.5) * side), texel(corner.x() + (i + 0.5) * side)) <
             128;
    };
    for (int j = 0; j < modules; ++j) {
      for (int i = 0, end = 0; i < modules; i = end + 1) {
        for (end = i; end < modules && is_black(end, j);) ++end;
        if (end > i) {
          page.fill_rectangle(corner.x() + i * side, corner.y() + j * side, (end - i) * side, side);
        }
      }
    }
  }
}

/// A line of text and a bar of known length, in the strip below the markers.
void add_caption(PdfPage& page, const MarkerSheet& sheet, std::int64_t seed) {
  constexpr double kMargin_mm = 6.0, kHeight_mm = 2.6, kTick_mm = 1.5, kLine_mm = 0.2;
  const double baseline_mm = sheet.height_mm - 4.8;
  page.write_text(kMargin_mm, baseline_mm, kHeight_mm,
                  fmt::format("Print at 100 %, without scaling: the bar is {:.0f} mm.   Weft FREX "
                              "page, {} markers {}, seed {}",
                              kBar_mm, sheet.markers.size(), sheet.dictionary, seed));
  const double x1 = sheet.width_mm - kMargin_mm, x0 = x1 - kBar_mm, y = baseline_mm - 0.8;
  for (const double x : {x0, x1}) page.draw_line(x, y - kTick_mm, x, y + kTick_mm, kLine_mm);
  page.draw_line(x0, y, x1, y, kLine_mm);
}

}  // namespace

std::string marker_page(const MarkerSheet& sheet, const Array<std::uint8_t>& texture,
                        int texels_per_mm, std::int64_t seed) {
  PdfPage page(sheet.width_mm, sheet.height_mm);
  fill_modules(page, sheet, sheet.dictionary == "4x4_250" ? 6 : 7, texels_per_mm, texture);
  add_caption(page, sheet, seed);
  return page.file();
}

}  // namespace weft
