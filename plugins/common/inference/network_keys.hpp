// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/inference/onnx_file.hpp"
#include "common/yaml/yaml_file.hpp"

namespace weft::inference {

/// Longest side of the image of a network.
inline constexpr double kMostPx = 4096.0;

/// The keys of one map of a network file; errors name them with the path of the map, such as
/// "camera.fx". All errors are reported with yaml_files::fail_at().
class Keys {
 public:
  /// Fails on keys that are not in `known`.
  Keys(const YAML::Node& map, std::string prefix, const std::vector<std::string>& known);

  bool has(const std::string& key) const { return map_[key].IsDefined(); }
  YAML::Node node(const std::string& key) const;
  Keys map(const std::string& key, const std::vector<std::string>& known) const;
  double number(const std::string& key, double low, double high) const;
  int whole(const std::string& key, double low, double high) const;
  bool yes_or_no(const std::string& key) const;
  std::string text(const std::string& key) const;
  /// The place of the text among `words`.
  std::size_t choice(const std::string& key, const std::vector<std::string>& words) const;
  void require(const std::string& key, const std::string& only) const;
  std::string hash(const std::string& key) const;

 private:
  std::string name(const std::string& key) const {
    return prefix_.empty() ? key : prefix_ + "." + key;
  }

  YAML::Node map_;
  std::string prefix_;
};

/// The keys weft_network, onnx and onnx_hash of the file `path`. The input is left empty.
OnnxFile read_onnx_file(const Keys& root, const std::string& path);

/// The text of a network file that is not empty.
Result<std::string> read_network_text(const std::string& path);

/// The result of `read` for the root of a network file; `read` reports errors with fail_at().
template <class Read>
auto read_network_yaml(const std::string& path, Read read) -> Result<decltype(read(YAML::Node()))> {
  const auto text = read_network_text(path);
  if (!text) return text.error();
  return yaml_files::read_yaml(path, *text, read);
}

}  // namespace weft::inference
