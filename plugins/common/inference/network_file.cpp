// SPDX-License-Identifier: Apache-2.0
#include "common/inference/network_file.hpp"

#include <algorithm>
#include <string>

#include "common/inference/network_keys.hpp"

namespace weft::inference {
namespace {

using yaml_files::fail_at;

constexpr double kMostGridNodes = 256.0;  // along a side of the vertex grid

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
}

/// The texture of a network for any texture, or the template of one for a single template.
void read_template(const Keys& root, NetworkFile& file) {
  if (root.has("texture")) {
    for (const char* key : {"template", "vertices"}) {
      if (!root.has(key)) continue;
      fail_at(root.node(key), std::string("a network with 'texture' takes any template: remove '") +
                                  key + "' or 'texture'");
    }
    const double widest = std::min(kMostPx, static_cast<double>(file.camera.width_px));
    file.texture_px = root.map("texture", {"side_px"}).whole("side_px", 8.0, widest);
    return;
  }
  const Keys vertices = root.map("vertices", {"output", "columns", "rows"});
  file.vertices = {vertices.text("output"), vertices.whole("columns", 2.0, kMostGridNodes),
                   vertices.whole("rows", 2.0, kMostGridNodes)};
  const Keys templ = root.map("template", {"width_m", "height_m", "texture_hash"});
  file.templ = {templ.number("width_m", 1e-6, 1e3), templ.number("height_m", 1e-6, 1e3),
                templ.hash("texture_hash")};
}

NetworkFile read_keys(const std::string& path, const YAML::Node& node) {
  const Keys root(
      node, "",
      {"weft_network", "kind", "onnx", "onnx_hash", "image", "camera", "cells", "vertices",
       "template", "texture", "uv_error_factor", "training", "licence", "comment"});
  root.require("kind", "registration");
  NetworkFile file;
  static_cast<OnnxFile&>(file) = read_onnx_file(root, path);
  read_image(root, file);
  read_grids(root, file);
  read_template(root, file);
  file.uv_error_factor = root.number("uv_error_factor", 1e-3, 1e3);
  return file;
}

}  // namespace

Result<NetworkFile> read_network_file(const std::string& path) {
  return read_network_yaml(path, [&](const YAML::Node& root) { return read_keys(path, root); });
}

}  // namespace weft::inference
