// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace weft::cli {

/// Shared libraries that the program runs with, as files with their full versions.
std::vector<std::string> loaded_libraries();

/// The folder for temporary files.
struct TemporaryFolder {
  std::string path;
  bool writable = false;
  std::uintmax_t free_bytes = 0;
};
TemporaryFolder temporary_folder();

/// [bytes] memory available to programs, 0 if the system does not report it
std::uint64_t available_memory_bytes();

struct Camera {
  std::string device;       ///< "/dev/video0"
  std::string name;         ///< as its driver calls it
  bool accessible = false;  ///< to this user
};
std::vector<Camera> cameras();

/// OpenCL drivers that are installed, by the library that each names; none is loaded.
std::vector<std::string> opencl_drivers();

/// "/dev/nvidia0" ...
std::vector<std::string> nvidia_devices();

}  // namespace weft::cli
