// SPDX-License-Identifier: Apache-2.0
#include "cli/results/compared_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "cli/data/sequence_maker.hpp"
#include "cli/standard_components.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

/// Values of `folders` in a plan.
bool is_plain_sequence(const fs::path& folder) {
  std::error_code code;
  return fs::is_regular_file(folder / "camera.yaml", code) &&
         fs::is_directory(folder / "frames", code);
}

std::vector<fs::path> children_of(const fs::path& folder) {
  std::error_code code;
  std::vector<fs::path> children;
  for (const auto& entry : fs::directory_iterator(folder, code)) children.push_back(entry.path());
  std::sort(children.begin(), children.end());
  return children;
}

/// Parameters that are paths are relative to the folder of the data.
void make_absolute(yaml::Node& source, const std::string& folder, const host::Registry& registry) {
  const yaml::Node* use = source.find("use");
  const host::Installed* installed = registry.find(use->scalar);
  const auto params = std::find_if(source.entries.begin(), source.entries.end(),
                                   [](const yaml::Entry& entry) { return entry.key == "params"; });
  if (installed == nullptr || params == source.entries.end()) return;
  for (yaml::Entry& entry : params->value.entries) {
    const auto& known = installed->component.parameters;
    const bool is_path = std::any_of(known.begin(), known.end(), [&](const auto& parameter) {
      return parameter.name == entry.key && parameter.type == WEFT_VALUE_INPUT_PATH;
    });
    if (!is_path || entry.value.scalar.empty() || entry.value.scalar.starts_with("$")) continue;
    entry.value = yaml::text_node((fs::path(folder) / entry.value.scalar).string());
  }
}

/// "  NAME:" and the source below it.
std::string entry_of(const std::string& name, DataLayout layout, const host::Registry& registry) {
  make_absolute(layout.source, layout.folder, registry);
  yaml::Node data, named;
  data.kind = named.kind = yaml::Kind::map;
  data.entries.push_back({"source", {}, std::move(layout.source)});
  named.entries.push_back({name, {}, std::move(data)});
  std::string lines = "  ";
  for (const char c : yaml::emit(named))
    lines += c == '\n' ? std::string("\n  ") : std::string(1, c);
  lines.erase(lines.size() - 2);
  return lines;
}

}  // namespace

Result<std::string> compared_data(const std::string& path, std::size_t number,
                                  const host::Registry& registry) {
  const std::string name = fmt::format("data_{}", number);
  const fs::path place = fs::absolute(path).lexically_normal();
  const std::vector<fs::path> children = children_of(place);
  const bool is_one = is_plain_sequence(place);
  if (is_one || std::any_of(children.begin(), children.end(), is_plain_sequence)) {
    const std::string folders = (is_one ? place : place / "*").string();
    return fmt::format("  {}:\n    folders: {}\n", name, yaml_quoted(folders));
  }
  auto layout = find_data_layout(path, standard_sources());
  if (layout) return entry_of(name, *std::move(layout), registry);
  std::string lines;
  for (std::size_t i = 0; i < children.size(); ++i) {
    std::error_code code;
    if (!fs::is_directory(children[i], code)) continue;
    auto of_child = find_data_layout(children[i].string(), standard_sources());
    if (!of_child) continue;
    lines += entry_of(fmt::format("{}_{}", name, i + 1), *std::move(of_child), registry);
  }
  if (!lines.empty()) return lines;
  return Error{layout.error().code, layout.error().message, "--data " + path};
}

}  // namespace weft::cli
