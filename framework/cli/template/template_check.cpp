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
#include "cli/template/template_folder.hpp"
#include "cli/template/template_picture.hpp"
#include "pipeline/runs/frame_loop.hpp"
#include "pipeline/survey/refitting.hpp"
#include "pipeline/survey/template_survey.hpp"

namespace weft::cli {
namespace {

struct TemplateCheckOptions {
  std::string pipeline, png, refit;
  std::vector<std::string> settings;
  bool json = false;
  bool overwrite = false;   ///< png
  std::int64_t frames = 1;  ///< the first ones, which show the object at rest
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
  if (record == nullptr) return Error{Errc::no_memory, "no memory for the image"};
  const weft_record inputs[] = {first.image->view("image"), first.camera->view("camera"),
                                first.templ->view("template"),
                                first.matches->view("correspondences"), record->view("shape")};
  return write_picture(registry, inputs, Picture::matches, path);
}

nlohmann::ordered_json field_json(const ResidualField& field) {
  return {{"rms_px", field.rms_px},
          {"most_px", field.most_px},
          {"most_at_px", {field.most_at_px.x(), field.most_at_px.y()}},
          {"noise_px", field.noise_px},
          {"predicted", field.predicted},
          {"coherent", field.is_coherent()}};
}

/// Results of the command.
struct Findings {
  std::vector<std::string> faults, warnings;
  std::optional<RefittedTemplate> refitted;
};

void print_check_json(const FirstLook& look, const Findings& findings) {
  nlohmann::ordered_json json = {{"kept", look.kept},
                                 {"kept_mirrored", look.kept_mirrored},
                                 {"faults", findings.faults},
                                 {"warnings", findings.warnings}};
  for (const FlippedFit& fit : look.fits) {
    json["median_px"][to_string(fit.flip)] = fit.pose.median_px;
  }
  if (look.charts) {
    json["charts"] = {{"judged", look.charts->judged},
                      {"unmatched", look.charts->unmatched},
                      {"unmatched_share", look.charts->unmatched_share}};
  }
  if (look.field) json["field"] = field_json(*look.field);
  if (findings.refitted) json["field_refitted"] = field_json(findings.refitted->after);
  print_json(json);
}

void print(const TemplateCheckOptions& options, const FirstLook& look, const Findings& findings) {
  if (options.json) return print_check_json(look, findings);
  fmt::print("matches   {} kept in frame 0, {} with the texture mirrored\n", look.kept,
             look.kept_mirrored);
  for (const FlippedFit& fit : look.fits) {
    fmt::print("at rest   {:.1f} px off (median of {}) with flip: {}\n", fit.pose.median_px,
               fit.matches, to_string(fit.flip));
  }
  if (look.field) {
    const ResidualField& field = *look.field;
    fmt::print(
        "residual  {:.2f} px (rms) of the texture in a smooth way, at most {:.2f} px at ({:.0f}, "
        "{:.0f}) px; matches scatter by {:.2f} px\n",
        field.rms_px, field.most_px, field.most_at_px.x(), field.most_at_px.y(), field.noise_px);
  }
  if (look.charts) {
    fmt::print("charts    {} of {} that the image should show have matches\n",
               look.charts->judged - look.charts->unmatched, look.charts->judged);
  }
  for (const std::string& fault : findings.faults) fmt::print("fault     {}\n", fault);
  for (const std::string& warning : findings.warnings) fmt::print("warning   {}\n", warning);
  if (findings.refitted) {
    const RefittedTemplate& refitted = *findings.refitted;
    fmt::print(
        "refitted  written to {}, by {} matches of {} frames: {:.2f} px (rms) before, {:.2f} "
        "px now\n",
        options.refit, refitted.before.matches, refitted.frames, refitted.before.rms_px,
        refitted.after.rms_px);
  }
  if (findings.faults.empty() && findings.warnings.empty()) fmt::print("no fault found\n");
}

/// The template with corrected texture coordinates, in its new folder.
Result<RefittedTemplate> write_refitted(const host::Registry& registry, const FirstFrame& first,
                                        const std::string& folder) {
  auto refitted = refit(first);
  if (!refitted) return refitted.error();
  if (auto made = make_new_folder(folder); !made) return made.error();
  const auto written = write_template(registry, refitted->templ, folder);
  if (!written) return written.error();
  return refitted;
}

Result<Findings> findings_of(const FirstFrame& first) {
  Findings findings{faults_of(first.look), {}, {}};
  if (findings.faults.empty()) findings.warnings = doubts_of(first.look);
  const auto templ = host::view_as<Template>(*first.templ);
  if (!templ) return templ.error();
  for (std::string& each : warnings_of(survey_template(*templ))) {
    findings.warnings.push_back(std::move(each));
  }
  return findings;
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
  const auto execution = context_of(pipeline.config, {});
  if (!execution) return print_error(execution.error());
  const auto first =
      look_at_first_frame(pipeline.config, pipeline.graph, **execution, options.frames);
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
  auto findings = findings_of(*first);
  if (!findings) return print_error(findings.error());
  context.exit_code = findings->faults.empty() ? kDone : kNotUsable;
  Result<void> refitted;
  if (!options.refit.empty()) {
    auto written = write_refitted(registry, *first, options.refit);
    if (!written) {
      refitted = written.error();
    } else {
      findings->refitted = *std::move(written);
    }
  }
  print(options, first->look, *findings);
  if (refitted) return;
  context.exit_code = kInputOutput;
  print_error(refitted.error());
}

}  // namespace

void add_template_check(CLI::App& parent, Context& context) {
  const auto options = std::make_shared<TemplateCheckOptions>();
  CLI::App* command = parent.add_subcommand(
      "check", "Check whether a pipeline's template fits frame 0, which shows it about at rest");
  command->add_option("PIPELINE", options->pipeline, "Pipeline file")->type_name("")->required();
  add_settings(*command, options->settings);
  command
      ->add_option("--png", options->png,
                   "Draw frame 0 with the object at rest and how far matches are off")
      ->option_text("FILE");
  add_overwrite(*command, options->overwrite);
  command
      ->add_option("--refit", options->refit,
                   "Write the template with texture coordinates corrected by the matches")
      ->option_text("FOLDER");
  command
      ->add_option("--frames", options->frames,
                   "Number of first frames that show the object at rest, for --refit")
      ->option_text("N")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(
      "Exit codes:\n"
      "  0  no fault was found; doubts are warnings\n"
      "  1  the template is at fault\n"
      "  2  the pipeline is wrong, or its frame 0 cannot be read\n"
      "  3  the image or the template cannot be written, or no correction is known");
  command->callback([&context, options] { check(*options, context); });
}

}  // namespace weft::cli
