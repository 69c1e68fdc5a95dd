// SPDX-License-Identifier: Apache-2.0
#include "cli/track/frame_files.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <vector>
#include <weft/core/file_order.hpp>
#include <weft/core/text_file.hpp>
#include <weft/images/image_file.hpp>
#include <weft/images/image_names.hpp>

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

bool is_image_name(const fs::path& path) {
  const std::vector<std::string>& extensions = image_extensions();
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end() &&
         !path.filename().string().starts_with('.');
}

/// The images of a folder by their extension, in natural order.
std::map<std::string, std::vector<fs::path>> images_in(const fs::path& folder,
                                                       const std::string& object) {
  std::map<std::string, std::vector<fs::path>> images;
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    const fs::path& path = entry.path();
    if (is_image_name(path) && !fs::equivalent(path, object, code)) {
      images[path.extension().string()].push_back(path);
    }
  }
  for (auto& [extension, paths] : images) {
    std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
      return natural_less(a.string(), b.string());
    });
  }
  return images;
}

/// The last number in a name, and what stands around it.
struct Numbered {
  std::int64_t number;
  std::string around;
};

std::optional<Numbered> numbered(const std::string& stem) {
  const std::size_t last = stem.find_last_of("0123456789");
  if (last == std::string::npos) return std::nullopt;
  std::size_t first = last;
  while (first > 0 && std::isdigit(static_cast<unsigned char>(stem[first - 1])) != 0) --first;
  Numbered found{0, stem.substr(0, first) + "*" + stem.substr(last + 1)};
  const auto read = std::from_chars(stem.data() + first, stem.data() + last + 1, found.number);
  return read.ec == std::errc{} ? std::optional(std::move(found)) : std::nullopt;
}

/// True if names differ only in one number, and at least half of its steps are equal.
bool are_numbered(const std::vector<fs::path>& paths) {
  std::map<std::int64_t, std::size_t> steps;
  std::optional<Numbered> before;
  std::size_t most = 0;
  for (const fs::path& path : paths) {
    auto now = numbered(path.stem().string());
    if (!now || (before && before->around != now->around)) return false;
    if (before) most = std::max(most, ++steps[now->number - before->number]);
    before = std::move(now);
  }
  return 2 * most >= paths.size() - 1;
}

/// A sentence where two images have different sizes; those that cannot be read are left to the run.
std::string differing_sizes(const std::vector<fs::path>& paths) {
  std::optional<ImageHeader> first;
  for (const fs::path& path : paths) {
    const auto file = read_image_bytes(path.string());
    if (!file) continue;
    if (!first) first = file->header;
    if (file->header.upright_width_px() != first->upright_width_px() ||
        file->header.upright_height_px() != first->upright_height_px()) {
      return "they have several sizes";
    }
  }
  return {};
}

Error of_folder(const std::string& folder, const std::string& message) {
  return {Errc::not_found, message, folder};
}

}  // namespace

Result<FrameFiles> find_frames(const std::string& path, const std::string& object) {
  if (auto found = check_input(path, InputKind::any, "give a video, or a folder of images");
      !found) {
    return found.error();
  }
  const fs::path place = fs::absolute(path).lexically_normal();
  std::error_code code;
  if (!fs::is_directory(place, code)) return FrameFiles{true, place.string(), true, {}, false};
  const auto images = images_in(place, object);
  if (images.empty()) {
    return of_folder(path,
                     "holds no images (png, jpg, bmp, tif or webp): give a folder of images, "
                     "or a video");
  }
  if (images.size() > 1) {
    return of_folder(path, "holds images of several types (*" + images.begin()->first + ", *" +
                               std::next(images.begin())->first +
                               "): put those to be tracked into a separate folder");
  }
  const auto& [extension, paths] = *images.begin();
  std::string why = differing_sizes(paths);
  const bool is_sequence = why.empty() && are_numbered(paths);
  if (why.empty()) why = is_sequence ? "their names are numbered" : "their names are not numbered";
  const auto first = read_image_bytes(paths.front().string());
  return FrameFiles{false, (place / ("*" + extension)).string(), is_sequence, std::move(why),
                    first && first->header.focal_35mm_mm > 0};
}

}  // namespace weft::cli
