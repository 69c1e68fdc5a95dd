// SPDX-License-Identifier: Apache-2.0
#include "device.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>
#include <weft/core/suggest.hpp>

#include "kept_process.hpp"
#include "program.hpp"

namespace weft::sift_gpu {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_gpu(const cl::Device& device) {
  return (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i > 0 ? "; " : "") + std::to_string(i) + ": " + names[i];
  }
  return text;
}

const char* name_of(cl_int code) {
  switch (code) {
    case CL_DEVICE_NOT_AVAILABLE:
      return "device not available";
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
      return "no memory left on the device";
    case CL_OUT_OF_RESOURCES:
      return "out of resources; the kernel failed or the device is lost";
    case CL_OUT_OF_HOST_MEMORY:
      return "no memory left in the driver";
    case CL_BUILD_PROGRAM_FAILURE:
      return "the kernels do not compile";
    case CL_INVALID_BUFFER_SIZE:
      return "a buffer is larger than the device allows";
    case CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST:
      return "an earlier step failed";
    default:
      return "see CL/cl.h";
  }
}

std::string cause_of(const cl::Error& failure) {
  return std::string(failure.what()) + " failed with " + std::to_string(failure.err()) + " (" +
         name_of(failure.err()) + ")";
}

/// The texts that can select a device: a kind, or a word of a name or of a vendor.
std::vector<std::string> words_of(const std::vector<cl::Device>& devices) {
  std::vector<std::string> words{"gpu"};
  for (const cl::Device& device : devices) {
    std::string names = device.getInfo<CL_DEVICE_NAME>() + " " + device.getInfo<CL_DEVICE_VENDOR>();
    std::replace_if(
        names.begin(), names.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, ' ');
    std::istringstream stream(lower(names));
    for (std::string word; stream >> word;) words.push_back(word);
  }
  return words;
}

/// All devices, and the errors of drivers that could not name theirs.
struct Found {
  std::vector<cl::Device> devices;
  std::string failures;
};

Found look_for_devices() {
  const KeptProcess kept;
  Found found;
  // That there is no platform, or no device, is reported as a failure too.
  const auto note = [&](const cl::Error& failure) {
    if (failure.err() == CL_PLATFORM_NOT_FOUND_KHR || failure.err() == CL_DEVICE_NOT_FOUND) return;
    found.failures += "; " + cause_of(failure);
  };
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error& failure) {
    note(failure);
  }
  for (const cl::Platform& platform : platforms) {
    try {
      std::vector<cl::Device> of_platform;
      platform.getDevices(CL_DEVICE_TYPE_ALL, &of_platform);
      found.devices.insert(found.devices.end(), of_platform.begin(), of_platform.end());
    } catch (const cl::Error& failure) {
      note(failure);
    }
  }
  std::stable_partition(found.devices.begin(), found.devices.end(), is_gpu);
  return found;
}

}  // namespace

std::vector<cl::Device> all_devices() { return look_for_devices().devices; }

std::string description(const cl::Device& device) {
  return device.getInfo<CL_DEVICE_NAME>() + " (" + device.getInfo<CL_DEVICE_VENDOR>() +
         ", driver " + device.getInfo<CL_DRIVER_VERSION>() + ")";
}

std::vector<std::string> descriptions() {
  std::vector<std::string> names;
  for (const cl::Device& device : all_devices()) names.push_back(description(device));
  return names;
}

Result<cl::Device> choose(const std::string& wanted) {
  const auto [devices, failures] = look_for_devices();
  if (devices.empty()) {
    return Error{Errc::not_found,
                 "there is no OpenCL device; install the driver of the GPU (its package has "
                 "'opencl-icd' in its name), or pocl-opencl-icd to compute on the processor" +
                     failures};
  }
  if (wanted.empty()) return devices.front();
  if (lower(wanted) == "gpu") {
    if (is_gpu(devices.front())) return devices.front();
    return Error{Errc::not_found, "no OpenCL device is a GPU; there are: " + list(descriptions())};
  }
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (std::to_string(i) == wanted) return devices[i];
  }
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  const bool is_index = wanted.size() < 3 && std::ranges::all_of(wanted, is_digit);
  for (const cl::Device& device : devices) {
    if (is_index) break;  // "1" is contained in many a name
    const std::string names =
        device.getInfo<CL_DEVICE_NAME>() + "\n" + device.getInfo<CL_DEVICE_VENDOR>();
    if (lower(names).find(lower(wanted)) != std::string::npos) return device;
  }
  const std::string near = nearest(lower(wanted), words_of(devices));
  return Error{Errc::not_found, "no OpenCL device is '" + wanted + "'; " +
                                    (near.empty() ? "" : "did you mean '" + near + "'? ") +
                                    "there are: " + list(descriptions())};
}

Error error_of(const cl::Error& failure, const std::string& doing) {
  return {Errc::plugin_failure, cause_of(failure) + " while " + doing, {}};
}

Device::Device(const cl::Device& device)
    : device_(device),
      context_(device),
      program_(compiled(context_, device_)),
      name_(description(device)),
      largest_buffer_bytes_(device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>()),
      memory_bytes_(device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>()) {}

Result<std::shared_ptr<Device>> Device::open(const std::string& wanted) {
  static std::mutex mutex;
  static std::map<cl_device_id, std::weak_ptr<Device>> open_devices;
  const KeptProcess kept;
  std::string name;
  try {
    const auto device = choose(wanted);
    if (!device) return device.error();
    name = description(*device);
    const std::lock_guard lock(mutex);
    std::weak_ptr<Device>& place = open_devices[(*device)()];
    if (auto shared = place.lock(); shared != nullptr && !shared->is_retired()) return shared;
    auto opened = std::make_shared<Device>(*device);
    place = opened;
    return opened;
  } catch (const cl::BuildError& failure) {
    if (failure.err() != CL_BUILD_PROGRAM_FAILURE) return error_of(failure, "opening " + name);
    std::string log;
    for (const auto& entry : failure.getBuildLog()) log += entry.second;
    return Error{Errc::unsupported, "the kernels do not compile on " + name + ": " + log};
  } catch (const cl::Error& failure) {
    return error_of(failure, name.empty() ? "looking for OpenCL devices" : "opening " + name);
  }
}

bool wait_for(const cl::Event& event, const std::function<bool()>& cancelled) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kBusy = std::chrono::milliseconds(1);
  constexpr auto kPause = std::chrono::microseconds(200);
  const auto start = Clock::now();
  for (;;) {
    const auto status = event.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>();
    if (status == CL_COMPLETE) return true;
    if (status < 0) throw cl::Error(status, "a command on the device");
    if (Clock::now() - start < kBusy) {
      std::this_thread::yield();
    } else {
      if (cancelled()) return false;
      std::this_thread::sleep_for(kPause);
    }
  }
}

}  // namespace weft::sift_gpu
