// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/data_layout.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>
#include <weft/core/text_file.hpp>
#include <weft/images/image_names.hpp>

namespace weft {
namespace {

namespace fs = std::filesystem;

Error missing(const fs::path& path, const std::string& message) {
  return {Errc::not_found, message, path.string()};
}

bool has_files(const fs::path& folder, const std::string& extension) {
  std::error_code code;
  return std::any_of(
      fs::directory_iterator(folder, code), fs::directory_iterator(),
      [&](const fs::directory_entry& entry) { return entry.path().extension() == extension; });
}

/// "FOLDER/*.png", of the first of these extensions that a file in the folder has; or empty.
std::string pattern_in(const fs::path& folder, const std::vector<std::string>& extensions) {
  for (const std::string& extension : extensions) {
    if (has_files(folder, extension)) return (folder / ("*" + extension)).string();
  }
  return {};
}

/// The first of these files that exists, or empty.
std::string first_of(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    std::error_code code;
    if (fs::is_regular_file(folder / name, code)) return (folder / name).string();
  }
  return {};
}

yaml::Node source_node(const std::string& use,
                       const std::vector<std::pair<std::string, std::string>>& params) {
  yaml::Node map, source;
  map.kind = source.kind = yaml::Kind::map;
  for (const auto& [name, value] : params) {
    if (!value.empty()) map.entries.push_back({name, {}, yaml::text_node(value)});
  }
  source.entries.push_back({"use", {}, yaml::text_node(use)});
  source.entries.push_back({"params", {}, std::move(map)});
  return source;
}

Result<std::string> camera_beside(const fs::path& folder, const std::string& given) {
  if (given == "auto") return given;  // a word of the sources
  if (!given.empty()) return fs::absolute(given).string();
  std::string found = first_of(folder, {"camera.yaml", "camera.yml", "camera.json", "K.json"});
  if (!found.empty()) return found;
  return missing(folder,
                 "has no camera.yaml, camera.yml, camera.json or K.json; give the camera file with "
                 "--camera, or --camera auto for a camera that is not calibrated");
}

Result<DataLayout> layout_of_yaml(const fs::path& file) {
  const auto text = yaml::read_text(file.string());
  if (!text) return text.error();
  auto document = yaml::parse(*text, file.string());
  if (!document) return document.error();
  if (!document->problems.empty()) {
    const yaml::Problem& problem = document->problems.front();
    return Error{Errc::syntax, problem.message, yaml::place(file.string(), problem.at)};
  }
  const yaml::Node* source = document->root.find("source");
  if (source == nullptr || source->find("use") == nullptr) {
    return Error{Errc::invalid_data, "names no source: give a file with `source: {use: ...}`",
                 file.string()};
  }
  DataLayout layout{"sequence", file.parent_path().string(), *source, {}, {}};
  const yaml::Node* templ = document->root.find("template");
  if (templ != nullptr && templ->find("use") != nullptr) layout.templ = *templ;
  return layout;
}

/// Matches in separate files, by the pattern or the file that names them.
Result<DataLayout> layout_of_matches(const fs::path& folder, const std::string& files,
                                     const FileSources& sources, const std::string& given_camera) {
  auto camera = camera_beside(folder, given_camera);
  if (!camera) return camera.error();
  return DataLayout{
      "matches",
      folder.string(),
      source_node(sources.matches, {{"path", files},
                                    {"camera", *camera},
                                    {"truth", pattern_in(folder / "gt", {".npz", ".csv"})}}),
      first_of(folder, {"template/texture.png", "texture.png"}),
      {}};
}

Result<DataLayout> layout_of_images(const fs::path& folder, const FileSources& sources,
                                    const std::string& given_camera) {
  std::string images;
  for (const char* part : {"frames", "rgb", "color", "colour", "."}) {
    if (images.empty()) {
      images = pattern_in((folder / part).lexically_normal(), image_extensions());
    }
  }
  const std::string matches = pattern_in(folder / "matches", {".npz", ".csv"});
  if (images.empty() && !matches.empty()) {
    return layout_of_matches(folder, matches, sources, given_camera);
  }
  if (images.empty()) {
    return missing(folder,
                   "holds no sequence.yaml and no images, neither itself nor in frames/, rgb/, "
                   "color/ or colour/, and no matches/");
  }
  auto camera = camera_beside(folder, given_camera);
  if (!camera) return camera.error();
  const std::string depth = pattern_in(folder / "depth", {".png"});
  return DataLayout{
      depth.empty() ? "frames" : "frames with depth",
      folder.string(),
      source_node(sources.images, {{"path", images},
                                   {"camera", *camera},
                                   {"truth", pattern_in(folder / "gt", {".npz", ".csv"})},
                                   {"depth", depth}}),
      first_of(folder, {"template/texture.png", "texture.png"}),
      {}};
}

}  // namespace

Result<DataLayout> find_data_layout(const std::string& path, const FileSources& sources,
                                    const std::string& camera) {
  const fs::path place = fs::absolute(path).lexically_normal();
  std::error_code code;
  if (fs::is_directory(place, code)) {
    const std::string sequence = first_of(place, {"sequence.yaml"});
    return sequence.empty() ? layout_of_images(place, sources, camera) : layout_of_yaml(sequence);
  }
  if (auto found = check_input(path, InputKind::any); !found) return found.error();
  if (place.extension() == ".yaml" || place.extension() == ".yml") return layout_of_yaml(place);
  if (place.extension() == ".csv" || place.extension() == ".npz") {
    return layout_of_matches(place.parent_path(), place.string(), sources, camera);
  }
  auto file = camera_beside(place.parent_path(), camera);
  if (!file) return file.error();
  return DataLayout{"video",
                    place.parent_path().string(),
                    source_node(sources.video, {{"path", place.string()}, {"camera", *file}}),
                    {},
                    {}};
}

}  // namespace weft
