// SPDX-License-Identifier: Apache-2.0
#pragma once

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_TARGET_OPENCL_VERSION 120
#include <CL/opencl.hpp>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::sift_gpu {

/// Every OpenCL device of this machine, GPUs first, else in the drivers' order; none is no error.
std::vector<cl::Device> all_devices();

/// Name, vendor and driver of a device, in one line.
std::string description(const cl::Device& device);

/// Those of all_devices().
std::vector<std::string> descriptions();

/// The device with this index among all_devices(), a number below 100, or the first whose name or
/// vendor contains the text, in any case. "gpu" selects the first GPU, and the empty text the first
/// device. The Error lists the devices.
Result<cl::Device> choose(const std::string& wanted);

/// A failed call of OpenCL as an Error with a suggestion; `doing` completes "while ...".
Error error_of(const cl::Error& failure, const std::string& doing);

/// A device with the compiled kernels, shared by all users of the same device.
class Device {
 public:
  /// Compiles the kernels, or takes them from the cache in $XDG_CACHE_HOME/weft/opencl (else
  /// ~/.cache). Throws cl::Error.
  explicit Device(const cl::Device& device);

  /// The one that is open already and not retired, or a new one.
  static Result<std::shared_ptr<Device>> open(const std::string& wanted);

  /// Retires it after a failure: a device that was lost comes back with a new context, if at all.
  /// Data in this context stay there, and may be out of reach.
  void retire() { is_retired_ = true; }
  bool is_retired() const { return is_retired_; }

  const cl::Context& context() const { return context_; }
  const cl::Program& program() const { return program_; }
  const cl::Device& handle() const { return device_; }
  const std::string& name() const { return name_; }
  cl_ulong largest_buffer_bytes() const { return largest_buffer_bytes_; }
  cl_ulong memory_bytes() const { return memory_bytes_; }

 private:
  cl::Device device_;
  cl::Context context_;
  cl::Program program_;
  std::string name_;
  cl_ulong largest_buffer_bytes_;
  cl_ulong memory_bytes_;
  std::atomic<bool> is_retired_ = false;
};

/// Waits until `event` is complete; false when `cancelled` returned true first. Throws cl::Error if
/// its command failed.
bool wait_for(const cl::Event& event, const std::function<bool()>& cancelled);

}  // namespace weft::sift_gpu
