// SPDX-License-Identifier: Apache-2.0
#include "common/frame_files.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <weft/core/file_order.hpp>

namespace weft::sources {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPart = ".part";

bool has_wildcard(const std::string& text) { return text.find_first_of("*?[") != text.npos; }

bool is_there(const fs::path& path) {
  std::error_code code;
  return fs::exists(fs::symlink_status(path, code));
}

bool is_folder(const fs::path& path) {
  std::error_code code;
  return fs::is_directory(path, code);
}

bool is_unfinished(const std::string& name) {
  constexpr std::size_t kDigits = 12;
  if (name.size() <= kDigits + kPart.size() + 1 || !name.ends_with(kPart)) return false;
  const std::string_view rest = std::string_view(name).substr(0, name.size() - kPart.size());
  const std::string_view digits = rest.substr(rest.size() - kDigits);
  return rest[rest.size() - kDigits - 1] == '.' &&
         digits.find_first_not_of("0123456789abcdef") == digits.npos;
}

/// Adds what below `base` matches the parts of the path that remain. Fails on a folder that cannot
/// be listed.
Result<void> expand(const fs::path& base, fs::path::iterator part, fs::path::iterator end,
                    std::vector<std::string>& found) {
  if (part == end) {
    if (is_there(base)) found.push_back(base.string());
    return {};
  }
  const std::string name = part->string();
  if (!has_wildcard(name) || is_there(base / name)) {
    return expand(base / name, std::next(part), end, found);
  }
  if (!is_folder(base)) return {};
  std::error_code code;
  for (fs::directory_iterator entry(base, code), last; !code && entry != last;
       entry.increment(code)) {
    if (!matches_name(name, entry->path().filename().string())) continue;
    if (auto done = expand(entry->path(), std::next(part), end, found); !done) return done;
  }
  if (!code) return {};
  return Error{Errc::io, base.string() + ": the folder cannot be listed: " + code.message()};
}

/// Why nothing matches, and what to change.
std::string explanation(const fs::path& pattern) {
  if (std::string hint = numbering_hint(pattern); !hint.empty()) return hint;
  if (is_folder(pattern)) return "it is a folder: name its files, for example with /*.png";
  fs::path folder;
  for (const fs::path& part : pattern.parent_path()) {
    if (has_wildcard(part.string())) break;
    folder /= part;
    if (!is_there(folder)) return "the folder " + folder.string() + " does not exist";
  }
  return "there are folders but no such file: check the pattern and its letters' case";
}

}  // namespace

bool matches_name(const std::string& pattern, const std::string& name) {
  if (fnmatch(pattern.c_str(), name.c_str(), FNM_PERIOD) != 0) return false;
  return pattern.ends_with(kPart) || !is_unfinished(name);
}

Result<std::vector<std::string>> matching_files(const std::string& pattern) {
  const fs::path path(pattern);
  std::vector<std::string> found;
  if (auto listed = expand({}, path.begin(), path.end(), found); !listed) return listed.error();
  if (found.empty() || (!has_wildcard(pattern) && is_folder(path))) {
    return Error{Errc::not_found, "no file matches '" + pattern + "': " + explanation(path)};
  }
  std::sort(found.begin(), found.end(), natural_less);
  return found;
}

std::string stem_of(const std::string& path) { return fs::path(path).stem().string(); }

}  // namespace weft::sources
