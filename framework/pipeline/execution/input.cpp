// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/input.hpp"

#include <algorithm>
#include <weft/data/correspondences.hpp>

#include "host/roles/role_rules.hpp"
#include "pipeline/execution/checks.hpp"
#include "pipeline/execution/stage_maker.hpp"

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

Result<PipelineInput> PipelineInput::open(const PipelineConfig& config,
                                          host::ExecutionContext& context, RecordPtr camera) {
  PipelineInput input(config, context);
  auto opened = camera == nullptr ? input.open_source() : input.use_camera(std::move(camera));
  if (!opened) return opened.error();
  if (auto built = input.build_template(); !built) return built.error();
  return input;
}

Result<void> PipelineInput::open_source() {
  const StageConfig& source = *config_->source;
  const auto instance = instantiate(*context_, source, source.component);
  if (!instance) return instance.error();
  source_ = *instance;
  auto camera = output_of(context_->call(*source_, kOpenSource, {}, host::kOfflineFrame), "camera");
  if (!camera) return camera.error();
  camera_ = *std::move(camera);
  if (auto valid = blame(check_camera(*camera_), source); !valid) return valid;
  const auto count =
      output_of(context_->call(*source_, kCountFrames, {}, host::kOfflineFrame), "count");
  if (!count) return count.error();
  const auto counted = host::view_as<Count>(**count);
  frames_ = counted->frames;
  is_live_ = counted->live != 0;
  return {};
}

Result<void> PipelineInput::use_camera(RecordPtr camera) {
  camera_ = std::move(camera);
  auto valid = check_camera(*camera_);
  if (valid) return valid;
  return Error{valid.error().code, valid.error().message, "camera"};
}

Result<void> PipelineInput::build_template() {
  const StageConfig& templ = *config_->templ;
  const auto builder = instantiate(*context_, templ, templ.component);
  if (!builder) return builder.error();
  const Outcome outcome = context_->call(**builder, kBuildTemplate, {}, host::kOfflineFrame);
  auto built = output_of(outcome, "template");
  if (!built) return built.error();
  template_ = *std::move(built);
  if (templ.isolation) context_->discard(**builder);  // its process has nothing more to do
  placer_.emplace(template_, context_->memory());
  if (auto legal = blame(check_template(*template_), templ); !legal) return legal;
  for (const std::string& doubt :
       {outcome.error.message,
        size_doubt_of(*template_, host::length_parameter(templ.component))}) {
    if (!doubt.empty()) context_->warn(templ.name, doubt);
  }
  return {};
}

Result<RecordPtr> PipelineInput::completed(const RecordPtr& record) {
  auto placed = placer_->place(record);
  if (!placed) return placed;
  if (auto fits = check_fits(**placed, *template_, *camera_); !fits) return fits.error();
  if (*placed == record) return placed;
  const auto matches = host::arrays_of<Correspondences>(**placed);
  if (matches->count() == 0) return placed;
  const std::int32_t* face = matches->face.data();
  if (std::any_of(face, face + matches->count(), [](std::int32_t f) { return f >= 0; })) {
    return placed;
  }
  const auto number = [](double px) { return std::to_string(px); };
  return Error{Errc::invalid_data, "none of the " + std::to_string(matches->count()) +
                                       " matches lies on the template, the first is at (" +
                                       number(matches->template_px(0, 0)) + ", " +
                                       number(matches->template_px(0, 1)) +
                                       ") px of its texture: check their units"};
}

Outcome PipelineInput::read_checked(std::uint64_t index) {
  Outcome read = context_->call(*source_, kReadFrame, {}, index);
  for (auto& [slot, record] : read.outputs) {
    auto fits = completed(record);
    if (!fits) {
      const std::string& source = config_->source->component.component().id;
      return {WEFT_ERROR, {fits.error().code, fits.error().message, source}, {}};
    }
    record = *std::move(fits);
  }
  return read;
}

std::optional<PipelineInput::Frame> PipelineInput::read(std::uint64_t index) {
  const host::Stopwatch watch = context_->times().stopwatch();
  Outcome read = read_checked(index);
  const host::Spent took = watch.spent();
  if (read.status == WEFT_END) return std::nullopt;
  return frame_of(index, std::move(read), took);
}

Result<PipelineInput::Frame> PipelineInput::take(std::uint64_t index, host::NamedRecords records) {
  const host::Stopwatch watch = context_->times().stopwatch();
  for (auto& [slot, record] : records) {
    auto fits = completed(record);
    if (!fits) return Error{fits.error().code, fits.error().message, slot};
    record = *std::move(fits);
  }
  return frame_of(index, {WEFT_OK, {}, std::move(records)}, watch.spent());
}

PipelineInput::Frame PipelineInput::frame_of(std::uint64_t index, Outcome read,
                                             host::Spent took) const {
  Frame frame{{index, {}, {}}, report_of(source_name_, read, took, context_->memory())};
  for (const auto& [slot, record] : read.outputs) add_numbers(*record, frame.report);
  if (!read.usable()) frame.input.failure = read.error.message;
  frame.input.records = std::move(read.outputs);
  return frame;
}

}  // namespace weft
