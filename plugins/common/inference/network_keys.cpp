// SPDX-License-Identifier: Apache-2.0
#include "common/inference/network_keys.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <weft/core/suggest.hpp>
#include <weft/core/text_file.hpp>

#include "common/inference/hash.hpp"

namespace weft::inference {
namespace {

using yaml_files::fail_at;

std::string short_text(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

/// A name without a folder, because network and description are moved together.
std::string read_onnx_name(const Keys& root) {
  std::string name = root.text("onnx");
  if (name.find('/') != std::string::npos || name == "." || name == "..") {
    fail_at(root.node("onnx"), "'onnx' must be the name of a file in the same folder, without '/'");
  }
  return name;
}

}  // namespace

Keys::Keys(const YAML::Node& map, std::string prefix, const std::vector<std::string>& known)
    : map_(map), prefix_(std::move(prefix)) {
  if (!map_.IsMap()) {
    fail_at(map_, prefix_.empty()
                      ? "must have keys such as weft_network and onnx"
                      : "'" + prefix_ + "' must be a map, {" + known.front() + ": ...}");
  }
  for (const auto& entry : map_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    fail_at(entry.first, "a network file has no key '" + name(key) + "'" +
                             did_you_mean(key, known, ": remove it"));
  }
}

YAML::Node Keys::node(const std::string& key) const {
  const YAML::Node found = map_[key];
  if (!found.IsDefined())
    fail_at(map_, "'" + name(key) + "' is missing: add it, or export the network again");
  return found;
}

Keys Keys::map(const std::string& key, const std::vector<std::string>& known) const {
  return {node(key), name(key), known};
}

double Keys::number(const std::string& key, double low, double high) const {
  const YAML::Node found = node(key);
  double value = 0.0;
  const bool is_number = found.IsScalar() && YAML::convert<double>::decode(found, value);
  if (!is_number || !(value >= low && value <= high)) {
    fail_at(found, "'" + name(key) + "' must be a number from " + short_text(low) + " to " +
                       short_text(high));
  }
  return value;
}

int Keys::whole(const std::string& key, double low, double high) const {
  const double value = number(key, low, high);
  if (value != std::floor(value)) fail_at(node(key), "'" + name(key) + "' must be a whole number");
  return static_cast<int>(value);
}

std::string Keys::text(const std::string& key) const {
  const YAML::Node found = node(key);
  if (!found.IsScalar() || found.Scalar().empty()) {
    fail_at(found, "'" + name(key) + "' must be a text");
  }
  return found.Scalar();
}

void Keys::require(const std::string& key, const std::string& only) const {
  if (text(key) == only) return;
  fail_at(node(key), "'" + name(key) + "' is '" + text(key) + "', but only '" + only +
                         "' is known: use another version of Weft, or export the network again");
}

std::string Keys::hash(const std::string& key) const {
  std::string value = text(key);
  if (!is_hash(value)) {
    fail_at(node(key), "'" + name(key) + "' must have 16 hexadecimal digits in lower case");
  }
  return value;
}

bool Keys::yes_or_no(const std::string& key) const {
  const YAML::Node found = node(key);
  bool value = false;
  if (!found.IsScalar() || !YAML::convert<bool>::decode(found, value)) {
    fail_at(found, "'" + name(key) + "' must be true or false");
  }
  return value;
}

std::size_t Keys::choice(const std::string& key, const std::vector<std::string>& words) const {
  const std::string found = text(key);
  std::string all;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (found == words[i]) return i;
    all += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  }
  fail_at(node(key), "'" + name(key) + "' must be " + all);
}

OnnxFile read_onnx_file(const Keys& root, const std::string& path) {
  root.require("weft_network", "1");
  OnnxFile file;
  file.path = path;
  file.onnx_path = (std::filesystem::path(path).parent_path() / read_onnx_name(root)).string();
  file.onnx_hash = root.hash("onnx_hash");
  return file;
}

Result<std::string> read_network_text(const std::string& path) {
  auto text = read_text_file(path, std::uint64_t{1} << 20U);
  if (!text) {
    return Error{text.error().code,
                 path + ": " + unreadable_text(text.error()) + "; give the yaml file of a network"};
  }
  if (text->empty()) {
    return Error{Errc::invalid_data, path + ": is empty; give the yaml file of a network"};
  }
  return text;
}

}  // namespace weft::inference
