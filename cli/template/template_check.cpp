// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <weft/data/matrix.hpp>

#include "cli/output/json_text.hpp"
#include "cli/output/new_file.hpp"
#include "cli/output/report_text.hpp"
#include "cli/run/run_settings.hpp"
#include "cli/template/template_commands.hpp"
#include "cli/template/template_picture.hpp"
#include "pipeline/runs/frame_loop.hpp"
#include "pipeline/survey/first_frame.hpp"

namespace weft::cli {
namespace {

struct TemplateCheckOptions {
  std::string pipeline, png;
  std::vector<std::string> settings;
  bool json = false;
  bool overwrite = false;  ///< png
};

/// The frame with the object at rest where the matches have it.
Result<void> write_frame(const host::Registry& registry, const FirstFrame& first,
                         const RigidAlignment& pose, const std::string& path) {
  const auto templ = host::view_as<Template>(*first.templ);
  if (!templ) return templ.error();
  const Points3 vertices_m = transform_points(pose, templ->vertices_m.matrix<3>());
  Shape shape;
  shape.vertices_m = make_array<double>(vertices_m);
  shape.source = Array<std::uint8_t>({vertices_m.rows()}, 1);
  const auto record = host::Record::copy_of(shape);
  if (record == nullptr) return Error{Errc::no_memory, "no memory for the picture"};
  const weft_record inputs[] = {first.image->view("image"), first.camera->view("camera"),
                                first.templ->view("template"),
                                first.matches->view("correspondences"), record->view("shape")};
  return write_picture(registry, inputs, Picture::matches, path);
}

void print(const TemplateCheckOptions& options, const FirstLook& look,
           const std::vector<std::string>& faults) {
  if (options.json) {
    nlohmann::ordered_json json = {
        {"kept", look.kept}, {"kept_mirrored", look.kept_mirrored}, {"faults", faults}};
    for (const FlippedFit& fit : look.fits) {
      json["median_px"][to_string(fit.flip)] = fit.pose.median_px;
    }
    return print_json(json);
  }
  fmt::print("matches   {} kept in frame 0, {} with the texture mirrored\n", look.kept,
             look.kept_mirrored);
  for (const FlippedFit& fit : look.fits) {
    fmt::print("at rest   {:.1f} px off (median of {}) with flip: {}\n", fit.pose.median_px,
               fit.matches, to_string(fit.flip));
  }
  for (const std::string& fault : faults) fmt::print("fault     {}\n", fault);
  if (faults.empty()) fmt::print("no fault found\n");
}

void check(const TemplateCheckOptions& options, Context& context) {
  const auto registry = context.registry();
  if (!options.png.empty()) {
    if (auto fresh = check_new_file(options.png, options.overwrite); !fresh) {
      context.exit_code = kInputOutput;
      return print_error(fresh.error());
    }
  }
  context.exit_code = kBadConfiguration;
  const std::string folder = std::filesystem::absolute(free_folder(options.pipeline)).string();
  const auto [pipeline, report] =
      check_pipeline(options.pipeline, registry, folder, options.settings);
  if (!report.ok()) {
    print_report(report);
    return;
  }
  const auto lane = lane_of(pipeline.config, {});
  if (!lane) return print_error(lane.error());
  const auto first = look_at_first_frame(pipeline.config, pipeline.graph, **lane);
  if (!first) return print_error(first.error());
  const auto& fits = first->look.fits;
  if (!options.png.empty() && first->image != nullptr && !fits.empty()) {
    auto written =
        write_frame(registry, *first, fits.front().pose.camera_from_template, options.png);
    if (!written) {
      context.exit_code = kInputOutput;
      return print_error(written.error());
    }
  }
  const std::vector<std::string> faults = faults_of(first->look);
  print(options, first->look, faults);
  context.exit_code = faults.empty() ? kDone : kNotUsable;
}

}  // namespace

void add_template_check(CLI::App& parent, Context& context) {
  const auto options = std::make_shared<TemplateCheckOptions>();
  CLI::App* command = parent.add_subcommand(
      "check", "Tell whether a pipeline's template fits frame 0, which shows it about at rest");
  command->add_option("PIPELINE", options->pipeline, "Pipeline file")->type_name("")->required();
  add_settings(*command, options->settings);
  command
      ->add_option("--png", options->png,
                   "Draw frame 0 with the object at rest and how far matches are off")
      ->option_text("FILE");
  add_overwrite(*command, options->overwrite);
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(
      "Exit codes:\n"
      "  0  no fault was found\n"
      "  1  the template is at fault\n"
      "  2  the pipeline is wrong, or its frame 0 cannot be read\n"
      "  3  the picture cannot be written");
  command->callback([&context, options] { check(*options, context); });
}

}  // namespace weft::cli
