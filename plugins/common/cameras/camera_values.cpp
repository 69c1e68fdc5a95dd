// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/camera_values.hpp"

#include <algorithm>
#include <set>

#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {
namespace {

constexpr int kDeepest = 5;
constexpr std::size_t kMostWords = 1 << 18;  // anchors can repeat values without end

bool is_list(const YAML::Node& node) { return node.IsSequence(); }

/// True if a list has rows: lists of scalars, of equal length.
bool has_rows(const YAML::Node& list) {
  return list.size() > 0 && std::all_of(list.begin(), list.end(), [&](const YAML::Node& row) {
           return is_list(row) && row.size() == list[0].size() &&
                  std::all_of(row.begin(), row.end(),
                              [](const YAML::Node& item) { return item.IsScalar(); });
         });
}

}  // namespace

class YamlValues {
 public:
  CameraValues read(const YAML::Node& root) {
    values_.place_ = root.Mark();
    add_map("", root, 0);
    return std::move(values_);
  }

 private:
  void add_map(const std::string& path, const YAML::Node& map, int depth) {
    std::set<std::string> keys;
    for (const auto& entry : map) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (!keys.insert(key).second) {
        yaml_files::fail_at(entry.first, "'" + key + "' is given twice: remove one");
      }
      add(path.empty() ? key : path + "/" + key, entry.second, entry.first.Mark(), depth);
    }
  }

  void add(const std::string& path, const YAML::Node& node, const YAML::Mark& key, int depth) {
    Value value{path, Value::Kind::null, node.Mark(), key, {}};
    if (node.IsScalar()) {
      value.kind = Value::Kind::scalar;
      add_word(value, node);
    } else if (is_list(node)) {
      value.kind = Value::Kind::list;
      const bool rows = has_rows(node);
      for (const YAML::Node& item : node) {
        if (!rows) add_word(value, item);
        for (std::size_t i = 0; rows && i < item.size(); ++i) add_word(value, item[i]);
      }
    } else if (node.IsMap()) {
      value.kind = Value::Kind::map;
    }
    values_.values_.push_back(std::move(value));
    if (depth == kDeepest) return;
    if (node.IsMap()) add_map(path, node, depth + 1);
    if (!is_list(node)) return;
    int number = 0;
    for (const YAML::Node& item : node) {
      if (item.IsMap()) add(path + "/" + std::to_string(number), item, item.Mark(), depth + 1);
      ++number;
    }
  }

  void add_word(Value& value, const YAML::Node& node) {
    if (++words_ > kMostWords) yaml_files::fail_at(node, "the file has too many values");
    const bool scalar = node.IsScalar();
    value.words.push_back({scalar ? node.Scalar() : "", node.Mark(), scalar});
  }

  CameraValues values_;
  std::size_t words_ = 0;
};

CameraValues CameraValues::of_yaml(const YAML::Node& root) { return YamlValues().read(root); }

const Value* CameraValues::find(std::string_view prefix, std::string_view paths) const {
  while (!paths.empty()) {
    const std::size_t end = std::min(paths.find('|'), paths.size());
    const std::string path = std::string(prefix) + std::string(paths.substr(0, end));
    paths.remove_prefix(std::min(end + 1, paths.size()));
    for (const Value& value : values_) {
      if (value.path == path && value.kind != Value::Kind::null) return &value;
    }
  }
  return nullptr;
}

}  // namespace weft::cameras
