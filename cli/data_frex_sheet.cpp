// SPDX-License-Identifier: Apache-2.0
#include "data_frex_sheet.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <utility>
#include <weft/core/whole_file.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/marker_sheet.hpp>

#include "new_file.hpp"
#include "pdf_page.hpp"
#include "template_builder.hpp"
#include "template_picture.hpp"

namespace weft::cli {
namespace {

constexpr int kTexelsPerMm = 6;  // so that the middle of each module is inside a texel
constexpr double kBar_mm = 100.0;

/// The black modules of all markers.
void fill_modules(PdfPage& page, const MarkerSheet& sheet, int modules,
                  const Array<std::uint8_t>& texture) {
  for (const SheetMarker& marker : sheet.markers) {
    const Eigen::Vector2d corner = marker.corners_mm.row(0);
    const double side = (marker.corners_mm(1, 0) - corner.x()) / modules;
    const auto is_black = [&](int i, int j) {
      const auto texel = [](double mm) { return static_cast<std::int64_t>(mm * kTexelsPerMm); };
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
                              "sheet, {} markers {}, seed {}",
                              kBar_mm, sheet.markers.size(), sheet.dictionary, seed));
  const double x1 = sheet.width_mm - kMargin_mm, x0 = x1 - kBar_mm, y = baseline_mm - 0.8;
  for (const double x : {x0, x1}) page.draw_line(x, y - kTick_mm, x, y + kTick_mm, kLine_mm);
  page.draw_line(x0, y, x1, y, kLine_mm);
}

std::string draw_page(const MarkerSheet& sheet, const Array<std::uint8_t>& texture,
                      std::int64_t seed) {
  PdfPage page(sheet.width_mm, sheet.height_mm);
  fill_modules(page, sheet, sheet.dictionary == "4x4_250" ? 6 : 7, texture);
  add_caption(page, sheet, seed);
  return page.file();
}

Result<void> make_files(const Context& context, const FrexSheetRequest& request) {
  if (!request.pdf_path.ends_with(".pdf")) {
    return Error{Errc::invalid_value, "--sheet writes a PDF: let its name end with .pdf", {}};
  }
  MarkerSheetSpec spec;
  spec.seed = request.seed;
  const auto sheet = lay_out_markers(spec);
  if (!sheet) return sheet.error();
  const auto record = build_template(
      context.registry(),
      fmt::format("{{use: templates/frex_sheet, params: {{seed: {}, px_per_mm: {}}}}}",
                  request.seed, kTexelsPerMm));
  if (!record) return record.error();
  const auto templ = host::view_as<Template>(**record);
  if (!templ) return templ.error();
  const auto beside = [&](const char* extension) {
    return std::filesystem::path(request.pdf_path).replace_extension(extension).string();
  };
  const std::string layout_path = beside(".yaml"), picture_path = beside(".png");
  for (const std::string& name : {request.pdf_path, layout_path, picture_path}) {
    if (auto fresh = check_new_file(name, request.overwrite); !fresh) return fresh;
  }
  if (auto drawn = write_picture(context.registry(), **record, Picture::texture, picture_path);
      !drawn) {
    return drawn;
  }
  const std::pair<std::string, std::string> files[] = {
      {request.pdf_path, draw_page(*sheet, templ->texture, request.seed)},
      {layout_path, to_yaml(*sheet)}};
  for (const auto& [name, content] : files) {
    if (auto written = write_whole(content, name); !written) return written;
    fmt::print("{}\n", name);
  }
  fmt::print("{}\n", picture_path);
  return {};
}

}  // namespace

int make_frex_sheet(const Context& context, const FrexSheetRequest& request) {
  const auto made = make_files(context, request);
  if (made) return kDone;
  print_error(made.error());
  return made.error().code == Errc::io ? kInputOutput : kBadConfiguration;
}

}  // namespace weft::cli
