// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "device.hpp"
#include "kernel_sizes.hpp"

namespace weft::sift_gpu {

/// Runs single kernels on vectors.
class KernelRunner {
 public:
  /// Those of the first device.
  KernelRunner() : KernelRunner(*Device::open("")) {}
  explicit KernelRunner(const std::shared_ptr<Device>& device)
      : KernelRunner(device, device->program()) {}
  KernelRunner(std::shared_ptr<Device> device, cl::Program program)
      : device_(std::move(device)),
        program_(std::move(program)),
        queue_(device_->context(), device_->handle()) {}

  /// A buffer of the device that holds `values`.
  template <class T>
  cl::Buffer upload(const std::vector<T>& values) {
    const std::size_t bytes = sizeof(T) * values.size();
    cl::Buffer buffer(device_->context(), CL_MEM_READ_WRITE, bytes);
    queue_.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, values.data());
    return buffer;
  }

  template <class T>
  std::vector<T> download(const cl::Buffer& buffer, std::size_t count) {
    std::vector<T> values(count);
    queue_.enqueueReadBuffer(buffer, CL_TRUE, 0, sizeof(T) * count, values.data());
    return values;
  }

  /// One item for each pixel, and more, to fill whole groups of 32 x 8.
  template <class... Args>
  void over_pixels(const char* kernel, int width, int height, const Args&... args) {
    const auto whole = [](int length, int tile) {
      return static_cast<cl::size_type>((length + tile - 1) / tile * tile);
    };
    run(kernel, cl::NDRange(whole(width, 32), whole(height, 8)), cl::NDRange(32, 8), args...);
  }

  /// One group for each of `count` spots.
  template <class... Args>
  void over_spots(const char* kernel, std::size_t count, const Args&... args) {
    run(kernel, cl::NDRange(kGroup * count), cl::NDRange(kGroup), args...);
  }

  /// One item for each of `count` things, and more, to fill whole groups.
  template <class... Args>
  void over_items(const char* kernel, std::size_t count, const Args&... args) {
    over_spots(kernel, (count + kGroup - 1) / kGroup, args...);
  }

  /// One group for each of `count` tiles, of an item for each block of the tile.
  template <class... Args>
  void over_tiles(const char* kernel, std::size_t count, const Args&... args) {
    constexpr cl::size_type kAcross = kTileSide / kTileBlock, kItems = kAcross * kAcross;
    run(kernel, cl::NDRange(kItems * count), cl::NDRange(kItems), args...);
  }

 private:
  template <class... Args>
  void run(const char* name, const cl::NDRange& global, const cl::NDRange& group,
           const Args&... args) {
    cl::Kernel kernel(program_, name);
    cl_uint index = 0;
    (kernel.setArg(index++, args), ...);
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, global, group);
    queue_.finish();
  }

  std::shared_ptr<Device> device_;
  cl::Program program_;
  cl::CommandQueue queue_;
};

/// Values between two guards that a kernel must neither use nor change: not a number where it
/// reads, so that a result shows it.
class Guarded {
 public:
  static constexpr std::size_t kGuard = 100;

  explicit Guarded(std::size_t count) : Guarded(std::vector<float>(count, -1.0F)) {}
  explicit Guarded(const std::vector<float>& values)
      : all_(values.size() + 2 * kGuard, std::numeric_limits<float>::quiet_NaN()) {
    std::copy(values.begin(), values.end(), all_.begin() + kGuard);
  }

  /// With both guards.
  const std::vector<float>& all() const { return all_; }

  /// The content between the guards after a kernel has written to a copy of all().
  static std::vector<float> inside(const std::vector<float>& written) {
    const auto is_guard = [](float value) { return value != value; };
    EXPECT_TRUE(std::all_of(written.begin(), written.begin() + kGuard, is_guard));
    EXPECT_TRUE(std::all_of(written.end() - kGuard, written.end(), is_guard));
    return {written.begin() + kGuard, written.end() - kGuard};
  }

 private:
  std::vector<float> all_;
};

}  // namespace weft::sift_gpu
