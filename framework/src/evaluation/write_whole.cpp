// SPDX-License-Identifier: Apache-2.0
#include "write_whole.hpp"

#include <filesystem>
#include <fstream>

namespace weft::evaluation {

Result<void> write_whole(const std::string& text, const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code code;
  const bool replaceable = !fs::exists(file, code) || fs::is_regular_file(file, code);
  const std::string target = replaceable ? file + ".part" : file;
  std::ofstream stream(target, std::ios::binary | std::ios::trunc);
  stream << text;
  stream.close();
  if (stream && replaceable) fs::rename(target, file, code);
  if (!stream || (replaceable && code)) {
    return Error{Errc::io, "cannot be written; is the folder writable and the disk not full?",
                 file};
  }
  return {};
}

}  // namespace weft::evaluation
