// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/data/data_commands.hpp"
#include "cli/data/data_frex_sheet.hpp"
#include "cli/data/data_frex_video.hpp"
#include "cli/data/sequence_maker.hpp"

namespace weft::cli {
namespace {

struct FrexOptions {
  std::string sheet;  ///< the PDF, if the marker layout is requested
  std::string video, camera, layout;
  std::string purpose;  ///< "learning", or empty
  std::string folder, texture, pattern, background;
  double width_m = 0.297;
  double height_m = 0.0;
  std::int64_t frames = 60;
  std::int64_t seed = 1;
  bool occluder = false;
  std::vector<std::string> settings;
  bool quiet = false;
  bool overwrite = false;  ///< for the files of the marker layout
};

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

/// How the file was made, with the settings that are not in it.
void add_settings(const FrexOptions& options, const std::string& more, GeneratedText& text) {
  text.add("# Made by `weft data make frex" + more + "`; `weft run` of this file makes it again" +
           (options.settings.empty() ? ".\n" : ", with:\n"));
  for (const std::string& setting : options.settings) {
    text.add("#   --set " + one_line(setting) + "\n");
  }
}

/// The pipeline that simulates the sequence. It is stored in the sequence and documents how that
/// was made, thus it does not depend on the location.
GeneratedText simulation_text(const FrexOptions& options) {
  const std::string texture =
      yaml_quoted(std::filesystem::absolute(options.texture).lexically_normal().string());
  GeneratedText text("weft data make frex");
  add_settings(options, "", text);
  const auto add_sheet = [&] {
    text.add("    texture: " + texture + "\n", "--texture " + options.texture);
    text.add(fmt::format("    width_m: {}\n", options.width_m), "--width-m");
    text.add(fmt::format("    height_m: {}\n", options.height_m), "--height-m");
  };
  text.add("weft: 1\non_error: stop\nsource:\n  use: sources/frex\n  params:\n");
  add_sheet();
  text.add(fmt::format("    frames: {}\n", options.frames), "--frames");
  text.add(fmt::format("    seed: {}\n", options.seed), "--seed");
  if (!options.pattern.empty()) {
    text.add("    pattern: " + yaml_quoted(options.pattern) + "\n", "--pattern");
  }
  if (!options.background.empty()) {
    text.add("    background: " + yaml_quoted(options.background) + "\n", "--background");
  }
  if (options.occluder) text.add("    occluder: true\n", "--occluder");
  text.add("template:\n  use: templates/rectangular\n  params:\n");
  add_sheet();
  text.add("    columns: 10\n    rows: 7\nsinks:\n  - use: sinks/dataset\n    params: {path: .}\n");
  return text;
}

/// The pipeline that simulates independent images and stores them for the training of networks.
GeneratedText learning_text(const FrexOptions& options) {
  const std::string texture =
      yaml_quoted(std::filesystem::absolute(options.texture).lexically_normal().string());
  const std::string size =
      fmt::format("width_m: {}, height_m: {}", options.width_m, options.height_m);
  GeneratedText text("weft data make frex");
  add_settings(options, " --for learning", text);
  text.add(
      "weft: 1\non_error: stop\nsequence: false\nsource:\n  use: sources/frex_samples\n"
      "  params:\n    object:\n      use: templates/rectangular\n");
  text.add("      params: {texture: " + texture + ",\n", "--texture " + options.texture);
  text.add("        " + size + ",\n", "--width-m");
  text.add("        columns: 40, rows: 28}\n");
  text.add(fmt::format("    frames: {}\n", options.frames), "--frames");
  text.add(fmt::format("    seed: {}\n", options.seed), "--seed");
  text.add("template:\n  use: templates/rectangular\n  params: {texture: " + texture + ",\n",
           "--texture " + options.texture);
  text.add("    " + size + ", columns: 10, rows: 7}\n", "--width-m");
  text.add("sinks:\n  - use: sinks/shards\n    params: {path: .}\n");
  return text;
}

Result<GeneratedText> pipeline_text(const FrexOptions& options, Context& context) {
  if (!options.purpose.empty()) return learning_text(options);
  if (options.video.empty()) return simulation_text(options);
  return frex_video_pipeline(context, {options.video, options.camera, options.layout,
                                       options.texture, options.background, options.seed});
}

void make(const FrexOptions& options, Context& context) {
  if (!options.sheet.empty()) {
    context.exit_code = make_frex_sheet(context, {options.sheet, options.seed, options.overwrite});
    return;
  }
  if (options.folder.empty() || options.texture.empty()) {
    print_error({Errc::invalid_value,
                 "a sequence needs --out FOLDER and --texture IMAGE; the marker page needs --sheet "
                 "FILE.pdf",
                 "weft data make frex"});
    context.exit_code = kBadConfiguration;
    return;
  }
  const Result<GeneratedText> pipeline = pipeline_text(options, context);
  if (!pipeline) {
    print_error(pipeline.error());
    context.exit_code = pipeline.error().code == Errc::io ? kInputOutput : kBadConfiguration;
    return;
  }
  make_sequence(*pipeline, options.folder, options.settings, options.quiet,
                options.purpose.empty() ? frames_in_sequence : frames_in_shards,
                {Errc::invalid_data,
                 "the marker page is found in no frame: check that the layout belongs to this "
                 "page, and that its markers are sharp and at least 18 px wide",
                 options.video},
                context);
}

/// Adds the options of recorded videos only, and those of simulations only.
void add_kinds(CLI::App& command, FrexOptions& options) {
  CLI::Option* purpose =
      command
          .add_option("--for", options.purpose,
                      "learning: independent images (sources/frex_samples), stored with their "
                      "labels as arrays (sinks/shards)")
          ->check(CLI::IsMember({"learning"}));
  CLI::Option* video =
      command.add_option("--video", options.video, "Film of the marker page, to be textured");
  command.add_option("--camera", options.camera, "Camera file of the film")->needs(video);
  command
      .add_option("--layout", options.layout, "Layout of the marker page, written beside its PDF")
      ->needs(video);
  video->needs("--camera")->needs("--layout")->excludes(purpose);
  for (CLI::Option* option :
       {command.add_option("--width-m", options.width_m, "Width of the simulated surface"),
        command.add_option("--height-m", options.height_m, "Its height; 0: texels are square"),
        command.add_option("--frames", options.frames, "Number of simulated frames")}) {
    option->capture_default_str()->excludes(video);
  }
  command
      .add_option("--pattern", options.pattern, "roll, s_bend, corner_fold, wave, handles or bulge")
      ->excludes(video)
      ->excludes(purpose);
  command.add_flag("--occluder", options.occluder, "An arm hides parts of the surface")
      ->excludes(video)
      ->excludes(purpose);
  purpose->excludes(command.get_option("--background"));
}

}  // namespace

void add_data_make_frex(CLI::App& make_command, Context& context) {
  const auto options = std::make_shared<FrexOptions>();
  CLI::App* command = make_command.add_subcommand(
      "frex",
      "A printed surface before a camera, simulated (sources/frex) or filmed (--video, "
      "sources/frex_video), or the marker page to be filmed (--sheet)");
  CLI::Option* sheet =
      command->add_option("--sheet", options->sheet,
                          "Write only the page of ArUco markers to be printed and filmed: a PDF, "
                          "and beside it its layout (.yaml) and its image (.png)");
  command->add_option("--out", options->folder, "Folder of the sequence, new or empty");
  command->add_option("--texture", options->texture, "Image printed on the surface");
  CLI::Option* seed = command
                          ->add_option("--seed", options->seed,
                                       "Chooses movement, light, background and noise; for a "
                                       "marker page, the markers' places")
                          ->check(CLI::NonNegativeNumber)
                          ->capture_default_str();
  command->add_option("--background", options->background,
                      "plain, clutter, look_alike or image; of a film original, white or image");
  add_kinds(*command, *options);
  command
      ->add_option("--set", options->settings,
                   "PATH=VALUE, such as source.noise_grey=4 or source.cut_frames=[20]; may be "
                   "repeated; see `weft plugins show sources/frex`")
      ->allow_extra_args(false);
  CLI::Option* quiet = command->add_flag("--quiet", options->quiet, "No progress");
  CLI::Option* overwrite =
      command->add_flag("--overwrite", options->overwrite, "Replace the files of a marker page")
          ->needs(sheet);
  for (CLI::Option* option : command->get_options()) {
    const bool goes = option == sheet || option == seed || option == quiet || option == overwrite;
    if (!goes && option != command->get_help_ptr()) sheet->excludes(option);
  }
  command->callback([&context, options] { make(*options, context); });
}

}  // namespace weft::cli
