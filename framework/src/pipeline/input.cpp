// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <weft/pipeline/checks.hpp>
#include <weft/pipeline/input.hpp>
#include <weft/pipeline/methods.hpp>

namespace weft {
namespace {

using host::Outcome;
using host::RecordPtr;

Result<RecordPtr> output_of(const Outcome& outcome, const char* slot) {
  if (!outcome.usable()) return outcome.error;
  return outcome.find(slot);
}

Result<void> blame(Result<void> valid, const StageConfig& stage) {
  if (valid) return valid;
  return Error{valid.error().code, valid.error().message, stage.component.component().id};
}

}  // namespace

Result<PipelineInput> PipelineInput::open(const PipelineConfig& config, host::Lane& lane) {
  PipelineInput input(config, lane);
  if (auto opened = input.open_source(); !opened) return opened.error();
  if (auto built = input.build_template(); !built) return built.error();
  return input;
}

Result<void> PipelineInput::open_source() {
  const StageConfig& source = *config_->source;
  const auto instance = lane_->instantiate(source.component, source.name);
  if (!instance) return instance.error();
  source_ = *instance;
  auto camera = output_of(lane_->call(*source_, kOpenSource, {}, host::kOfflineFrame), "camera");
  if (!camera) return camera.error();
  camera_ = *std::move(camera);
  if (auto valid = blame(check_camera(*camera_), source); !valid) return valid;
  const auto count =
      output_of(lane_->call(*source_, kCountFrames, {}, host::kOfflineFrame), "count");
  if (!count) return count.error();
  frames_ = host::view_as<Count>(**count)->frames;
  return {};
}

Result<void> PipelineInput::build_template() {
  const StageConfig& templ = *config_->templ;
  const auto builder = lane_->instantiate(templ.component, templ.name);
  if (!builder) return builder.error();
  auto built = output_of(lane_->call(**builder, 0, {}, host::kOfflineFrame), "template");
  if (!built) return built.error();
  template_ = *std::move(built);
  return blame(check_template(*template_), templ);
}

Outcome PipelineInput::read_checked(std::uint64_t index) {
  Outcome read = lane_->call(*source_, kReadFrame, {}, index);
  for (const auto& [slot, record] : read.outputs) {
    const auto fits = blame(check_fits(*record, *template_, *camera_), *config_->source);
    if (!fits) return {WEFT_ERROR, fits.error(), {}};
  }
  return read;
}

std::optional<PipelineInput::Frame> PipelineInput::read(std::uint64_t index) {
  const auto start = std::chrono::steady_clock::now();
  Outcome read = read_checked(index);
  const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
  if (frames_ < 0 && read.status == WEFT_NO_RESULT) return std::nullopt;
  Frame frame{{index, {}, {}}, report_of(config_->source->name, read, ms.count())};
  for (const auto& [slot, record] : read.outputs) add_numbers(*record, frame.report);
  if (!read.usable()) frame.input.failure = read.error.message;
  frame.input.records = std::move(read.outputs);
  return frame;
}

}  // namespace weft
