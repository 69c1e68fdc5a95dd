// SPDX-License-Identifier: Apache-2.0
#include "cli/data/data_frex_video.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <filesystem>
#include <weft/core/text_file.hpp>
#include <weft/data/template.hpp>

#include "cli/data/sequence_maker.hpp"
#include "cli/template/template_builder.hpp"
#include "yaml/yaml.hpp"

namespace weft::cli {
namespace {

std::string absolute(const std::string& path) {
  return yaml_quoted(std::filesystem::absolute(path).lexically_normal().string());
}

Result<void> check_file(const std::string& path, const std::string& option) {
  return check_input(path, InputKind::file, "correct " + option);
}

/// Width and height of the printed paper, from its layout.
Result<Eigen::Vector2d> sheet_size_m(const std::string& layout) {
  if (auto found = check_file(layout, "--layout"); !found) return found.error();
  const auto text = yaml::read_text(layout);
  if (!text) return text.error();
  const auto document = yaml::parse(*text, layout);
  if (!document) return document.error();
  Eigen::Vector2d size_m = Eigen::Vector2d::Zero();
  for (const auto& [key, side] : {std::pair{"width_mm", 0}, std::pair{"height_mm", 1}}) {
    const yaml::Node* node = document->root.find(key);
    const auto length_mm = node != nullptr ? yaml::as_double(*node) : std::nullopt;
    if (!length_mm || !(*length_mm > 0.0)) {
      return Error{Errc::invalid_value,
                   fmt::format("has no '{}' above 0; is it the layout that `weft data make frex "
                               "--sheet` wrote?",
                               key),
                   layout};
    }
    size_m[side] = 0.001 * *length_mm;
  }
  return size_m;
}

/// Width of the largest version of the texture that fits the paper.
Result<double> print_width_m(const Context& context, const FrexVideoRequest& request) {
  const auto sheet_m = sheet_size_m(request.layout);
  if (!sheet_m) return sheet_m.error();
  if (auto found = check_file(request.texture, "--texture"); !found) return found.error();
  const auto record = build_template(
      context.registry(), fmt::format("{{use: templates/rectangular, params: {{texture: {}, "
                                      "width_m: 1, columns: 2, rows: 2}}}}",
                                      absolute(request.texture)));
  if (!record) return record.error();
  const auto flat = host::view_as<Template>(**record);
  if (!flat) return flat.error();
  const auto rows = static_cast<double>(flat->texture.dim(0));
  const auto columns = static_cast<double>(flat->texture.dim(1));
  return std::min(sheet_m->x(), sheet_m->y() * columns / rows);
}

}  // namespace

Result<GeneratedText> frex_video_pipeline(const Context& context, const FrexVideoRequest& request) {
  const auto width_m = print_width_m(context, request);
  if (!width_m) return width_m.error();
  const std::string texture = absolute(request.texture);
  GeneratedText text("weft data make frex --video");
  const auto add_path = [&](const char* key, const std::string& path, const std::string& argument) {
    text.add(fmt::format("{}{}\n", key, path), argument);
  };
  text.add("# Made by `weft data make frex --video`.\nweft: 1\nsource:\n");
  text.add("  use: sources/frex_video\n  params:\n    frames:\n      use: sources/video\n");
  text.add("      params:\n");
  add_path("        path: ", absolute(request.video), "--video " + request.video);
  add_path("        camera: ", absolute(request.camera), "--camera " + request.camera);
  add_path("    layout: ", absolute(request.layout), "--layout " + request.layout);
  add_path("    texture: ", texture, "--texture " + request.texture);
  text.add(fmt::format("    lighting_seed: {}\n", request.seed), "--seed");
  if (!request.background.empty()) {
    add_path("    background: ", yaml_quoted(request.background), "--background");
  }
  text.add("template:\n  use: templates/rectangular\n  params:\n");
  add_path("    texture: ", texture, "--texture " + request.texture);
  text.add(fmt::format("    width_m: {}\n    columns: 10\n    rows: 7\n", *width_m));
  text.add("sinks:\n  - use: sinks/dataset\n    params: {path: .}\n");
  return text;
}

}  // namespace weft::cli
