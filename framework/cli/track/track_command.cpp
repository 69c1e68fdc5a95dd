// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/output_folder.hpp>
#include <weft/core/text_file.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/template.hpp>

#include "cli/commands.hpp"
#include "cli/output/new_file.hpp"
#include "cli/output/program_root.hpp"
#include "cli/run/pipeline_parts.hpp"
#include "cli/run/running.hpp"
#include "cli/standard_components.hpp"
#include "cli/template/template_builder.hpp"
#include "cli/track/focal_measurement.hpp"
#include "cli/track/frame_files.hpp"
#include "host/loading/component_checks.hpp"
#include "lab/report/runs/run_report.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPipeline = "track.yaml";
constexpr int kLongest_px = 1300;  ///< limit of the frames: a letter then has about 4 px a mm
constexpr int kFineCells = 24;     ///< along the longer side of a flat object: creases of paper

struct TrackOptions {
  std::string frames, object, camera, folder, corners;
  std::optional<double> width_m;
  bool flat = false, unordered = false, quiet = false;
};

/// A template of the photograph, and what was taken for the object.
struct ChosenObject {
  TemplateKey templ;
  std::string words;
};

Result<void> check_source(const host::Registry& registry, const std::string& source,
                          const std::string& frames) {
  const auto spec = resolve_text(registry, source);
  if (!spec) return Error{spec.error().code, spec.error().message, frames};
  host::ComponentChecks checks;
  std::vector<yaml::Problem> problems;
  checks.ask(*spec, problems);
  if (problems.empty()) return {};
  // The message names the file where it is about one.
  return Error{Errc::invalid_data, problems.front().message, {}};
}

/// "{use: ..., params: {...}}" of the frames; `camera` is a path or a word, with further parameters
/// of the camera behind it.
std::string source_text(const FrameFiles& frames, const std::string& camera) {
  const FileSources sources = standard_sources();
  return fmt::format("{{use: {}, params: {{path: {}, longest_px: {}, camera: {}}}}}",
                     frames.is_video ? sources.video : sources.images, flow_quoted(frames.path),
                     kLongest_px, camera);
}

Result<ChosenObject> flat_object(const TrackOptions& options, double width_m,
                                 const std::string& words) {
  auto templ = flat_template(options.object, width_m, kFineCells);
  if (!templ) return templ.error();
  return ChosenObject{*std::move(templ), words};
}

/// True if the rectangle that was found was printed in a scan. Its sides are then parallel to those
/// of the image, unlike in an image of a hand-held camera.
bool is_printed(const host::Record& templ) {
  constexpr double kParallel = 0.007;  // [] 0.4 degrees
  const auto typed = host::view_as<Template>(templ);
  const auto* corners_px = typed ? typed->others.find<double>("x.weft.corners_px") : nullptr;
  if (corners_px == nullptr || corners_px->size() != 8) return false;
  for (std::int64_t k = 0; k < 4; ++k) {
    const double x = std::abs((*corners_px)((k + 1) % 4, 0) - (*corners_px)(k, 0));
    const double y = std::abs((*corners_px)((k + 1) % 4, 1) - (*corners_px)(k, 1));
    if (std::min(x, y) > kParallel * std::max(x, y)) return false;
  }
  return true;
}

/// The rectangle that the plugin for photographs takes for the object; `more` are further entries
/// of its parameters.
Result<BuiltTemplate> rectangle_in(const TrackOptions& options, double width_m,
                                   const std::string& more, const host::Registry& registry) {
  const auto spec = resolve_text(
      registry, fmt::format("{{use: {}, params: {{photo: {}, width_m: {}{}}}}}", photo_template(),
                            flow_quoted(fs::absolute(options.object)), width_m, more));
  if (!spec) return spec.error();
  return build_template(*spec);
}

/// The rectangle in a photograph, where one is found or given; else the photograph is the object.
Result<ChosenObject> choose_object(const TrackOptions& options, const host::Registry& registry) {
  const double width_m = options.width_m.value_or(1.0);
  if (options.flat) return flat_object(options, width_m, "the whole photograph (--flat)");
  std::string corners;
  if (!options.corners.empty()) {
    auto list = corner_list(options.corners);
    if (!list) return list.error();
    corners = ", corners: " + *list;
  }
  std::string seen_by;
  auto built = Result<BuiltTemplate>(no_result("no camera is given"));
  if (!options.camera.empty()) {
    // A photograph with the size of the frames belongs to their camera; another size is refused.
    const std::string camera = ", camera: " + flow_quoted(fs::absolute(options.camera));
    built = rectangle_in(options, width_m, corners + camera, registry);
    if (built) seen_by = ", camera: camera.yaml";
  }
  if (!built) built = rectangle_in(options, width_m, corners, registry);
  if (!built && !corners.empty()) return built.error();
  const bool is_found = built && corners.empty();
  if (is_found && is_printed(*built->record)) {
    return flat_object(options, width_m,
                       "the whole photograph; a rectangle in it is parallel to its sides, as in a "
                       "scan (--corners: it is the object)");
  }
  if (built) {
    return ChosenObject{photo_template_key(options.object, width_m, corners + seen_by),
                        corners.empty() ? "the rectangle that was found in the photograph (--flat: "
                                          "the whole photograph)"
                                        : "what lies between the given corners"};
  }
  return flat_object(options, width_m,
                     "the whole photograph, in which no rectangle was found (--corners: give the "
                     "corners of the object)");
}

/// Parts of a pipeline.
struct Tracked {
  FrameFiles frames;
  ChosenObject object;
};

std::string pipeline_text(const TrackOptions& options, const Tracked& tracked,
                          const std::string& camera) {
  const auto& [frames, object] = tracked;
  const fs::path base = program_root() / "share/weft/pipelines" / tracking_pipeline();
  std::string text = pipeline_head(
      fmt::format("After a change: weft run {0}/{1} --out {0}/run-2", options.folder, kPipeline));
  text += fmt::format("extends: {}\n", flow_quoted(base));
  if (!frames.is_sequence) text += "sequence: false\n";
  if (!options.width_m) text += "# Without its width in metres the object is one unit wide.\n";
  text += object.templ.text;
  text += "source: " + source_text(frames, camera) + "\n";
  if (!frames.is_sequence) {
    text +=
        "sinks:\n  - {use: sinks/overlay, as: overlay, params: {stills_every: 1}}\n"
        "  - {use: sinks/unwarped, as: unwarped}\n";
  }
  return text;
}

/// The folder of a film "clip.mp4": clip_tracked, or the first of clip_tracked-2 ... that is free.
std::string free_folder_of(const std::string& frames) {
  fs::path path = fs::absolute(frames).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  const std::string base = path.stem().string() + "_tracked";
  std::string folder = base;
  for (int i = 2; fs::exists(folder); ++i) folder = base + "-" + std::to_string(i);
  return folder;
}

/// Writes the pipeline and describes it; the options' folder is set.
Result<Tracked> make_pipeline(TrackOptions& options, const host::Registry& registry) {
  if (options.folder.empty()) options.folder = free_folder_of(options.frames);
  if (!is_free_for_folder(options.folder)) {
    return Error{Errc::io, "exists and is not an empty folder; choose another with --out",
                 options.folder};
  }
  if (auto found = check_input(options.object, InputKind::file,
                               "give a photograph of the object as --object");
      !found) {
    return found.error();
  }
  if (options.width_m && !(*options.width_m > 0.0 && std::isfinite(*options.width_m))) {
    return Error{Errc::invalid_value, "must be above 0 metres", "--width"};
  }
  if (auto image = picture_header(options.object); !image) return image.error();
  if (!options.camera.empty()) {
    if (auto found = check_input(options.camera, InputKind::file); !found) return found.error();
  }
  auto frames = find_frames(options.frames, options.object);
  if (!frames) return frames.error();
  if (options.unordered && !frames->is_video)
    frames->is_sequence = false, frames->why = "--unordered";
  const std::string camera =
      options.camera.empty() ? "auto" : flow_quoted(fs::absolute(options.camera));
  if (auto legal = check_source(registry, source_text(*frames, camera), options.frames); !legal) {
    return legal.error();
  }
  auto object = choose_object(options, registry);
  if (!object) return object.error();
  std::vector<Copy> files = std::move(object->templ.files);
  if (!options.camera.empty()) files.push_back({options.camera, "camera.yaml"});
  if (auto made = make_new_folder(options.folder); !made) return made.error();
  Tracked tracked{*std::move(frames), *std::move(object)};
  auto written = write_pipeline(
      options.folder, kPipeline,
      pipeline_text(options, tracked, options.camera.empty() ? "auto" : "camera.yaml"), files,
      registry);
  if (!written) return written.error();
  fmt::print("pipeline  {}/{}\n", options.folder, kPipeline);
  fmt::print("object    {}\n", tracked.object.words);
  if (!options.width_m) {
    fmt::print("lengths   in units of the object's width, since --width is not given\n");
  }
  if (!tracked.frames.is_video) {
    fmt::print("frames    {}: {}\n", tracked.frames.is_sequence ? "a sequence" : "unordered images",
               tracked.frames.why);
  }
  std::fflush(stdout);
  return tracked;
}

/// Measures the focal length where no camera file and no EXIF has it: in the first frames of a
/// film, or in all images of a folder. Writes the pipeline anew with the result.
Result<void> measure_camera(const TrackOptions& options, const Tracked& tracked, Context& context) {
  if (!options.camera.empty() || tracked.frames.tell_focal) return {};
  fmt::print("camera    not given: its focal length is measured in the first frames ...\n");
  std::fflush(stdout);
  std::vector<std::string> settings;
  if (tracked.frames.is_video) settings = {"source.params.step=3", "source.params.max_frames=60"};
  const std::string pipeline = options.folder + "/" + kPipeline;
  const auto focal = measure_focal(pipeline, settings, options.folder + "/camera", context);
  if (!focal) {
    fmt::print(
        "camera    the frames do not determine the focal length; depths are uncertain by 25 %\n");
    return {};
  }
  fmt::print("camera    focal length {:.3f} (+- {:.3f}) times the longer side, from {} frames\n",
             focal->by_side, focal->by_side_sd, focal->frames);
  const std::string camera = fmt::format("auto, focal_by_side: {:.4f}, focal_by_side_sd: {:.4f}",
                                         focal->by_side, focal->by_side_sd);
  return write_whole(pipeline_text(options, tracked, camera), pipeline);
}

/// In how many frames the object was found, and what to do where it was in none.
void print_found(const RunCounts& counts) {
  const std::int64_t found = counts.estimated + counts.weak;
  fmt::print("found     in {} of {} frames", found, counts.frames);
  if (counts.weak > 0) fmt::print(", in {} of them not for sure (weak)", counts.weak);
  fmt::print("\n");
  if (found > 0) return;
  std::fflush(stdout);
  fmt::print(stderr,
             "warning: the object was found in no frame: is it the one in the photograph given as "
             "--object, not mirrored, and is it in view, large and sharp enough?\n");
}

void track(TrackOptions options, Context& context) {
  const auto registry = context.registry();
  auto made = make_pipeline(options, registry);
  const Result<void> measured = made ? measure_camera(options, *made, context) : made.error();
  if (!measured) {
    print_error(measured.error());
    context.exit_code = measured.error().code == Errc::io ? kInputOutput : kBadConfiguration;
    return;
  }
  RunArguments arguments;
  arguments.pipeline = options.folder + "/" + kPipeline;
  arguments.folder = options.folder + "/run";
  arguments.quiet = options.quiet;
  const RunCounts counts = run(arguments, context);
  if (context.exit_code != kDone && context.exit_code != kFramesFailed) return;
  if (!lab::is_run_folder(arguments.folder)) return;  // interrupted before the first frame
  print_found(counts);
  const auto report = lab::write_run_report(
      arguments.folder, {{}, (program_root() / "share/weft/report").string(), unwarping_sink()});
  if (!report) {
    print_error(report.error());
    context.exit_code = kInputOutput;
    return;
  }
  fmt::print("overlay   {0}/overlay.avi\nmeshes    {0}/meshes\n", arguments.folder);
  if (const std::string flat = arguments.folder + "/unwarped"; fs::is_directory(flat)) {
    fmt::print("unwarped  {}\n", flat);
  }
  fmt::print("report    {}\n", report->page);
}

}  // namespace

void add_track_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<TrackOptions>();
  CLI::App* command = app.add_subcommand(
      "track", "Find an object in a video or in images: shapes, overlay and report");
  command->add_option("VIDEO_OR_FOLDER", options->frames, "Video, or folder of images")
      ->type_name("")
      ->required();
  command->add_option("--object", options->object, "Photograph or scan of the object, lying flat")
      ->option_text("FILE")
      ->required();
  command
      ->add_option("--width", options->width_m,
                   "Its width in metres; without it, lengths are in units of its width")
      ->option_text("M");
  command
      ->add_option("--camera", options->camera,
                   "Camera file of the frames; without it, it is assumed from EXIF or image size")
      ->option_text("FILE");
  command
      ->add_option("--out", options->folder,
                   "Folder, new or empty (default: <name of the video>_tracked)")
      ->option_text("FOLDER");
  CLI::Option* flat =
      command->add_flag("--flat", options->flat,
                        "The photograph shows the object from edge to edge; look for no corners");
  command
      ->add_option("--corners", options->corners,
                   "Its corners in the photograph in px, from the top left on clockwise")
      ->option_text("\"X,Y X,Y X,Y X,Y\"")
      ->excludes(flat);
  command->add_flag("--unordered", options->unordered,
                    "The images are no film: nothing depends on the one before");
  command->add_flag("--quiet", options->quiet, "No progress bar and no table of stages");
  command->footer(
      "Writes FOLDER/track.yaml, a pipeline to be changed and run again, and FOLDER/run with "
      "overlay.avi, meshes and report.html. Exit codes are those of `weft run`.");
  command->callback([&context, options] { track(*options, context); });
}

}  // namespace weft::cli
