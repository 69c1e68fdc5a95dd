// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/machine.hpp"

#include <link.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

/// Files of a folder called `prefix` and a number.
std::vector<std::string> numbered(const fs::path& folder, std::string_view prefix) {
  std::vector<std::string> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix) || name.size() == prefix.size()) continue;
    if (name.find_first_not_of("0123456789", prefix.size()) != std::string::npos) continue;
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<std::string> loaded_libraries() {
  std::vector<std::string> files;
  const auto add = [](dl_phdr_info* info, std::size_t, void* context) {
    std::error_code code;
    const fs::path file = fs::canonical(info->dlpi_name, code);  // the kernel's own is no file
    if (!code) static_cast<std::vector<std::string>*>(context)->push_back(file.string());
    return 0;
  };
  dl_iterate_phdr(add, &files);
  std::sort(files.begin(), files.end());
  return files;
}

TemporaryFolder temporary_folder() {
  TemporaryFolder folder;
  std::error_code code;
  folder.path = fs::temp_directory_path(code).string();
  std::string file = folder.path + "/weft-XXXXXX";
  const int descriptor = mkstemp(file.data());
  folder.writable = descriptor >= 0;
  if (folder.writable) {
    close(descriptor);
    unlink(file.c_str());
  }
  const fs::space_info space = fs::space(folder.path, code);
  if (!code) folder.free_bytes = space.available;
  return folder;
}

std::uint64_t available_memory_bytes() {
  std::ifstream stream("/proc/meminfo");
  std::string name, unit;
  for (std::uint64_t size_kib = 0; stream >> name >> size_kib; std::getline(stream, unit)) {
    if (name == "MemAvailable:") return size_kib * 1024;
  }
  return 0;
}

std::vector<Camera> cameras() {
  std::vector<Camera> found;
  for (const std::string& device : numbered("/dev", "video")) {
    const fs::path driver = fs::path("/sys/class/video4linux") / fs::path(device).filename();
    found.push_back(
        {device, first_line(driver / "name"), access(device.c_str(), R_OK | W_OK) == 0});
  }
  return found;
}

std::vector<std::string> opencl_drivers() {
  std::vector<std::string> drivers;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator("/etc/OpenCL/vendors", code)) {
    if (entry.path().extension() == ".icd") drivers.push_back(first_line(entry.path()));
  }
  std::sort(drivers.begin(), drivers.end());
  return drivers;
}

std::vector<std::string> nvidia_devices() { return numbered("/dev", "nvidia"); }

}  // namespace weft::cli
