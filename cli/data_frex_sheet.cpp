// SPDX-License-Identifier: Apache-2.0
#include "data_frex_sheet.hpp"

#include <cairo-pdf.h>
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <weft/core/whole_file.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/marker_sheet.hpp>

#include "cairo_bytes.hpp"
#include "new_file.hpp"
#include "template_builder.hpp"

namespace weft::cli {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr int kTexelsPerMm = 6;  // so that the middle of each module is inside a texel
constexpr double kBar_mm = 100.0;

/// Adds the black modules of all markers to the path, as rectangles in mm.
void add_modules(cairo_t* page, const MarkerSheet& sheet, int modules,
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
          cairo_rectangle(page, corner.x() + i * side, corner.y() + j * side, (end - i) * side,
                          side);
        }
      }
    }
  }
}

/// A line of text and a bar of known length, in the strip below the markers.
void add_caption(cairo_t* page, const MarkerSheet& sheet, std::int64_t seed) {
  constexpr double kMargin_mm = 6.0, kHeight_mm = 2.6, kTick_mm = 1.5;
  const double baseline_mm = sheet.height_mm - 4.8;
  cairo_select_font_face(page, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(page, kHeight_mm);
  cairo_move_to(page, kMargin_mm, baseline_mm);
  const std::string text = fmt::format(
      "Print at 100 %, without scaling: the bar is {:.0f} mm.   Weft FREX sheet, {} markers "
      "{}, seed {}",
      kBar_mm, sheet.markers.size(), sheet.dictionary, seed);
  cairo_show_text(page, text.c_str());
  const double x1 = sheet.width_mm - kMargin_mm, x0 = x1 - kBar_mm, y = baseline_mm - 0.8;
  cairo_set_line_width(page, 0.2);
  for (const double x : {x0, x1}) {
    cairo_move_to(page, x, y - kTick_mm);
    cairo_line_to(page, x, y + kTick_mm);
  }
  cairo_move_to(page, x0, y);
  cairo_line_to(page, x1, y);
  cairo_stroke(page);
}

/// The page as PDF; empty where Cairo failed.
std::string draw_page(const MarkerSheet& sheet, const Array<std::uint8_t>& texture,
                      std::int64_t seed) {
  std::string pdf;
  cairo_surface_t* surface = cairo_pdf_surface_create_for_stream(
      append_to_text, &pdf, sheet.width_mm * kPointsPerMm, sheet.height_mm * kPointsPerMm);
  // The same sheet is the same bytes.
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
  cairo_t* page = cairo_create(surface);
  cairo_scale(page, kPointsPerMm, kPointsPerMm);
  add_modules(page, sheet, sheet.dictionary == "4x4_250" ? 6 : 7, texture);
  cairo_fill(page);
  add_caption(page, sheet, seed);
  const bool drawn = cairo_status(page) == CAIRO_STATUS_SUCCESS;
  cairo_destroy(page);
  cairo_surface_finish(surface);
  const bool finished = cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS;
  cairo_surface_destroy(surface);
  return drawn && finished ? pdf : std::string{};
}

/// The texture as PNG, for films that are simulated; empty where Cairo failed.
std::string draw_picture(const Array<std::uint8_t>& texture) {
  const int width = static_cast<int>(texture.dim(1)), height = static_cast<int>(texture.dim(0));
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  const int stride = cairo_image_surface_get_stride(surface);
  if (unsigned char* pixels = cairo_image_surface_get_data(surface)) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) std::fill_n(pixels + y * stride + 4 * x, 3, texture(y, x));
    }
  }
  cairo_surface_mark_dirty(surface);
  std::string png = to_png(surface);
  cairo_surface_destroy(surface);
  return png;
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
  const std::filesystem::path path = request.pdf_path;
  const std::pair<std::string, std::string> files[] = {
      {path.string(), draw_page(*sheet, templ->texture, request.seed)},
      {std::filesystem::path(path).replace_extension(".yaml").string(), to_yaml(*sheet)},
      {std::filesystem::path(path).replace_extension(".png").string(),
       draw_picture(templ->texture)}};
  for (const auto& [name, content] : files) {
    if (auto fresh = check_new_file(name, request.overwrite); !fresh) return fresh;
    if (content.empty()) return Error{Errc::io, name + ": Cairo cannot draw it", {}};
  }
  for (const auto& [name, content] : files) {
    if (auto written = write_whole(content, name); !written) return written;
    fmt::print("{}\n", name);
  }
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
