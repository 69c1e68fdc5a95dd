// SPDX-License-Identifier: Apache-2.0
#include "cli/data/data_frex_sheet.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <utility>
#include <weft/core/whole_file.hpp>
#include <weft/data/template.hpp>
#include <weft/generators/marker_sheet.hpp>

#include "cli/output/new_file.hpp"
#include "cli/template/template_builder.hpp"
#include "cli/template/template_picture.hpp"
#include "lab/printing/marker_page.hpp"

namespace weft::cli {
namespace {

constexpr int kTexelsPerMm = 6;  // so that the middle of each module is inside a texel
Result<void> make_files(const Context& context, const FrexSheetRequest& request) {
  if (!request.pdf_path.ends_with(".pdf")) {
    return Error{Errc::invalid_value, "--sheet writes a PDF: let its name end with .pdf"};
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
      {request.pdf_path, marker_page(*sheet, templ->texture, kTexelsPerMm, request.seed)},
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
