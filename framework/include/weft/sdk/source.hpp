// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

/// Data of one frame from a source.
struct SourceFrame {
  std::optional<Image> image{};                      ///< undistorted image
  std::optional<Time> time{};                        ///< capture time
  std::optional<KnownPoints> known_points{};         ///< points with known positions
  std::optional<GroundTruth> ground_truth{};         ///< true positions
  std::optional<Correspondences> correspondences{};  ///< matches with the template
  std::optional<Region> region{};                    ///< usable part of the image
  std::optional<ObjectMask> object_mask{};           ///< pixels that show the object
};

/// Role `sources`: frames, their camera and, if known, the ground truth. Sources undistort the
/// images, so that all components see an ideal pinhole camera.
class Source {
 public:
  static constexpr const char* kRole = "sources";
  static constexpr About kAbout{};
  virtual ~Source() = default;

  /// Opens files or devices and returns the camera of the undistorted frames.
  virtual Result<Camera> open(const Call& call) = 0;
  /// Number of frames; -1 if unknown.
  virtual std::int64_t count() const = 0;
  /// Returns whether frames arrive on their own, as from a camera: `read` waits for the next frame
  /// and a frame not read in time is lost. Called after `open`.
  virtual bool live() const { return false; }
  /// Reads frame `index`, from 0. An unreadable frame is an error of that frame only;
  /// no_more_frames() ends the source.
  virtual Result<SourceFrame> read(std::int64_t index, const Call& call) = 0;

  static constexpr std::uint64_t kMethods = 0b111;
  static Role role() {
    return {kRole,
            {role_method<EmptyInput>("open", {output_slot<Camera>("camera")}),
             role_method<EmptyInput>("count", {output_slot<Count>("count")}),
             role_method<EmptyInput>(
                 "read", {output_slot<Image>("image", false), output_slot<Time>("time", false),
                          output_slot<KnownPoints>("known_points", false),
                          output_slot<GroundTruth>("ground_truth", false),
                          output_slot<Correspondences>("correspondences", false),
                          output_slot<Region>("region", false),
                          output_slot<ObjectMask>("object_mask", false)})}};
  }

  std::int32_t process(ProcessCall& call) {
    if (call.method() == WEFT_SOURCE_OPEN) {
      return call.run<EmptyInput>("camera", [&](const auto& in) { return open(in.call); });
    }
    if (call.method() == WEFT_SOURCE_COUNT) {
      return call.run<EmptyInput>("count", [&](const auto&) {
        return Result<Count>(Count{count(), live() ? 1 : 0});
      });
    }
    const auto read_frame = [&](const EmptyInput& in) {
      return read(static_cast<std::int64_t>(in.call.frame()), in.call);
    };
    return call.run_with<EmptyInput>(read_frame, [&](const SourceFrame& frame) {
      Result<void> status = call.write("image", frame.image);
      if (status) status = call.write("time", frame.time);
      if (status) status = call.write("known_points", frame.known_points);
      if (status) status = call.write("ground_truth", frame.ground_truth);
      if (status) status = call.write("correspondences", frame.correspondences);
      if (status) status = call.write("region", frame.region);
      if (status) status = call.write("object_mask", frame.object_mask);
      return status;
    });
  }
};

/// A nested source, for components that derive other frames from its frames.
struct SourceComponent : ComponentHandle {
  explicit SourceComponent(const char* default_component)
      : ComponentHandle{"sources", default_component} {}

  Result<Camera> open(const Call& call) const {
    return detail::invoke<Camera>(call, handle, WEFT_SOURCE_OPEN, {});
  }
  /// Number of frames, -1 if unknown, and whether they arrive on their own.
  Result<Count> count(const Call& call) const {
    return detail::invoke<Count>(call, handle, WEFT_SOURCE_COUNT, {});
  }
  /// Data of the frame of the call.
  Result<SourceFrame> read(const Call& call) const {
    const auto answer = detail::ask(call, handle, WEFT_SOURCE_READ, {});
    if (!answer) return answer.error();
    SourceFrame frame;
    Result<void> status = take(*answer, frame.image);
    if (status) status = take(*answer, frame.time);
    if (status) status = take(*answer, frame.known_points);
    if (status) status = take(*answer, frame.ground_truth);
    if (status) status = take(*answer, frame.correspondences);
    if (status) status = take(*answer, frame.region);
    if (status) status = take(*answer, frame.object_mask);
    if (!status) return status.error();
    if (!answer->degenerate_reason.empty()) return degenerate(frame, answer->degenerate_reason);
    return frame;
  }

 private:
  template <class RecordType>
  static Result<void> take(const detail::Answer& answer, std::optional<RecordType>& typed) {
    auto found = answer.find<RecordType>();
    if (!found) return {};
    if (!*found) return found->error();
    typed = **std::move(found);
    return {};
  }
};

}  // namespace weft
