// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/whole_file.hpp>

#include "cli/output/json_text.hpp"
#include "cli/output/new_file.hpp"
#include "cli/template/template_builder.hpp"
#include "cli/template/template_commands.hpp"
#include "cli/template/template_picture.hpp"
#include "cli/template/template_text.hpp"
#include "host/records/npz.hpp"
#include "pipeline/configuration/config.hpp"
#include "pipeline/survey/template_map.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

struct TemplateOptions {
  std::string pipeline, use, out, png;
  std::vector<std::string> settings;
  bool json = false;
  bool overwrite = false;  ///< png
  std::optional<double> crop_px;
};

/// The shortest text that reads back as the same number.
std::string exact(double value) {
  char buffer[32];
  const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, end};
}

/// The mesh at rest with its texture coordinates, as templates/mesh reads it.
std::string to_obj(const Template& templ) {
  std::string text = "# metres; made by weft template make\nmtllib template.mtl\nusemtl texture\n";
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    text += fmt::format("v {} {} {}\n", exact(templ.vertices_m(v, 0)),
                        exact(templ.vertices_m(v, 1)), exact(templ.vertices_m(v, 2)));
  }
  const auto width = static_cast<double>(templ.texture.dim(1));
  const auto height = static_cast<double>(templ.texture.dim(0));
  for (std::int64_t v = 0; v < templ.flat_px.rows(); ++v) {
    text += fmt::format("vt {} {}\n", exact((templ.flat_px(v, 0) + 0.5) / width),
                        exact(1.0 - (templ.flat_px(v, 1) + 0.5) / height));
  }
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    text += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", templ.faces(f, 0) + 1, templ.faces(f, 1) + 1,
                        templ.faces(f, 2) + 1);
  }
  return text;
}

Result<void> write_folder(const host::Registry& registry, const host::Record& record,
                          const Template& templ, const fs::path& folder) {
  if (auto made = make_new_folder(folder.string()); !made) return made;
  const std::pair<const char*, std::string> files[] = {
      {"template.obj", to_obj(templ)},
      {"template.mtl", "newmtl texture\nKd 1 1 1\nillum 1\nmap_Kd texture.png\n"}};
  for (const auto& [name, content] : files) {
    if (auto written = write_whole(content, folder / name); !written) return written;
  }
  for (const auto& [name, picture] :
       {std::pair{"texture.png", Picture::texture}, std::pair{"drawing.png", Picture::mesh}}) {
    auto drawn = write_picture(registry, record, picture, (folder / name).string());
    if (!drawn) return drawn;
  }
  return {};
}

/// Where the vertices of one mesh lie on the other, both ways.
Result<host::NamedRecords> map_between(const Template& made, const Template& original) {
  host::NamedRecords records;
  for (const auto& [slot, from, onto] : {std::tuple{"template_on_original", &made, &original},
                                         std::tuple{"original_on_template", &original, &made}}) {
    const auto places = places_on_mesh(*from, *onto);
    if (!places) return places.error();
    const auto record = host::Record::make("places_on_mesh/1");
    const std::int64_t shape[] = {places->face.rows(), 3};
    void* faces = record->allocate("face", WEFT_I32, 1, shape);
    void* weights = record->allocate("weights", WEFT_F64, 2, shape);
    if (faces == nullptr || weights == nullptr) {
      return Error{Errc::no_memory, "no memory for the map between the meshes"};
    }
    std::memcpy(faces, places->face.data(), to_index(shape[0]) * sizeof(std::int32_t));
    std::memcpy(weights, places->weights.data(), to_index(3 * shape[0]) * sizeof(double));
    records.emplace_back(slot, record);
  }
  return records;
}

/// Nothing where the mesh is that of the template's file.
Result<host::NamedRecords> map_to_file(const host::Registry& registry,
                                       const host::ComponentSpec& component,
                                       const Template& templ) {
  const auto original = with_mesh_of_file(registry, component);
  if (!original) return host::NamedRecords{};
  const auto built = build_template(*original);
  if (!built) return built.error();
  const auto mesh = host::view_as<Template>(*built->record);
  if (!mesh) return mesh.error();
  return map_between(templ, *mesh);
}

Result<void> write_folder(const host::Registry& registry, const host::ComponentSpec& component,
                          const Template& templ, const TemplateOptions& options) {
  const auto map = map_to_file(registry, component, templ);
  if (!map) return map.error();
  const Template kept =
      options.crop_px ? with_cropped_texture(templ, *options.crop_px) : Template(templ);
  const auto record = host::Record::copy_of(kept);
  if (!record) return Error{Errc::no_memory, "no memory for the template"};
  if (auto written = write_folder(registry, *record, kept, options.out); !written) return written;
  if (map->empty()) return {};
  return host::write_npz((fs::path(options.out) / "map.npz").string(), *map);
}

/// The component that --use and --set name; mistakes are printed.
std::optional<host::ComponentSpec> named_component(const TemplateOptions& options,
                                                   const host::Registry& registry) {
  std::string text = "{use: " + options.use + ", params: {";
  for (const std::string& setting : options.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == 0 || equals == setting.npos) {
      print_error({Errc::invalid_value, "--set " + setting + ": write NAME=VALUE", {}});
      return std::nullopt;
    }
    text += setting.substr(0, equals) + ": " + setting.substr(equals + 1) + ", ";
  }
  const auto document = yaml::parse(text + "}}", "--use and --set");
  if (!document) {
    print_error(document.error());
    return std::nullopt;
  }
  std::vector<yaml::Problem> problems = document->problems;
  auto spec =
      host::resolve_component(registry, *document->root.find("use"), document->root.find("params"),
                              host::PathRules::of_process({"."}, "."), problems);
  for (const yaml::Problem& problem : problems) {
    print_error({Errc::invalid_value, problem.message, {}});
  }
  return problems.empty() ? std::move(spec) : std::nullopt;
}

/// The component of a pipeline's section `template`; mistakes anywhere in the file are printed.
std::optional<host::ComponentSpec> component_of_pipeline(const TemplateOptions& options,
                                                         const host::Registry& registry) {
  auto [config, report] = load_pipeline(options.pipeline, registry, ".", options.settings);
  if (report.ok()) return std::move(config.templ->component);
  fmt::print(stderr, "{}", report.text());
  return std::nullopt;
}

void run(const TemplateOptions& options, Context& context) {
  const auto registry = context.registry();
  context.exit_code = kBadConfiguration;
  if (options.use.empty() == options.pipeline.empty()) {
    return print_error({Errc::invalid_value, "give a pipeline file or --use ID, one of them", {}});
  }
  if (!options.png.empty()) {
    if (auto fresh = check_new_file(options.png, options.overwrite); !fresh) {
      context.exit_code = kInputOutput;
      return print_error(fresh.error());
    }
  }
  const auto component = options.use.empty() ? component_of_pipeline(options, registry)
                                             : named_component(options, registry);
  if (!component) return;
  const auto built = build_template(*component);
  if (!built) return print_error(built.error());
  const auto templ = host::view_as<Template>(*built->record);
  if (!templ) return print_error(templ.error());
  context.exit_code = kInputOutput;
  if (!options.out.empty()) {
    if (auto written = write_folder(registry, *component, *templ, options); !written) {
      return print_error(written.error());
    }
  }
  if (!options.png.empty()) {
    if (auto written = write_picture(registry, *built->record, Picture::mesh, options.png);
        !written) {
      return print_error(written.error());
    }
  }
  context.exit_code = kDone;
  const TemplateSurvey survey = survey_template(*templ);
  if (options.json) {
    auto json = numbers_json(survey);
    json["note"] = built->note;
    return print_json(json);
  }
  fmt::print("{}: {}\n{}", component->component().id,
             options.out.empty() ? "built" : "written to " + options.out, numbers_text(survey));
  if (!built->note.empty()) fmt::print("note      {}\n", built->note);
}

/// What both commands take.
CLI::App* add_command(CLI::App& parent, const char* name, const char* help,
                      const std::shared_ptr<TemplateOptions>& options) {
  CLI::App* command = parent.add_subcommand(name, help);
  command->add_option("PIPELINE", options->pipeline, "Pipeline file; its template is built")
      ->type_name("");
  command->add_option("--use", options->use, "Plugin that builds it, instead of a pipeline")
      ->option_text("ID");
  command
      ->add_option("--set", options->settings,
                   "Set a value: template.NAME=VALUE of a pipeline, NAME=VALUE with --use; may be "
                   "repeated")
      ->option_text("NAME=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--json", options->json, "Print JSON");
  return command;
}

}  // namespace

void add_template_command(CLI::App& app, Context& context) {
  CLI::App* parent = app.add_subcommand("template", "Build a template, draw and measure it");
  parent->require_subcommand(1);
  const auto made = std::make_shared<TemplateOptions>();
  CLI::App* maker = add_command(
      *parent, "make", "Write mesh (OBJ), texture and drawing of a template into a folder", made);
  maker->add_option("--out", made->out, "Folder, new or empty")->option_text("FOLDER")->required();
  maker
      ->add_option("--crop", made->crop_px,
                   "Crop the texture to the object and so many pixels beside it")
      ->option_text("PX")
      ->check(CLI::NonNegativeNumber);
  maker->callback([&context, made] { run(*made, context); });
  const auto shown = std::make_shared<TemplateOptions>();
  CLI::App* viewer = add_command(*parent, "show", "Print the figures of a template", shown);
  viewer->add_option("--png", shown->png, "Draw the mesh over the texture, and a curved object")
      ->option_text("FILE");
  add_overwrite(*viewer, shown->overwrite);
  viewer->callback([&context, shown] { run(*shown, context); });
  add_template_check(*parent, context);
}

}  // namespace weft::cli
