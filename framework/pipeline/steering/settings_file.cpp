// SPDX-License-Identifier: Apache-2.0
#include "pipeline/steering/settings_file.hpp"

#include <cerrno>
#include <filesystem>
#include <weft/core/whole_file.hpp>

namespace weft {
namespace {

namespace fs = std::filesystem;

Error not_saved(const std::string& folder, const std::string& why) {
  return {Errc::io,
          "nothing was saved in '" + folder + "': " + why + "; save in the browser instead",
          folder};
}

/// Creates an empty file. False where there is one already, or it cannot be created; see errno.
bool reserve(const fs::path& file) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  const int descriptor = ::open(file.c_str(), kFlags, 0666);
  if (descriptor >= 0) ::close(descriptor);
  return descriptor >= 0;
}

}  // namespace

Result<std::uint64_t> save_settings(const std::string& folder, const std::string& text) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return not_saved(folder, "it is no folder any more");
  for (std::uint64_t number = 1;; ++number) {
    const fs::path file = fs::path(folder) / ("settings-" + std::to_string(number) + ".yaml");
    if (!reserve(file)) {
      if (errno == EEXIST) continue;
      return not_saved(folder, why_not_written(last_system_error()));
    }
    UnfinishedFile unfinished(file);
    unfinished.write(text);
    if (const std::error_code code = unfinished.finish(Durability::synced)) {
      ::unlink(file.c_str());
      return not_saved(folder, why_not_written(code));
    }
    return number;
  }
}

}  // namespace weft
