// SPDX-License-Identifier: Apache-2.0
#include "cli/results/run_registration.hpp"

#include <filesystem>
#include <optional>
#include <utility>
#include <weft/core/text_file.hpp>

#include "cli/data/sequence_maker.hpp"
#include "cli/standard_components.hpp"
#include "metrics/runs/run_reader.hpp"
#include "pipeline/configuration/config.hpp"
#include "pipeline/execution/registration_meter.hpp"
#include "pipeline/runs/frame_loop.hpp"

namespace weft::cli {
namespace {

constexpr const char* kOption = "--flat-reference";

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
  const auto document = yaml::parse(
      std::string("{use: ") + registration_pass() + ", params: {" + params + "}}", kOption);
  if (!document) return document.error();
  std::vector<yaml::Problem> problems = document->problems;
  auto spec =
      host::resolve_component(registry, *document->root.find("use"), document->root.find("params"),
                              host::PathRules::of_process({"."}, "."), problems);
  if (!problems.empty()) return Error{Errc::invalid_value, problems.front().message, kOption};
  return *std::move(spec);
}

/// All that the measurement of a run needs while its frames are read.
struct OpenedRun {
  PipelineConfig config;
  host::ComponentSpec pass;
  std::unique_ptr<host::Lane> lane;
  std::unique_ptr<RegistrationMeter> meter;
  host::RecordPtr measured;  ///< of the last frame
};

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

Result<evaluation::MeasureRegistration> registration_of_run(const std::string& folder,
                                                            const FlatReference& reference,
                                                            const host::Registry& registry) {
  const std::string file = folder + "/pipeline.yaml";
  if (auto found = check_input(file, InputKind::file, "give the folder that `weft run` wrote");
      !found) {
    return found.error();
  }
  auto [config, report] = load_pipeline(file, registry, folder);
  if (!report.ok()) return Error{Errc::invalid_value, report.text(), {}};
  auto templ = template_of(folder);
  if (!templ) return templ.error();
  auto pass = pass_of(reference, registry);
  if (!pass) return pass.error();
  const auto run = std::make_shared<OpenedRun>();
  run->config = std::move(config);
  run->pass = *std::move(pass);
  auto lane = lane_of(run->config, {});
  if (!lane) return lane.error();
  run->lane = *std::move(lane);
  auto meter = RegistrationMeter::open(run->config, *run->lane, *std::move(templ), run->pass);
  if (!meter) return meter.error();
  run->meter = *std::move(meter);
  return evaluation::MeasureRegistration(
      [run](const evaluation::FrameLine& line,
            const evaluation::FrameRecords& records) -> Result<std::optional<Registration>> {
        for (const auto& [slot, record] : records.owners) {
          if (slot != "shape") continue;
          auto measured = run->meter->measure(line.frame, *record);
          if (!measured) return measured.error();
          run->measured = *std::move(measured);
          if (run->measured == nullptr) break;
          auto typed = host::view_as<Registration>(*run->measured);
          if (!typed) return typed.error();
          return std::optional<Registration>(*std::move(typed));
        }
        return std::optional<Registration>();
      });
}

}  // namespace weft::cli
