// SPDX-License-Identifier: Apache-2.0
#include "materials.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <weft/core/quote.hpp>
#include <weft/core/text_file.hpp>

#include "common/ply/text_lines.hpp"

namespace weft::mesh {
namespace {

/// The image of each material of a library (map_Kd); none for a library that cannot be read.
void read_pictures(const std::filesystem::path& path,
                   std::map<std::string, std::string>& pictures) {
  constexpr std::uint64_t kMostBytes = 1U << 22U;
  const auto text = read_text_file(path.string(), kMostBytes);
  if (!text) return;
  ply::TextLines lines(*text);
  std::string material;
  while (const auto line = lines.next()) {
    const auto words = ply::words_of(*line);
    if (words.size() < 2) continue;
    if (words[0] == "newmtl") material = std::string(words[1]);
    if (words[0] == "map_Kd") pictures[material] = std::string(words.back());
  }
}

std::string named(const std::vector<Materials::Used>& used,
                  const std::map<std::string, std::string>& pictures) {
  constexpr std::size_t kShown = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(used.size(), kShown); ++i) {
    const auto picture = pictures.find(used[i].name);
    text += (i == 0 ? "" : ", ") + quote(used[i].name) + " (" +
            (picture != pictures.end() ? escaped(picture->second, 80) + ", " : "") +
            std::to_string(used[i].faces) + " faces)";
  }
  return used.size() > kShown ? text + " and " + std::to_string(used.size() - kShown) + " more"
                              : text;
}

}  // namespace

void Materials::use(std::string_view name) {
  const auto known =
      std::find_if(used.begin(), used.end(), [&](const Used& each) { return each.name == name; });
  current = static_cast<std::size_t>(known - used.begin());
  if (known == used.end()) used.push_back({std::string(name), 0});
}

Result<void> check_materials(Materials materials, MeshFile& file) {
  auto& used = materials.used;
  std::erase_if(used, [](const Materials::Used& each) { return each.faces == 0; });
  if (used.size() < 2) return {};
  std::map<std::string, std::string> pictures;
  for (const std::string& library : materials.libraries) {
    read_pictures(std::filesystem::path(file.path).parent_path() / library, pictures);
  }
  std::set<std::string> distinct;
  for (const Materials::Used& each : used) {
    const auto picture = pictures.find(each.name);
    if (picture != pictures.end()) distinct.insert(picture->second);
  }
  const std::string materials_are =
      "the faces have " + std::to_string(used.size()) + " materials: " + named(used, pictures);
  if (distinct.size() > 1) {
    return Error{Errc::invalid_data, file.path + ": " + materials_are + ", with " +
                                         std::to_string(distinct.size()) +
                                         " images, but a template has one: bake them into one "
                                         "image, or export the faces of one material alone"};
  }
  file.notes.push_back(materials_are + "; all of them are assumed to be in the image 'texture'");
  return {};
}

}  // namespace weft::mesh
