// SPDX-License-Identifier: Apache-2.0
#include "cli/results/run_registration.hpp"

#include <filesystem>
#include <utility>
#include <weft/core/text_file.hpp>

#include "cli/data/sequence_maker.hpp"
#include "cli/standard_components.hpp"
#include "cli/template/template_builder.hpp"
#include "host/roles/role_rules.hpp"
#include "lab/metrics/runs/run_reader.hpp"
#include "pipeline/runs/frame_loop.hpp"

namespace weft::cli {
namespace {

/// The pass, with its parameters.
Result<host::ComponentSpec> pass_of(const FlatReference& reference,
                                    const host::Registry& registry) {
  std::string params;
  if (!reference.words.empty()) {
    params = "words: " + yaml_quoted(std::filesystem::absolute(reference.words).string()) + ", ";
  }
  for (const std::string& setting : reference.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == 0 || equals == setting.npos) {
      return Error{Errc::invalid_value, "--flat-set " + setting + ": write NAME=VALUE", {}};
    }
    params += setting.substr(0, equals) + ": " + setting.substr(equals + 1) + ", ";
  }
  auto spec = resolve_text(
      registry, std::string("{use: ") + registration_pass() + ", params: {" + params + "}}");
  if (!spec) return Error{Errc::invalid_value, spec.error().message, "--flat-reference"};
  return spec;
}

Result<host::RecordPtr> template_of(const std::string& folder) {
  const std::string file = folder + "/template.npz";
  const auto scene = host::read_npz(file);
  if (!scene) return scene.error();
  for (const auto& [slot, record] : *scene) {
    if (slot == "template") return record;
  }
  return Error{Errc::invalid_data, "holds no template", file};
}

}  // namespace

Result<std::unique_ptr<RunRegistration>> RunRegistration::open(const std::string& folder,
                                                               const FlatReference& reference,
                                                               const host::Registry& registry) {
  const std::string file = folder + "/pipeline.yaml";
  if (auto found = check_input(file, InputKind::file, "give the folder that `weft run` wrote");
      !found) {
    return found.error();
  }
  auto [config, report] = load_pipeline(file, registry, folder);
  if (!report.ok()) return Error{Errc::invalid_value, report.text(), {}};
  auto pass = pass_of(reference, registry);
  if (!pass) return pass.error();
  auto run = std::make_unique<RunRegistration>();
  run->config_ = std::move(config);
  run->spec_ = *std::move(pass);
  if (auto opened = run->open_source(folder); !opened) return opened.error();
  return run;
}

Result<void> RunRegistration::open_source(const std::string& folder) {
  auto templ = template_of(folder);
  if (!templ) return templ.error();
  template_ = *std::move(templ);
  auto context = context_of(config_, {});
  if (!context) return context.error();
  context_ = *std::move(context);
  auto input = PipelineInput::open(config_, *context_);
  if (!input) return input.error();
  input_ = *std::move(input);
  const std::string& id = spec_.component().id;
  if (input_->is_live()) {
    return Error{Errc::invalid_value,
                 "the source of the run is live, so that its images cannot be read again; add the "
                 "stage '" +
                     id + "' to the pipeline and run it",
                 config_.file};
  }
  const auto pass = context_->instantiate(spec_, id);
  if (!pass) return pass.error();
  pass_ = *pass;
  return context_->prepare(*pass_, *template_, *input_->camera());
}

Result<std::optional<Registration>> RunRegistration::measure(const lab::FrameLine& line,
                                                             const lab::FrameRecords& records) {
  for (const auto& [slot, shape] : records.owners) {
    if (slot != "shape" || measured_.contains(line.frame)) continue;
    auto made = measure(line.frame, *shape);
    if (!made) return made.error();
    measured_[line.frame] = *std::move(made);
  }
  const host::RecordPtr& made = measured_[line.frame];
  if (made == nullptr) return std::optional<Registration>();
  auto typed = host::view_as<Registration>(*made);
  if (!typed) return typed.error();
  return std::optional<Registration>(*std::move(typed));
}

Result<host::RecordPtr> RunRegistration::measure(std::uint64_t frame, const host::Record& shape) {
  const std::string name = "frame " + std::to_string(frame);
  const auto read = input_->read(frame);
  if (!read || !read->input.failure.empty()) return host::RecordPtr();
  const host::RecordPtr image = read->input.find("image");
  if (image == nullptr) {
    return Error{Errc::no_result,
                 name +
                     " has no image to compare with the flat reference; measure a pipeline "
                     "whose source gives images",
                 {}};
  }
  const std::vector<weft_record> inputs{template_->view("template"),
                                        input_->camera()->view("camera"), image->view("image"),
                                        shape.view("shape")};
  host::Outcome outcome = context_->call(*pass_, kRunStage, inputs, frame);
  if (outcome.usable()) return outcome.find("registration");
  const Error& error = outcome.error;
  return Error{error.code, name + ": " + error.message, error.where};
}

}  // namespace weft::cli
