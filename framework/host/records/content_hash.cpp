// SPDX-License-Identifier: Apache-2.0
#include "host/records/content_hash.hpp"

#include <glob.h>
#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <weft/core/index.hpp>

namespace weft::host {
namespace {

namespace fs = std::filesystem;

std::string hexadecimal(XXH128_hash_t hash) {
  XXH128_canonical_t bytes;
  XXH128_canonicalFromHash(&bytes, hash);
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes.digest) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

class Hasher {
 public:
  Hasher() : state_(XXH3_createState(), XXH3_freeState) { XXH3_128bits_reset(state_.get()); }

  void add(std::string_view bytes) {
    XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
  }
  /// A text that cannot run into what follows.
  void add_text(const std::string& text) { add(std::to_string(text.size()) + ":" + text); }

  std::string digits() const { return hexadecimal(XXH3_128bits_digest(state_.get())); }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

Result<std::string> hash_of_file(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  Hasher hasher;
  std::string block(std::size_t{1} << 20U, '\0');
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) ||
         stream.gcount() > 0) {
    hasher.add({block.data(), to_index(stream.gcount())});
  }
  if (stream.bad() || !stream.eof()) return Error{Errc::io, "cannot be read", file};
  return hasher.digits();
}

std::vector<std::string> matching(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> files;
  if (glob(pattern.c_str(), GLOB_NOSORT | GLOB_NOESCAPE, nullptr, &found) == 0) {
    files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  globfree(&found);
  std::erase_if(files, [](const std::string& file) { return !fs::is_regular_file(file); });
  return files;
}

std::vector<std::string> below(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code code;
  for (const auto& entry : fs::recursive_directory_iterator(folder, code)) {
    if (entry.is_regular_file(code)) files.push_back(entry.path().string());
  }
  return files;
}

}  // namespace

std::string content_hash(std::string_view bytes) {
  return hexadecimal(XXH3_128bits(bytes.data(), bytes.size()));
}

Result<std::vector<std::string>> files_of(const std::string& path) {
  std::error_code code;
  std::vector<std::string> files;
  if (fs::is_regular_file(path, code)) {
    files.push_back(path);
  } else {
    files = fs::is_directory(path, code) ? below(path) : matching(path);
  }
  if (files.empty()) return Error{Errc::not_found, "no file matches '" + path + "'"};
  std::sort(files.begin(), files.end());
  return files;
}

Result<std::string> hash_of_files(const std::string& path) {
  const auto files = files_of(path);
  if (!files) return files.error();
  Hasher hasher;
  for (const std::string& file : *files) {
    const auto content = hash_of_file(file);
    if (!content) return content.error();
    hasher.add_text(fs::path(file).filename().string());
    hasher.add(*content);
  }
  return hasher.digits();
}

}  // namespace weft::host
