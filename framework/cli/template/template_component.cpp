// SPDX-License-Identifier: Apache-2.0
#include "cli/template/template_component.hpp"

#include <fmt/format.h>

#include <utility>

#include "cli/data/sequence_maker.hpp"
#include "cli/output/report_text.hpp"
#include "cli/run/pipeline_parts.hpp"
#include "cli/standard_components.hpp"
#include "pipeline/configuration/config.hpp"

namespace weft::cli {
namespace {

/// Settings of --set, as entries of a YAML map.
Result<std::string> entries_of(const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == 0 || equals == setting.npos) {
      return Error{Errc::invalid_value, "--set " + setting + ": write NAME=VALUE"};
    }
    text += setting.substr(0, equals) + ": " + setting.substr(equals + 1) + ", ";
  }
  return text;
}

/// The parameters of the plugin for photographs, as entries of a map in YAML.
Result<std::string> entries_of_photo(const ChosenTemplate& chosen) {
  std::string text =
      fmt::format("photo: {}, width_m: {}, ", yaml_quoted(chosen.photo), *chosen.width_m);
  if (chosen.height_m) text += fmt::format("height_m: {}, ", *chosen.height_m);
  if (!chosen.camera.empty()) text += "camera: " + yaml_quoted(chosen.camera) + ", ";
  if (chosen.corners.empty()) return text;
  const auto corners = corner_list(chosen.corners);
  if (!corners) return corners.error();
  return text + "corners: " + *corners + ", ";
}

/// The component of --use or --photo and --set.
std::optional<host::ComponentSpec> named_component(const ChosenTemplate& chosen,
                                                   const host::Registry& registry) {
  const auto fail = [](const Error& error) {
    print_error(error);
    return std::nullopt;
  };
  const auto of_photo =
      chosen.photo.empty() ? Result<std::string>(std::string()) : entries_of_photo(chosen);
  if (!of_photo) return fail(of_photo.error());
  const auto set = entries_of(chosen.settings);
  if (!set) return fail(set.error());
  const std::string id = chosen.photo.empty() ? chosen.use : photo_template();
  const auto document = yaml::parse("{use: " + id + ", params: {" + *of_photo + *set + "}}",
                                    "--use, --photo and --set");
  if (!document) return fail(document.error());
  std::vector<yaml::Problem> problems = document->problems;
  auto spec =
      host::resolve_component(registry, *document->root.find("use"), document->root.find("params"),
                              host::PathRules::of_process({"."}, "."), problems);
  for (const yaml::Problem& problem : problems) {
    print_error({Errc::invalid_value, problem.message, {}});
  }
  return problems.empty() ? std::move(spec) : std::nullopt;
}

/// The component of a pipeline's section `template`; prints errors anywhere in the file.
std::optional<host::ComponentSpec> component_of_pipeline(const ChosenTemplate& chosen,
                                                         const host::Registry& registry) {
  auto [config, report] = load_pipeline(chosen.pipeline, registry, ".", chosen.settings);
  if (report.ok()) return std::move(config.templ->component);
  print_report(report);
  return std::nullopt;
}

}  // namespace

void add_choice(CLI::App& command, ChosenTemplate& chosen) {
  command.add_option("PIPELINE", chosen.pipeline, "Pipeline file; its template is built")
      ->type_name("");
  command.add_option("--use", chosen.use, "Plugin that builds it, instead of a pipeline")
      ->option_text("ID");
  command
      .add_option("--set", chosen.settings,
                  "Set a value: template.NAME=VALUE of a pipeline, NAME=VALUE with --use or "
                  "--photo; may be repeated")
      ->option_text("NAME=VALUE")
      ->allow_extra_args(false);
  CLI::Option* photo =
      command
          .add_option("--photo", chosen.photo, "Photograph of a flat rectangular object, instead")
          ->option_text("FILE");
  CLI::Option* width =
      command
          .add_option("--width", chosen.width_m, "Width of that object in metres, as it is read")
          ->option_text("M")
          ->check(CLI::PositiveNumber)
          ->needs(photo);
  photo->needs(width);
  command
      .add_option("--height", chosen.height_m,
                  "Its height; computed from corners and camera if omitted")
      ->option_text("M")
      ->check(CLI::PositiveNumber)
      ->needs(photo);
  command.add_option("--camera", chosen.camera, "Camera file of the photograph")
      ->option_text("FILE")
      ->needs(photo);
  command
      .add_option("--corners", chosen.corners,
                  "Its corners in px, from the top left on clockwise; found if omitted")
      ->option_text("\"X,Y X,Y X,Y X,Y\"")
      ->needs(photo);
}

std::optional<host::ComponentSpec> component_of(const ChosenTemplate& chosen,
                                                const host::Registry& registry) {
  const int given = static_cast<int>(!chosen.use.empty()) +
                    static_cast<int>(!chosen.pipeline.empty()) +
                    static_cast<int>(!chosen.photo.empty());
  if (given != 1) {
    print_error(
        {Errc::invalid_value, "give a pipeline file, --use ID or --photo FILE, one of them", {}});
    return std::nullopt;
  }
  return chosen.pipeline.empty() ? named_component(chosen, registry)
                                 : component_of_pipeline(chosen, registry);
}

}  // namespace weft::cli
