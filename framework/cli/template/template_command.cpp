// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/output/json_text.hpp"
#include "cli/output/new_file.hpp"
#include "cli/template/template_builder.hpp"
#include "cli/template/template_commands.hpp"
#include "cli/template/template_component.hpp"
#include "cli/template/template_folder.hpp"
#include "cli/template/template_picture.hpp"
#include "cli/template/template_text.hpp"
#include "cli/template/texture_judgement.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCornersPage = "corners.html";

struct TemplateOptions {
  ChosenTemplate chosen;
  std::string out, png;
  bool json = false;
  bool overwrite = false;  ///< png
  std::optional<double> crop_px;
};

/// The folder that is made before the template is built, which may draw into it; it disappears
/// again unless something is in it.
class NewFolder {
 public:
  explicit NewFolder(std::string path) : path_(std::move(path)) {
    std::error_code code;
    is_new_ = !path_.empty() && !fs::exists(path_, code);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder() {
    std::error_code code;
    if (is_new_) fs::remove(path_, code);  // fails where it is not empty
  }
  Result<void> make() const { return path_.empty() ? Result<void>() : make_new_folder(path_); }
  std::string file(const char* name) const { return (fs::path(path_) / name).string(); }

  /// Where a file of the folder, if it is there, stands from now on: beside the folder, which is
  /// not to be, as FOLDER_name.
  std::optional<std::string> move_out(const char* name) const {
    std::error_code code;
    if (path_.empty() || !fs::is_regular_file(file(name), code)) return std::nullopt;
    fs::path beside = fs::absolute(path_, code).lexically_normal();
    if (!beside.has_filename()) beside = beside.parent_path();  // a path such as "poster/"
    beside += std::string("_") + name;
    fs::rename(file(name), beside, code);
    return code ? file(name) : beside.string();
  }

 private:
  std::string path_;
  bool is_new_ = false;
};

/// The component; its images and pages that it writes itself are placed in the folder.
host::ComponentSpec drawn_into(const NewFolder& folder, const host::Registry& registry,
                               host::ComponentSpec component) {
  for (const auto& [parameter, file] :
       {std::pair{"drawing", "corners.png"}, std::pair{"corners_page", kCornersPage}}) {
    auto drawn = with_output(registry, component, parameter, folder.file(file));
    if (drawn) component = *std::move(drawn);
  }
  return component;
}

/// Reports why there is no template, and whether its corners can be moved by hand.
Error with_page(Error error, const NewFolder& folder) {
  if (const auto page = folder.move_out(kCornersPage)) {
    error.message += "; open " + *page +
                     " in a browser, move the corners there, and give the text that it shows";
  }
  return error;
}

/// Prints the result and any doubts about it.
void print(const TemplateOptions& options, const std::string& id, const BuiltTemplate& built,
           const TemplateSurvey& numbers, const Result<TextureSurvey>& texture,
           const std::optional<TextureSize>& written_px) {
  auto warnings = warnings_of(numbers);
  if (!built.size_doubt.empty()) warnings.push_back(built.size_doubt);
  if (texture) {
    for (std::string& each : warnings_of(*texture, numbers)) warnings.push_back(std::move(each));
  }
  if (options.json) {
    auto json = numbers_json(numbers);
    json["note"] = built.note;
    json["reports"] = built.reports;
    if (texture) json.update(texture_json(*texture));
    json["warnings"] = warnings;
    if (written_px) json["written_px"] = *written_px;
    return print_json(json);
  }
  fmt::print("{}: {}\n{}", id, options.out.empty() ? "built" : "written to " + options.out,
             numbers_text(numbers));
  if (texture) fmt::print("{}", texture_text(*texture));
  if (written_px && options.crop_px) {
    fmt::print("written   texture.png is cropped to {} x {} px\n", (*written_px)[0],
               (*written_px)[1]);
  }
  for (const std::string& report : built.reports) fmt::print("note      {}\n", report);
  if (!built.note.empty()) fmt::print("note      {}\n", built.note);
  if (!texture) fmt::print("note      the texture is not judged: {}\n", texture.error().message);
  for (const std::string& warning : warnings) fmt::print("warning   {}\n", warning);
}

/// Writes the files of the options; the size of the texture, if one was written.
Result<std::optional<TextureSize>> write_files(const host::Registry& registry,
                                               const host::ComponentSpec& component,
                                               const host::Record& record, const Template& templ,
                                               const Result<TextureSurvey>& texture,
                                               const NewFolder& folder,
                                               const TemplateOptions& options) {
  std::optional<TextureSize> size_px;
  Result<void> drawn;
  if (!options.out.empty()) {
    const auto written = write_template(registry, component, templ, options.crop_px, options.out);
    if (!written) return written.error();
    size_px = *written;
    if (texture) drawn = write_twins(registry, record, *texture, folder.file("twins.png"));
  }
  if (drawn && !options.png.empty()) {
    drawn = write_picture(registry, record, Picture::mesh, options.png);
  }
  if (!drawn) return drawn.error();
  return size_px;
}

void run(const TemplateOptions& options, Context& context) {
  const auto registry = context.registry();
  if (!options.png.empty()) {
    if (auto fresh = check_new_file(options.png, options.overwrite); !fresh) {
      context.exit_code = kInputOutput;
      return print_error(fresh.error());
    }
  }
  context.exit_code = kBadConfiguration;
  auto component = component_of(options.chosen, registry);
  if (!component) return;
  const NewFolder folder(options.out);
  if (auto made = folder.make(); !made) {
    context.exit_code = kInputOutput;
    return print_error(made.error());
  }
  if (!options.out.empty()) component = drawn_into(folder, registry, *std::move(component));
  const auto built = build_template(*component);
  if (!built) return print_error(with_page(built.error(), folder));
  const auto templ = host::view_as<Template>(*built->record);
  if (!templ) return print_error(templ.error());
  const TemplateSurvey numbers = survey_template(*templ);
  const auto texture = judge_texture(registry, *built->record, numbers);
  auto written =
      write_files(registry, *component, *built->record, *templ, texture, folder, options);
  if (!written) {
    context.exit_code = kInputOutput;
    return print_error(written.error());
  }
  context.exit_code = kDone;
  print(options, component->component().id, *built, numbers, texture, *written);
}

/// Options of both commands.
CLI::App* add_command(CLI::App& parent, const char* name, const char* help,
                      const std::shared_ptr<TemplateOptions>& options) {
  CLI::App* command = parent.add_subcommand(name, help);
  add_choice(*command, options->chosen);
  command->add_flag("--json", options->json, "Print JSON");
  return command;
}

}  // namespace

void add_template_command(CLI::App& app, Context& context) {
  CLI::App* parent = app.add_subcommand("template", "Build a template, draw and measure it");
  parent->require_subcommand(1);
  const auto made = std::make_shared<TemplateOptions>();
  CLI::App* maker = add_command(
      *parent, "make", "Write mesh (OBJ), texture and drawings of a template into a folder", made);
  maker->add_option("--out", made->out, "Folder, new or empty")->option_text("FOLDER")->required();
  maker->add_option("--crop", made->crop_px, "Crop the texture to the object with this margin")
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
