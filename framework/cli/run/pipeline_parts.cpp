// SPDX-License-Identifier: Apache-2.0
#include "cli/run/pipeline_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <weft/core/text_file.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/images/image_file.hpp>

#include "cli/standard_components.hpp"
#include "lab/schema/schema.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

Result<void> copy_into(const std::string& folder, const std::vector<Copy>& files) {
  for (const Copy& copy : files) {
    std::error_code code;
    fs::copy_file(copy.file, folder + "/" + copy.name, code);
    if (!code) continue;
    return Error{Errc::io, "cannot be copied into " + folder + ": " + code.message(), copy.file};
  }
  return {};
}

std::string name_beside(const std::string& name, const std::string& file) {
  return name + fs::path(file).extension().string();
}

}  // namespace

std::string pipeline_head(const std::string& comment) {
  return fmt::format("# yaml-language-server: $schema={}\n# {}\nweft: 1\n", kPipelineSchema,
                     comment);
}

Result<ImageHeader> picture_header(const std::string& path) {
  const auto file = read_image_bytes(path);
  if (!file) return file.error();
  if (file->header.width_px > 0) return file->header;
  return Error{Errc::invalid_data, "is no readable image: give a PNG or JPEG", path};
}

Result<TemplateKey> flat_template(const std::string& picture, double width_m, int cells) {
  const auto header = picture_header(picture);
  if (!header) return header.error();
  const auto width = static_cast<double>(header->upright_width_px());
  const auto height = static_cast<double>(header->upright_height_px());
  const double cell = std::max(width, height) / cells;
  const auto count = [&](double side) { return std::max(3L, std::lround(side / cell) + 1); };
  const std::string texture = name_beside("texture", picture);
  return TemplateKey{fmt::format("template:\n  use: templates/rectangular\n"
                                 "  params: {{texture: {}, width_m: {}, columns: {}, rows: {}}}\n",
                                 flow_quoted(texture), width_m, count(width), count(height)),
                     {{picture, texture}}};
}

TemplateKey photo_template_key(const std::string& photo, double width_m, const std::string& more) {
  const std::string name = name_beside("object", photo);
  return {fmt::format("template:\n  use: {}\n  params: {{photo: {}, width_m: {}{}}}\n",
                      photo_template(), flow_quoted(name), width_m, more),
          {{photo, name}}};
}

TemplateKey mesh_template(const std::string& folder) {
  TemplateKey key{
      "template:\n  use: templates/mesh\n  params: {mesh: template.obj, texture: texture.png}\n",
      {}};
  for (const char* name : {"template.obj", "texture.png"}) {
    key.files.push_back({folder + "/" + name, name});
  }
  return key;
}

std::string flow_quoted(const fs::path& path) {
  std::string quoted = "'";
  for (const char c : path.string()) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

Result<std::string> corner_list(const std::string& corners) {
  constexpr int kNumbers = 8;
  const Error mistake{Errc::invalid_value,
                      "--corners '" + corners +
                          "': write x,y of the top left, top right, bottom right and bottom left "
                          "corner in px, as in --corners \"12,30 610,28 640,470 3,480\""};
  std::string list;
  int count = 0;
  const char* at = corners.data();
  const char* const end = at + corners.size();
  const auto skip = [&] {
    while (at != end && std::string_view(" ,;\t").find(*at) != std::string_view::npos) ++at;
  };
  for (skip(); at != end; skip()) {
    double number = 0.0;
    const auto [after, code] = std::from_chars(at, end, number);
    if (code != std::errc{}) return mistake;
    list += (count++ == 0 ? "[" : ", ") + std::string(at, after);
    at = after;
  }
  return count == kNumbers ? Result<std::string>(list + "]") : Result<std::string>(mistake);
}

/// Before the first one is copied, so that a mistyped name leaves no half-filled folder.
Result<void> check_are_there(const std::vector<Copy>& files) {
  for (const Copy& copy : files) {
    if (auto found = check_input(copy.file, InputKind::file); !found) return found;
  }
  return {};
}

Result<void> write_pipeline(const std::string& folder, const std::string& name,
                            const std::string& text, const std::vector<Copy>& files,
                            const host::Registry& registry) {
  if (auto copied = copy_into(folder, files); !copied) return copied;
  auto written =
      write_whole(schema::pipeline_schema(registry), folder + "/" + std::string(kPipelineSchema));
  return written ? write_whole(text, folder + "/" + name) : written;
}

}  // namespace weft::cli
