// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/change_request.hpp>
#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

/// All data of a frame. A sink gets those in `needs` and `reads` of its About.
struct SinkInput {
  Call call;
  OptionalInput<Image> image{};
  OptionalInput<Camera> camera{};
  OptionalInput<Time> time{};
  OptionalInput<Template> templ{};
  OptionalInput<Keypoints> keypoints{};
  OptionalInput<Correspondences> correspondences{};
  OptionalInput<Warp> warp{};
  OptionalInput<WarpSamples> warp_samples{};
  OptionalInput<Sightlines> sightlines{};
  OptionalInput<Visibility> visibility{};
  OptionalInput<Shape> shape{};        ///< includes `predicted` and `lost` shapes: check its state
  OptionalInput<Shape> other_shape{};  ///< made by the stage that `from` names
  OptionalInput<GroundTruth> ground_truth{};
  OptionalInput<FrameReport> frame_report{};
  OptionalInput<RunSettings> run_settings{};  ///< settings that apply to this frame

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("image", self.image);
    visit("camera", self.camera);
    visit("time", self.time);
    visit("template", self.templ);
    visit("keypoints", self.keypoints);
    visit("correspondences", self.correspondences);
    visit("warp", self.warp);
    visit("warp_samples", self.warp_samples);
    visit("sightlines", self.sightlines);
    visit("visibility", self.visibility);
    visit("shape", self.shape);
    visit("other_shape", self.other_shape);
    visit("ground_truth", self.ground_truth);
    visit("frame_report", self.frame_report);
    visit("run_settings", self.run_settings);
  }
};

/// Role `sinks`: files, windows and streams. A killed run must leave readable files: write numbered
/// files under a temporary name and rename them. A sink that steers the run also implements
/// `std::vector<ChangeRequest> take_change_requests()` and `void answer(const ChangeAnswer&)`. The
/// host calls both from any thread, also during write().
class Sink : public Prepared {
 public:
  static constexpr const char* kRole = "sinks";
  /// Called once, after prepare().
  virtual Result<void> open(const Call& call) = 0;
  /// Called for each frame, in frame order.
  virtual Result<void> write(const SinkInput& in) = 0;
  /// Called once, after the last frame, also if the run failed.
  virtual Result<void> finish(const Call& call) = 0;

  static constexpr std::uint64_t kMethods = 0b111;
  static Role role() {
    return {kRole,
            {role_method<EmptyInput>("open", {}), role_method<SinkInput>("write", {}),
             role_method<EmptyInput>("finish", {})}};
  }

  std::int32_t process(ProcessCall& call) {
    const auto nothing = [](const auto&) { return Result<void>{}; };
    if (call.method() == WEFT_SINK_OPEN) {
      return call.run_with<EmptyInput>([&](const auto& in) { return open(in.call); }, nothing);
    }
    if (call.method() == WEFT_SINK_WRITE) {
      return call.run_with<SinkInput>([&](const auto& in) { return write(in); }, nothing);
    }
    return call.run_with<EmptyInput>([&](const auto& in) { return finish(in.call); }, nothing);
  }
};

}  // namespace weft
