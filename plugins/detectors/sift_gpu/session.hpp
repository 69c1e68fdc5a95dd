// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/array.hpp>

#include "kept_descriptors.hpp"
#include "scale_plan.hpp"

namespace weft::sift_gpu {

/// An extremum of the scale space, or a keypoint, as the kernels write it.
struct Spot {
  float x, y;           ///< px of its octave
  float scale;          ///< sigma, px of its octave
  float angle;          ///< rad, clockwise from +x
  float response;       ///< |D|, grey levels 0 to 1
  std::int32_t octave;  ///< 0 for the first of the pyramid
  std::int32_t layer;
  std::int32_t reserved;

  bool operator==(const Spot&) const = default;
};

/// SIFT for images of one size on one device: the buffers are made once. All methods throw
/// cl::Error when the device fails and Cancelled when the call's host cancelled; after either the
/// session must not be used again.
class Session {
 public:
  /// `channels` is 1 or 3 (blue, green, red); for `timed` see Queue.
  Session(std::shared_ptr<Device> device, int width, int height, int channels,
          const Settings& settings, bool timed = false);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Bytes on the device that a session would need before the number of keypoints is known.
  static std::uint64_t bytes_needed(const ScalePlan& plan, int channels);
  /// The largest of its buffers.
  static std::uint64_t largest_buffer_bytes(const ScalePlan& plan);

  bool fits(const Device& device, int width, int height, int channels) const;

  /// Keypoints of the image [H,W] or [H,W,3], without duplicates, in the same order each time; the
  /// pyramid stays for describe().
  std::vector<Spot> find(const Array<std::uint8_t>& pixels, const CancelledCheck& cancelled);

  /// SIFT descriptors of keypoints of the last image. The device is still at work on them when this
  /// returns.
  std::shared_ptr<const KeptDescriptors> describe(const std::vector<Spot>& keypoints);

  /// See Queue.
  double kernel_ms() { return queue_.kernel_ms(); }

  /// See Queue.
  bool idle() const { return queue_.idle(); }

  /// Layers [octave_layers + 3,height,width] of an octave of the last image, for tests.
  std::vector<float> octave(std::size_t index);

 private:
  void upload(const Array<std::uint8_t>& pixels);
  void build_pyramid();
  void blur(std::uint64_t from_offset, const Octave& octave, const Blur& gaussian,
            std::uint64_t to_offset);
  void launch_extrema();
  void launch_orientations(int extrema);
  int read_count(const CancelledCheck& cancelled);
  const std::shared_ptr<const cl::Buffer>& free_rows(std::size_t bytes);

  std::shared_ptr<Device> device_;
  Settings settings_;
  ScalePlan plan_;
  int channels_;
  Queue queue_;
  cl::Kernel grey_levels_, blur_rows_, blur_columns_, halve_, extrema_, orientations_,
      descriptions_;
  cl::Buffer image_, scratch_, pyramid_, octaves_, taps_, count_, extrema_found_, keypoints_found_,
      selected_;
  int extrema_capacity_, keypoints_capacity_;
  int selected_capacity_ = 0;
  std::vector<std::shared_ptr<const cl::Buffer>> rows_;  ///< buffers of descriptors, in use
                                                         ///< elsewhere or free
};

}  // namespace weft::sift_gpu
