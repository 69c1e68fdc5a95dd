// SPDX-License-Identifier: Apache-2.0
#include "detector_file.hpp"

#include <cmath>

#include "common/inference/network_keys.hpp"

namespace weft::onnx {
namespace {

using inference::Keys;
using yaml_files::fail_at;

constexpr double kMostRadius_px = 64.0;
constexpr double kMostBorder_px = 1024.0;
constexpr double kMostScale = 1e6;

NetworkImage read_image(const Keys& image) {
  NetworkImage read;
  read.size_px = {image.whole("width_px", 8.0, inference::kMostPx),
                  image.whole("height_px", 8.0, inference::kMostPx)};
  read.is_grey = image.choice("colours", {"rgb", "grey"}) == 1;
  read.scale = image.number("scale", -kMostScale, kMostScale);
  if (read.scale == 0.0) fail_at(image.node("scale"), "'image.scale' must not be 0");
  if (image.has("offset")) read.offset = image.number("offset", -kMostScale, kMostScale);
  return read;
}

HeatMapOutput read_heat_map(const Keys& map) {
  HeatMapOutput read;
  read.name = map.text("output");
  if (map.has("nms_px")) read.nms_px = map.whole("nms_px", 1.0, kMostRadius_px);
  if (map.has("border_px")) read.border_px = map.whole("border_px", 0.0, kMostBorder_px);
  return read;
}

KeypointsOutput read_keypoints(const Keys& root) {
  const Keys list = root.map("keypoints", {"output", "units", "order", "centres"});
  KeypointsOutput read;
  read.name = list.text("output");
  read.is_normalised = list.choice("units", {"px", "normalised"}) == 1;
  read.is_yx = list.choice("order", {"xy", "yx"}) == 1;
  read.is_at_halves = list.choice("centres", {"integers", "halves"}) == 1;
  if (root.has("scores")) read.scores = root.map("scores", {"output"}).text("output");
  return read;
}

DescriptorsOutput read_descriptors(const Keys& root, bool is_map) {
  const Keys keys = root.map("descriptors", {"output", "metric", "normalise", "align_corners"});
  DescriptorsOutput read;
  read.name = keys.text("output");
  read.is_binary = keys.choice("metric", {"l2", "hamming"}) == 1;
  read.is_normalised = keys.yes_or_no("normalise");
  if (!keys.has("align_corners")) return read;
  if (!is_map) {
    fail_at(keys.node("align_corners"),
            "'descriptors.align_corners' is only for networks with a heat_map: remove it");
  }
  read.align_corners = keys.yes_or_no("align_corners");
  return read;
}

DetectorFile read_keys(const std::string& path, const YAML::Node& node) {
  const Keys root(node, "",
                  {"weft_network", "kind", "onnx", "onnx_hash", "image", "heat_map", "keypoints",
                   "scores", "descriptors", "training", "licence", "comment"});
  root.require("kind", "detector");
  DetectorFile file;
  static_cast<inference::OnnxFile&>(file) = inference::read_onnx_file(root, path);
  const Keys image =
      root.map("image", {"input", "width_px", "height_px", "colours", "scale", "offset"});
  file.input = image.text("input");
  file.image = read_image(image);
  if (root.has("heat_map") == root.has("keypoints")) {
    fail_at(node, "needs either 'heat_map' or 'keypoints'");
  }
  if (root.has("heat_map")) {
    if (root.has("scores")) {
      fail_at(root.node("scores"), "the scores of a heat_map are the map itself: remove 'scores'");
    }
    file.heat_map = read_heat_map(root.map("heat_map", {"output", "nms_px", "border_px"}));
  } else {
    file.keypoints = read_keypoints(root);
  }
  file.descriptors = read_descriptors(root, file.heat_map.has_value());
  return file;
}

}  // namespace

std::vector<std::string> DetectorFile::outputs() const {
  if (heat_map) return {descriptors.name, heat_map->name};
  std::vector<std::string> names{descriptors.name, keypoints.name};
  if (!keypoints.scores.empty()) names.push_back(keypoints.scores);
  return names;
}

Result<DetectorFile> read_detector_file(const std::string& path) {
  return inference::read_network_yaml(
      path, [&](const YAML::Node& root) { return read_keys(path, root); });
}

}  // namespace weft::onnx
