// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/output_folder.hpp>

#include "cli/commands.hpp"
#include "cli/output/new_file.hpp"
#include "cli/run/pipeline_parts.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kCells = 12;  ///< along the longer side of an image: few, for speed

struct InitOptions {
  std::string folder, picture, object, video;
  std::optional<std::string> camera;  ///< empty: there is none
  std::optional<double> width_m;
  std::optional<int> device;
};

/// The answer to a question on the terminal; nothing at the end of the input.
std::optional<std::string> ask(const std::string& question) {
  fmt::print("{}: ", question);
  std::fflush(stdout);
  std::string answer;
  if (!std::getline(std::cin, answer)) {
    fmt::print("\n");
    return std::nullopt;
  }
  return answer;
}

Error unanswered(const std::string& option) {
  return {Errc::invalid_value, "is missing, and there is no terminal to enter it: give the option",
          option};
}

Result<void> fill_in(InitOptions& options) {
  if (options.picture.empty() && options.object.empty()) {
    auto picture = ask("Image of the flat object, from edge to edge (PNG or JPEG)");
    if (!picture) return unanswered("--picture");
    options.picture = *std::move(picture);
  }
  if (options.object.empty() && !options.width_m) {
    const auto width = ask("Its printed width in metres, such as 0.297");
    if (!width) return unanswered("--width");
    double metres = 0.0;
    const char* const end = width->data() + width->size();
    if (const auto read = std::from_chars(width->data(), end, metres);
        read.ec != std::errc{} || read.ptr != end) {
      return Error{Errc::invalid_value, "is no number of metres: '" + *width + "'", "--width"};
    }
    options.width_m = metres;
  }
  if (!options.device && options.video.empty()) {
    const auto device = ask("Number N of the camera /dev/videoN, empty for 0");
    if (!device) return unanswered("--device");
    int number = 0;
    const char* const end = device->data() + device->size();
    const auto read = std::from_chars(device->data(), end, number);
    if (!device->empty() && (read.ec != std::errc{} || read.ptr != end || number < 0)) {
      return Error{Errc::invalid_value, "is no number of a camera: '" + *device + "'", "--device"};
    }
    options.device = number;
  }
  if (!options.camera) {
    options.camera = ask("Camera file of `weft calibrate`, empty where there is none").value_or("");
  }
  return {};
}

Result<TemplateKey> template_key(const InitOptions& options) {
  return options.object.empty() ? flat_template(options.picture, *options.width_m, kCells)
                                : mesh_template(options.object);
}

/// As pipelines/live.yaml, whole in one file.
std::string pipeline_text(const InitOptions& options, const std::string& templ) {
  const std::string camera = options.camera->empty() ? "" : ", camera: camera.yaml";
  const bool is_film = !options.video.empty();
  const std::string params =
      is_film
          ? fmt::format("params: {{path: {}{}}}", flow_quoted(fs::absolute(options.video)), camera)
          : fmt::format("params: {{device: {}{}}}", *options.device, camera);
  const char* what = is_film ? "Play the film" : "Show the object to the camera";
  return pipeline_head(what + std::string(": weft live live.yaml")) +
         fmt::format(
             "realtime: latest\n"
             "source: {{use: sources/video, {}}}\n"
             "{}"
             "stages:\n"
             "  - {{use: matchers/track, as: tracked}}\n"
             "  - {{use: detectors/sift_fast, when: {{not_ok: tracked, every: 30}}}}\n"
             "  - {{use: matchers/descriptor, params: {{direction: image_to_template}}}}\n"
             "  - {{use: matchers/merge, as: matches, from: {{correspondences: [tracked, "
             "matchers]}}}}\n"
             "  - use: filters/aem\n"
             "  - {{use: warps/bbs, params: {{robust: \"off\"}}}}\n"
             "  - use: passes/salient_cells\n"
             "  - use: solvers/particle_sft\n"
             "    params: {{initial_guess: {{use: solvers/brunet_mdh}}, tracked_damping: 0.05}}\n"
             "sinks:\n"
             "  - {{use: sinks/live, as: live}}\n",
             params, templ);
}

Result<void> check_size(const InitOptions& options) {
  if (!options.object.empty() && (!options.picture.empty() || options.width_m)) {
    return Error{Errc::invalid_value, "includes image and size: omit --picture and --width",
                 "--template"};
  }
  if (options.width_m && !(*options.width_m > 0.0 && std::isfinite(*options.width_m))) {
    return Error{Errc::invalid_value, "must be above 0 metres", "--width"};
  }
  return {};
}

Result<void> init(InitOptions options, const host::Registry& registry) {
  if (!is_free_for_folder(options.folder)) {
    return Error{Errc::io, "exists and is not an empty folder; choose another name",
                 options.folder};
  }
  if (auto filled = fill_in(options); !filled) return filled;
  if (auto fits = check_size(options); !fits) return fits;
  auto templ = template_key(options);
  if (!templ) return templ.error();
  std::vector<Copy> files = std::move(templ->files);
  if (!options.camera->empty()) files.push_back({*options.camera, "camera.yaml"});
  std::vector<Copy> inputs = files;
  if (!options.video.empty()) inputs.push_back({options.video, {}});
  if (auto there = check_are_there(inputs); !there) return there;
  if (auto made = make_new_folder(options.folder); !made) return made;
  return write_pipeline(options.folder, "live.yaml", pipeline_text(options, templ->text), files,
                        registry);
}

}  // namespace

void add_init_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<InitOptions>();
  CLI::App* command =
      app.add_subcommand("init", "Make a folder with a live pipeline for an object of yours");
  command->add_option("FOLDER", options->folder, "New folder")->type_name("")->required();
  command->add_option("--picture", options->picture, "Image of a flat object, from edge to edge")
      ->option_text("FILE");
  command->add_option("--width", options->width_m, "Its width")->option_text("METRES");
  command
      ->add_option("--template", options->object,
                   "Instead of both: a folder that `weft template make` wrote")
      ->option_text("FOLDER");
  CLI::Option* device =
      command->add_option("--device", options->device, "N of the camera /dev/videoN")
          ->option_text("N")
          ->check(CLI::NonNegativeNumber);
  command->add_option("--video", options->video, "A film instead of a camera; it stays where it is")
      ->option_text("FILE")
      ->excludes(device);
  command
      ->add_option("--camera", options->camera,
                   "Camera file, as `weft calibrate` writes it; empty: there is none")
      ->option_text("FILE");
  command->footer("Prompts for the values that are not given.");
  command->callback([&context, options] {
    if (const auto done = init(*options, context.registry()); !done) {
      print_error(done.error());
      context.exit_code = done.error().code == Errc::io ? kInputOutput : kBadConfiguration;
      return;
    }
    fmt::print("{}/live.yaml\nNext: weft live {}/live.yaml\n", options->folder, options->folder);
  });
}

}  // namespace weft::cli
