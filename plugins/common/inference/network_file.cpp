// SPDX-License-Identifier: Apache-2.0
#include "common/inference/network_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>
#include <weft/core/suggest.hpp>
#include <weft/core/text_file.hpp>

#include "common/inference/hash.hpp"
#include "common/inference/onnx_scan.hpp"
#include "common/yaml/yaml_file.hpp"

namespace weft::inference {
namespace {

using yaml_files::fail_at;

constexpr std::uint64_t kMostOnnxBytes = std::uint64_t{1} << 29U;
constexpr double kMostPx = 4096.0;
constexpr double kMostGridNodes = 256.0;  // along a side of the vertex grid

/// The keys of one map of the file; errors name them with the path of the map, such as
/// "camera.fx".
class Keys {
 public:
  Keys(const YAML::Node& map, std::string prefix, const std::vector<std::string>& known)
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

  YAML::Node node(const std::string& key) const {
    const YAML::Node found = map_[key];
    if (!found.IsDefined())
      fail_at(map_, "'" + name(key) + "' is missing: export the network again");
    return found;
  }

  Keys map(const std::string& key, const std::vector<std::string>& known) const {
    return {node(key), name(key), known};
  }

  double number(const std::string& key, double low, double high) const {
    const YAML::Node found = node(key);
    double value = 0.0;
    const bool is_number = found.IsScalar() && YAML::convert<double>::decode(found, value);
    if (!is_number || !(value >= low && value <= high)) {
      fail_at(found, "'" + name(key) + "' must be a number from " + short_text(low) + " to " +
                         short_text(high));
    }
    return value;
  }

  int whole(const std::string& key, double low, double high) const {
    const double value = number(key, low, high);
    if (value != std::floor(value))
      fail_at(node(key), "'" + name(key) + "' must be a whole number");
    return static_cast<int>(value);
  }

  std::string text(const std::string& key) const {
    const YAML::Node found = node(key);
    if (!found.IsScalar() || found.Scalar().empty()) {
      fail_at(found, "'" + name(key) + "' must be a text");
    }
    return found.Scalar();
  }

  void require(const std::string& key, const std::string& only) const {
    if (text(key) == only) return;
    fail_at(node(key), "'" + name(key) + "' is '" + text(key) + "', but only '" + only +
                           "' is known: use another version of Weft, or export the network again");
  }

  std::string hash(const std::string& key) const {
    std::string value = text(key);
    if (!is_hash(value)) {
      fail_at(node(key), "'" + name(key) + "' must have 16 hexadecimal digits in lower case");
    }
    return value;
  }

 private:
  std::string name(const std::string& key) const {
    return prefix_.empty() ? key : prefix_ + "." + key;
  }
  static std::string short_text(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
    return text;
  }

  YAML::Node map_;
  std::string prefix_;
};

/// A name without a folder, because network and description are moved together.
std::string read_onnx_name(const Keys& root) {
  const std::string name = root.text("onnx");
  if (name.find('/') != std::string::npos || name == "." || name == "..") {
    fail_at(root.node("onnx"), "'onnx' must be the name of a file in the same folder, without '/'");
  }
  return name;
}

void read_image(const Keys& root, NetworkFile& file) {
  const Keys image = root.map("image", {"input", "width_px", "height_px", "colours"});
  image.require("colours", "rgb");
  file.input = image.text("input");
  file.camera.width_px = image.whole("width_px", 8.0, kMostPx);
  file.camera.height_px = image.whole("height_px", 8.0, kMostPx);
  const Keys camera = root.map("camera", {"fx", "fy", "cx", "cy"});
  file.camera.fx = camera.number("fx", 1e-3, 1e6);
  file.camera.fy = camera.number("fy", 1e-3, 1e6);
  file.camera.cx = camera.number("cx", -1e6, 1e6);
  file.camera.cy = camera.number("cy", -1e6, 1e6);
}

void read_grids(const Keys& root, NetworkFile& file) {
  const Keys cells = root.map("cells", {"output", "step_px", "columns", "rows"});
  file.cells = {cells.text("output"), cells.whole("step_px", 1.0, 64.0),
                cells.whole("columns", 1.0, kMostPx), cells.whole("rows", 1.0, kMostPx)};
  const auto fits = [&](int count, std::int64_t size_px) {
    return std::int64_t{count} * file.cells.step_px == size_px;
  };
  if (!fits(file.cells.columns, file.camera.width_px) ||
      !fits(file.cells.rows, file.camera.height_px)) {
    fail_at(root.node("cells"), "columns and rows times step_px must be the size of the image, " +
                                    std::to_string(file.camera.width_px) + " x " +
                                    std::to_string(file.camera.height_px) + " px");
  }
  const Keys vertices = root.map("vertices", {"output", "columns", "rows"});
  file.vertices = {vertices.text("output"), vertices.whole("columns", 2.0, kMostGridNodes),
                   vertices.whole("rows", 2.0, kMostGridNodes)};
}

NetworkFile read_keys(const std::string& path, const YAML::Node& node) {
  const Keys root(node, "",
                  {"weft_network", "kind", "onnx", "onnx_hash", "image", "camera", "cells",
                   "vertices", "template", "uv_error_factor", "training", "licence", "comment"});
  root.require("weft_network", "1");
  root.require("kind", "registration");
  NetworkFile file;
  file.path = path;
  file.onnx_path = (std::filesystem::path(path).parent_path() / read_onnx_name(root)).string();
  file.onnx_hash = root.hash("onnx_hash");
  read_image(root, file);
  read_grids(root, file);
  const Keys templ = root.map("template", {"width_m", "height_m", "texture_hash"});
  file.templ = {templ.number("width_m", 1e-6, 1e3), templ.number("height_m", 1e-6, 1e3),
                templ.hash("texture_hash")};
  file.uv_error_factor = root.number("uv_error_factor", 1e-3, 1e3);
  return file;
}

}  // namespace

Result<NetworkFile> read_network_file(const std::string& path) {
  const auto text = read_text_file(path, std::uint64_t{1} << 20U);
  if (!text) {
    return Error{text.error().code,
                 path + ": " + unreadable_text(text.error()) + "; give the yaml file of a network"};
  }
  if (text->empty()) {
    return Error{Errc::invalid_data, path + ": is empty; give the yaml file of a network"};
  }
  return yaml_files::read_yaml(path, *text,
                               [&](const YAML::Node& root) { return read_keys(path, root); });
}

Result<std::string> read_onnx(const NetworkFile& file) {
  auto bytes = read_text_file(file.onnx_path, kMostOnnxBytes);
  if (!bytes) {
    return Error{bytes.error().code, file.onnx_path + ": " + unreadable_text(bytes.error()) +
                                         "; put the ONNX file beside " + file.path};
  }
  if (const std::string hash = hash_of(*bytes); hash != file.onnx_hash) {
    return Error{Errc::invalid_data, file.onnx_path + " is not the file that " + file.path +
                                         " describes: its hash is " + hash + ", not " +
                                         file.onnx_hash + "; copy both again from one training"};
  }
  const auto contents = scan_onnx(*bytes);
  if (!contents) {
    return Error{contents.error().code, file.onnx_path + ": " + contents.error().message};
  }
  if (auto named = check_names(*contents, file.input, {file.cells.output, file.vertices.output});
      !named) {
    return Error{named.error().code, file.onnx_path + ": " + named.error().message};
  }
  return bytes;
}

}  // namespace weft::inference
