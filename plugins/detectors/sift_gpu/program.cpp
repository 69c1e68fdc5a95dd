// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <xxhash.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <weft/core/whole_file.hpp>

#include "kernel_sizes.hpp"

namespace weft::sift_gpu {
namespace {

namespace fs = std::filesystem;

const std::string& options() {
  static const std::string text = "-cl-std=CL1.2 -DGROUP=" + std::to_string(kGroup) +
                                  " -DLENGTH=" + std::to_string(kDescriptorLength) +
                                  " -DTILE=" + std::to_string(kTileSide) +
                                  " -DBLOCK=" + std::to_string(kTileBlock);
  return text;
}

/// Where the program of this device stands; empty where there is no folder for caches.
fs::path cache_file(const cl::Device& device) {
  fs::path folder;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/') {
    folder = cache;
  } else if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
    folder = fs::path(home) / ".cache";
  } else {
    return {};
  }
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  const std::string identity = std::string(kKernels) + options() + description(device) +
                               device.getInfo<CL_DEVICE_VERSION>() +
                               platform.getInfo<CL_PLATFORM_VERSION>();
  const XXH64_hash_t hash = XXH3_64bits(identity.data(), identity.size());
  return folder / "weft" / "opencl" / (std::to_string(hash) + ".bin");
}

XXH64_hash_t hash_of(const std::vector<unsigned char>& binary) {
  return XXH3_64bits(binary.data(), binary.size());
}

/// Writes beside the final path and renames, so that no process reads half of it. A hash precedes
/// the binary, because some drivers end the process over a damaged one. A cache that cannot be
/// written only costs the next start its time.
void store(const fs::path& file, const std::vector<unsigned char>& binary) {
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  UnfinishedFile unfinished(file);
  const XXH64_hash_t hash = hash_of(binary);
  unfinished.write({reinterpret_cast<const char*>(&hash), sizeof(hash)});
  unfinished.write({reinterpret_cast<const char*>(binary.data()), binary.size()});
  static_cast<void>(unfinished.finish(Durability::unsynced));
}

cl::Program from_cache(const cl::Context& context, const cl::Device& device, const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  XXH64_hash_t hash = 0;
  if (!in.read(reinterpret_cast<char*>(&hash), sizeof(hash))) return {};
  std::vector<unsigned char> binary{std::istreambuf_iterator<char>(in), {}};
  if (hash != hash_of(binary))
    return {};  // cut short, or not ours: it is compiled and stored again
  try {
    cl::Program program(context, {device}, {std::move(binary)});
    program.build({device});
    return program;
  } catch (const cl::Error&) {
    return {};  // a binary of another driver: likewise
  }
}

}  // namespace

cl::Program compiled(const cl::Context& context, const cl::Device& device) {
  const fs::path file = cache_file(device);
  if (!file.empty()) {
    if (cl::Program cached = from_cache(context, device, file); cached() != nullptr) return cached;
  }
  cl::Program program(context, kKernels);
  program.build({device}, options().c_str());
  const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
  if (!file.empty() && binaries.size() == 1 && !binaries.front().empty()) {
    store(file, binaries.front());
  }
  return program;
}

}  // namespace weft::sift_gpu
