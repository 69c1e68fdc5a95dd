// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/data/data_commands.hpp"
#include "cli/data/sequence_maker.hpp"
#include "cli/standard_components.hpp"
#include "pipeline/survey/data_layout.hpp"

namespace weft::cli {
namespace {

struct ConvertOptions {
  std::string path, folder, camera, texture;
  double width_m = 0.0, height_m = 0.0;
  int columns = 10, rows = 7;
  std::vector<std::string> settings;
  bool quiet = false;
  std::string matches, stage;
  double tolerance_px = 2.0, fps = 30.0;
};

/// The pipeline that reads the data and writes the sequence.
Result<GeneratedText> pipeline_text(const ConvertOptions& options) {
  const auto layout = find_data_layout(options.path, standard_sources(), options.camera);
  if (!layout) return layout.error();
  if (layout->kind == "sequence") {
    return Error{Errc::invalid_value, "is a sequence already; there is nothing to convert",
                 options.path};
  }
  const std::string texture = options.texture.empty()
                                  ? layout->texture
                                  : std::filesystem::absolute(options.texture).string();
  if (texture.empty()) {
    return Error{Errc::not_found,
                 "has no template/texture.png and no texture.png; give the texture with --texture",
                 options.path};
  }
  GeneratedText text("weft data convert");
  text.add("# Made by `weft data convert`.\nweft: 1\non_error: stop\nsource:\n");
  text.add("  use: " + layout->source.find("use")->scalar + "\n  params:\n", options.path);
  for (const yaml::Entry& entry : layout->source.find("params")->entries) {
    const bool is_camera = entry.key == "camera" && !options.camera.empty();
    text.add("    " + entry.key + ": " + yaml_quoted(entry.value.scalar) + "\n",
             is_camera ? "--camera " + options.camera : options.path);
  }
  text.add("template:\n  use: templates/rectangular\n  params:\n");
  text.add("    texture: " + yaml_quoted(texture) + "\n",
           options.texture.empty() ? options.path : "--texture " + options.texture);
  text.add(fmt::format("    width_m: {}\n", options.width_m), "--width-m");
  text.add(fmt::format("    height_m: {}\n", options.height_m), "--height-m");
  text.add(fmt::format("    columns: {}\n", options.columns), "--columns");
  text.add(fmt::format("    rows: {}\n", options.rows), "--rows");
  text.add("sinks:\n  - use: sinks/dataset\n    params: {path: .}\n");
  return text;
}

void convert(const ConvertOptions& options, Context& context) {
  if (!options.matches.empty()) {
    return convert_matches(
        {options.path, options.folder, options.matches, options.stage, options.camera,
         options.texture, options.width_m, options.height_m, options.columns, options.rows,
         options.fps, options.tolerance_px, options.settings},
        context);
  }
  if (!(options.width_m > 0.0)) {
    print_error({Errc::invalid_value, "give the width of what the texture shows with --width-m",
                 options.path});
    context.exit_code = kBadConfiguration;
    return;
  }
  const auto text = pipeline_text(options);
  if (!text) {
    print_error(text.error());
    const bool misuse = text.error().code == Errc::invalid_value;
    context.exit_code = misuse ? kBadConfiguration : kInputOutput;
    return;
  }
  make_sequence(*text, options.folder, options.settings, options.quiet, frames_in_sequence,
                {Errc::invalid_data, "holds no frame that could be written", options.path},
                context);
}

}  // namespace

void add_data_convert(CLI::App& data, Context& context) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = data.add_subcommand(
      "convert",
      "Import a folder of images (with depth or true points) or a video as a sequence. Or export "
      "the matches of a run, a sequence or a set of files as CSV or npz");
  command
      ->add_option("PATH", options->path, "Folder or video; `weft data info` shows how it is read")
      ->required();
  command->add_option("--out", options->folder, "Folder of the sequence, new or empty")->required();
  command->add_option("--camera", options->camera,
                      "Camera file, where none lies beside the images");
  command->add_option("--texture", options->texture,
                      "Texture of the template (default: template/texture.png or texture.png)");
  command->add_option("--width-m", options->width_m, "Width of what the texture shows");
  command->add_option("--height-m", options->height_m, "Its height; 0: texels are square")
      ->capture_default_str();
  command->add_option("--columns", options->columns, "Vertices along the width")
      ->capture_default_str();
  command->add_option("--rows", options->rows, "Vertices along the height")->capture_default_str();
  command
      ->add_option(
          "--set", options->settings,
          "PATH=VALUE, such as source.depth_unit_m=0.0002 or template.texel_origin=centre; "
          "may be repeated")
      ->allow_extra_args(false);
  command
      ->add_option("--matches", options->matches,
                   "Write matches, in this form, instead of images: csv or npz")
      ->check(CLI::IsMember({"csv", "npz"}));
  command->add_option("--stage", options->stage,
                      "Stage of a run folder whose matches are taken, or STAGE.FILTER for what a "
                      "filter left of them");
  command
      ->add_option("--match-tolerance-px", options->tolerance_px,
                   "A match of a run is correct when nearer to its true image")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--fps", options->fps, "Frames a second of the matches")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--quiet", options->quiet, "No progress");
  command->callback([&context, options] { convert(*options, context); });
}

}  // namespace weft::cli
