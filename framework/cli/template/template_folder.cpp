// SPDX-License-Identifier: Apache-2.0
#include "cli/template/template_folder.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <filesystem>
#include <tuple>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/whole_file.hpp>

#include "cli/template/template_builder.hpp"
#include "cli/template/template_picture.hpp"
#include "host/records/npz.hpp"
#include "pipeline/survey/template_map.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

/// The shortest text that reads back as the same number.
std::string exact(double value) {
  char buffer[32];
  const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, end};
}

/// The mesh at rest with its texture coordinates, as templates/mesh reads it.
std::string to_obj(const Template& templ) {
  std::string text = "# metres; made by weft template make\nmtllib template.mtl\nusemtl texture\n";
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    text += fmt::format("v {} {} {}\n", exact(templ.vertices_m(v, 0)),
                        exact(templ.vertices_m(v, 1)), exact(templ.vertices_m(v, 2)));
  }
  const auto width = static_cast<double>(templ.texture.dim(1));
  const auto height = static_cast<double>(templ.texture.dim(0));
  for (std::int64_t v = 0; v < templ.flat_px.rows(); ++v) {
    text += fmt::format("vt {} {}\n", exact((templ.flat_px(v, 0) + 0.5) / width),
                        exact(1.0 - (templ.flat_px(v, 1) + 0.5) / height));
  }
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    text += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", templ.faces(f, 0) + 1, templ.faces(f, 1) + 1,
                        templ.faces(f, 2) + 1);
  }
  return text;
}

Result<void> write_files(const host::Registry& registry, const host::Record& record,
                         const Template& templ, const fs::path& folder) {
  const std::pair<const char*, std::string> files[] = {
      {"template.obj", to_obj(templ)},
      {"template.mtl", "newmtl texture\nKd 1 1 1\nillum 1\nmap_Kd texture.png\n"}};
  for (const auto& [name, content] : files) {
    if (auto written = write_whole(content, folder / name); !written) return written;
  }
  for (const auto& [name, picture] :
       {std::pair{"texture.png", Picture::texture}, std::pair{"drawing.png", Picture::mesh}}) {
    auto drawn = write_picture(registry, record, picture, (folder / name).string());
    if (!drawn) return drawn;
  }
  return {};
}

/// Where the vertices of one mesh lie on the other, both ways.
Result<host::NamedRecords> map_between(const Template& made, const Template& original) {
  host::NamedRecords records;
  for (const auto& [slot, from, onto] : {std::tuple{"template_on_original", &made, &original},
                                         std::tuple{"original_on_template", &original, &made}}) {
    const auto places = places_on_mesh(*from, *onto);
    if (!places) return places.error();
    const auto record = host::Record::make("places_on_mesh/1");
    const std::int64_t shape[] = {places->face.rows(), 3};
    void* faces = record->allocate("face", WEFT_I32, 1, shape);
    void* weights = record->allocate("weights", WEFT_F64, 2, shape);
    if (faces == nullptr || weights == nullptr) {
      return Error{Errc::no_memory, "no memory for the map between the meshes"};
    }
    std::memcpy(faces, places->face.data(), to_index(shape[0]) * sizeof(std::int32_t));
    std::memcpy(weights, places->weights.data(), to_index(3 * shape[0]) * sizeof(double));
    records.emplace_back(slot, record);
  }
  return records;
}

/// Nothing where the mesh is that of the template's file.
Result<host::NamedRecords> map_to_file(const host::Registry& registry,
                                       const host::ComponentSpec& component,
                                       const Template& templ) {
  const auto original = with_mesh_of_file(registry, component);
  if (!original) return host::NamedRecords{};
  const auto built = build_template(*original);
  if (!built) return built.error();
  const auto mesh = host::view_as<Template>(*built->record);
  if (!mesh) return mesh.error();
  return map_between(templ, *mesh);
}

}  // namespace

Result<TextureSize> write_template(const host::Registry& registry, const Template& templ,
                                   const std::string& folder) {
  const auto record = host::Record::copy_of(templ);
  if (!record) return Error{Errc::no_memory, "no memory for the template"};
  if (auto written = write_files(registry, *record, templ, folder); !written) {
    return written.error();
  }
  return TextureSize{templ.texture.dim(1), templ.texture.dim(0)};
}

Result<TextureSize> write_template(const host::Registry& registry,
                                   const host::ComponentSpec& component, const Template& templ,
                                   std::optional<double> crop_px, const std::string& folder) {
  const auto map = map_to_file(registry, component, templ);
  if (!map) return map.error();
  auto size = write_template(
      registry, crop_px ? with_cropped_texture(templ, *crop_px) : Template(templ), folder);
  if (!size || map->empty()) return size;
  auto written = host::write_npz((fs::path(folder) / "map.npz").string(), *map);
  if (!written) return written.error();
  return size;
}

}  // namespace weft::cli
