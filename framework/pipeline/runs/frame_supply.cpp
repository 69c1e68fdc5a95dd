// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/frame_supply.hpp"

#include "pipeline/runs/latest_frames.hpp"

namespace weft {
namespace {

class AllFrames : public FrameSupply {
 public:
  explicit AllFrames(PipelineInput& input) : input_(input) {}

  bool has(std::uint64_t place) const override {
    return input_.frames() < 0 || place < static_cast<std::uint64_t>(input_.frames());
  }

  std::optional<PipelineInput::Frame> take(std::uint64_t place) override {
    return input_.read(place);
  }

 private:
  PipelineInput& input_;
};

class NewestFrames : public FrameSupply {
 public:
  NewestFrames(PipelineInput& input, host::ExecutionContext& context, Clock& clock,
               std::function<bool()> is_cancelled, std::function<void(std::uint64_t)> dropped)
      : input_(input),
        context_(context),
        clock_(clock),
        is_cancelled_(std::move(is_cancelled)),
        dropped_(std::move(dropped)) {}

  void start() override {
    const auto read = [this](std::uint64_t index) { return input_.read(index); };
    frames_.emplace(LatestFrames::Source{read, dropped_, input_.frames(), input_.is_live()},
                    clock_);
  }

  bool has(std::uint64_t /*place*/) const override { return true; }

  std::optional<PipelineInput::Frame> take(std::uint64_t /*place*/) override {
    return frames_->take(is_cancelled_);
  }

  void stop() override {
    if (!frames_) return;
    frames_->stop();
    context_.cancellation().flag() = true;
    frames_.reset();
    context_.cancellation().flag() = false;
  }

 private:
  PipelineInput& input_;
  host::ExecutionContext& context_;
  Clock& clock_;
  std::function<bool()> is_cancelled_;
  std::function<void(std::uint64_t)> dropped_;
  std::optional<LatestFrames> frames_;  ///< between start() and stop()
};

class FramesOfEarlierRun : public FrameSupply {
 public:
  FramesOfEarlierRun(RepeatedFrames frames, PipelineInput& input, host::ExecutionContext& context)
      : frames_(std::move(frames)), input_(input), context_(context) {}

  bool has(std::uint64_t /*place*/) const override { return true; }

  std::optional<PipelineInput::Frame> take(std::uint64_t place) override {
    return frames_.read(place, input_, context_);
  }

 private:
  RepeatedFrames frames_;
  PipelineInput& input_;
  host::ExecutionContext& context_;
};

}  // namespace

std::unique_ptr<FrameSupply> all_frames(PipelineInput& input) {
  return std::make_unique<AllFrames>(input);
}

std::unique_ptr<FrameSupply> newest_frames(PipelineInput& input, host::ExecutionContext& context,
                                           Clock& clock, std::function<bool()> is_cancelled,
                                           std::function<void(std::uint64_t)> dropped) {
  return std::make_unique<NewestFrames>(input, context, clock, std::move(is_cancelled),
                                        std::move(dropped));
}

Result<std::unique_ptr<FrameSupply>> repeated_frames(const RecordedRun& run, PipelineInput& input,
                                                     host::ExecutionContext& context) {
  auto frames = RepeatedFrames::of(run, input);
  if (!frames) return frames.error();
  return std::unique_ptr<FrameSupply>(
      std::make_unique<FramesOfEarlierRun>(*std::move(frames), input, context));
}

}  // namespace weft
