// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <set>
#include <weft/core/quote.hpp>
#include <weft/images/image_names.hpp>

#include "host/loading/component_spec.hpp"
#include "host/records/content_hash.hpp"
#include "lab/ablation/plan/plan_keys.hpp"
#include "lab/ablation/plan/plan_parts.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

yaml::Node number_node(std::uint64_t number, yaml::Position at) {
  return yaml::plain_node(std::to_string(number), at);
}

yaml::Node map_node(yaml::Position at) {
  yaml::Node node;
  node.kind = yaml::Kind::map;
  node.at = at;
  return node;
}

/// "FOLDER/*.png", of the first of these extensions that a file in the folder has, else of the
/// first.
std::string pattern_in(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::error_code code;
  for (const std::string& extension : extensions) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
      if (entry.path().extension() == extension) return (folder / "*").string() + extension;
    }
  }
  return (folder / "*").string() + extensions.front();
}

/// Data that are one entry of the plan's `data`.
class DataReader {
 public:
  DataReader(const yaml::Entry& entry, const Plan& plan, PlanValues& values)
      : entry_(entry), plan_(plan), values_(values), patch_(patch_in(entry.value, values)) {}

  std::vector<NamedPatch> sequences() {
    const yaml::Node* seeds = entry_.value.find("seeds");
    const yaml::Node* setting = entry_.value.find("seed_setting");
    const yaml::Node* folders = entry_.value.find("folders");
    if (seeds != nullptr && folders != nullptr) {
      values_.problem(folders->at, "data have 'seeds' or 'folders', not both");
    }
    if (setting != nullptr && seeds == nullptr) {
      values_.problem(setting->at, "'seed_setting' needs 'seeds'");
    }
    if (folders != nullptr && patch_.find("source") != nullptr) {
      values_.problem(patch_.find("source")->at, "data have 'folders' or 'source', not both");
    }
    if (folders != nullptr && plan_.helpers.frames_source.empty()) {
      values_.problem(folders->at, "'folders' need a source that this program does not have");
    }
    if (folders != nullptr && seeds == nullptr) return of_folders(*folders);
    if (seeds != nullptr) return of_seeds(*seeds, setting);
    return {{entry_.key, patch_}};
  }

 private:
  std::vector<NamedPatch> of_seeds(const yaml::Node& seeds, const yaml::Node* setting) {
    std::vector<NamedPatch> found;
    const std::string path =
        setting != nullptr ? values_.text(*setting, "'seed_setting'") : "source.seed";
    const yaml::Position at = setting != nullptr ? setting->at : seeds.at;
    const std::vector<std::uint64_t> given = values_.seeds(seeds, "data seeds");
    if (!values_.data_use_known && !given.empty()) {
      const auto [first, last] = std::minmax_element(given.begin(), given.end());
      if (*first <= kLastTuningSeed && *last > kLastTuningSeed) {
        values_.problem(seeds.at,
                        "data seeds 1-100 are for tuning, from 101 on for reporting: use "
                        "one or the other");
      }
    }
    for (const std::uint64_t seed : given) {
      if (values_.data_use_known && (seed > kLastTuningSeed) != plan_.reporting) {
        values_.problem(seeds.at, "the data seed " + std::to_string(seed) + " is for " +
                                      (plan_.reporting ? "tuning" : "reporting") +
                                      ": 1-100 are for tuning, from 101 on for reporting");
        break;
      }
      found.push_back({entry_.key + "_" + std::to_string(seed),
                       with_setting(patch_, path, at, number_node(seed, seeds.at))});
    }
    return found;
  }

  std::vector<NamedPatch> of_folders(const yaml::Node& folders) {
    const auto paths = host::PathRules::of_process({}, {});
    const auto expanded = host::expand_path(values_.text(folders, "'folders'"), paths);
    if (!expanded) {
      values_.problem(folders.at, expanded.error().message);
      return {};
    }
    const std::string pattern =
        (fs::path(plan_.folder_of(folders.at)) / *expanded / "camera.yaml").string();
    const auto cameras = host::files_of(pattern);
    if (!cameras) {
      values_.problem(folders.at, "no folder with a camera.yaml matches " + quote(*expanded));
      return {};
    }
    std::vector<NamedPatch> found;
    for (const std::string& camera : *cameras) {
      const fs::path folder = fs::path(camera).parent_path();
      found.push_back(
          {folder.lexically_normal().filename().string(), of_folder(folder, folders.at)});
      values_.is_name(found.back().name, folders.at, "the name of a folder");
    }
    return found;
  }

  /// The patch with a source that reads the folder.
  yaml::Node of_folder(const fs::path& folder, yaml::Position at) {
    yaml::Node use = map_node(at), patch = patch_;
    use.entries.push_back({"use", at, yaml::text_node(plan_.helpers.frames_source, at)});
    patch.entries.push_back({"source", at, use});
    const auto set = [&](const char* path, const std::string& file) {
      patch = with_setting(std::move(patch), path, at, yaml::text_node(file, at));
    };
    set("source.path", pattern_in(folder / "frames", image_extensions()));
    set("source.camera", (folder / "camera.yaml").string());
    if (fs::exists(folder / "gt")) set("source.truth", pattern_in(folder / "gt", {".npz", ".csv"}));
    return patch;
  }

  const yaml::Entry& entry_;
  const Plan& plan_;
  PlanValues& values_;
  yaml::Node patch_;
};

}  // namespace

std::vector<PlannedData> read_data(const yaml::Node& node, const Plan& plan, PlanValues& values) {
  std::vector<PlannedData> all;
  std::set<std::string> names;
  if (node.kind != yaml::Kind::map || node.entries.empty()) {
    values.problem(
        node.at,
        "'data' must be a map of names and the settings that each changes in the pipeline");
    return all;
  }
  for (const yaml::Entry& entry : node.entries) {
    const bool named = values.is_name(entry.key, entry.at, "the name of data");
    if (!values.is_map(entry.value, "data", data_keys()) || !named) continue;
    all.push_back({entry.key, DataReader(entry, plan, values).sequences()});
    for (const NamedPatch& sequence : all.back().sequences) {
      if (names.insert(sequence.name).second) continue;
      values.problem(entry.at, "there are two sequences with the name " + quote(sequence.name));
    }
  }
  return all;
}

yaml::Node patch_in(const yaml::Node& map, PlanValues& values) {
  const std::vector<std::string> keys = yaml::names_of(patch_keys());
  yaml::Node patch = map_node(map.at);
  for (const yaml::Entry& entry : map.entries) {
    const bool is_set = entry.key == "set";
    if (is_set && entry.value.kind != yaml::Kind::map) {
      values.problem(entry.value.at,
                     "'set' must be a map of settings, such as {filters.alpha_s: 0.2}");
    } else if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) {
      patch.entries.push_back(entry);
    }
  }
  return patch;
}

yaml::Node setting_patch(const std::string& path, yaml::Position at, const yaml::Node& value) {
  return with_setting(map_node(at), path, at, value);
}

yaml::Node with_setting(yaml::Node patch, const std::string& path, yaml::Position at,
                        const yaml::Node& value) {
  auto set = std::find_if(patch.entries.begin(), patch.entries.end(),
                          [](const yaml::Entry& entry) { return entry.key == "set"; });
  if (set == patch.entries.end()) {
    set = patch.entries.insert(set, {"set", at, map_node(at)});
  }
  set->value.entries.push_back({path, at, value});
  return patch;
}

PlannedCluster read_cluster(const yaml::Node& node, PlanValues& values) {
  PlannedCluster cluster;
  if (!values.is_map(node, "'cluster'", cluster_keys())) return cluster;
  if (const yaml::Node* partition = node.find("partition")) {
    cluster.partition = values.text(*partition, "'partition'");
  }
  if (const yaml::Node* sbatch = node.find("sbatch")) {
    for (const auto& [option, at] : values.texts(*sbatch, "'sbatch'")) {
      // All other texts would be taken for the script.
      if (option.starts_with("-")) cluster.sbatch.push_back(option);
      if (!option.empty() && !option.starts_with("-")) {
        values.problem(at, "an option of sbatch begins with a dash, such as --mem=4G");
      }
    }
  }
  const auto above_zero = [&](const char* key) -> std::optional<double> {
    const yaml::Node* value = node.find(key);
    if (value == nullptr) return std::nullopt;
    const auto number = values.number(*value, std::string("'") + key + "'");
    if (number && !(*number > 0.0)) {
      values.problem(value->at, std::string("'") + key + "' must be above 0");
    }
    return number;
  };
  cluster.chunk_minutes = above_zero("chunk_minutes");
  cluster.cell_seconds = above_zero("cell_seconds");
  return cluster;
}

}  // namespace weft::lab
