// SPDX-License-Identifier: Apache-2.0
#include "samples/scenery.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/images/image_names.hpp>

#include "common/images/picture_file.hpp"

namespace weft::frex {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kTables = 24;  // every third is plain

std::string lower_case(std::string text) {
  for (char& letter : text) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return text;
}

Result<std::vector<fs::path>> images_in(const std::string& folder) {
  std::error_code status;
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder, status)) {
    const auto& known = image_extensions();
    if (std::find(known.begin(), known.end(), lower_case(entry.path().extension().string())) !=
        known.end()) {
      paths.push_back(entry.path());
    }
  }
  if (status) {
    return Error{Errc::io,
                 "the folder cannot be read (" + status.message() +
                     "): correct 'backgrounds', or leave it out",
                 folder};
  }
  if (paths.empty()) {
    return Error{Errc::invalid_value,
                 "the folder holds no image: put photographs of the surroundings there, or leave "
                 "'backgrounds' out",
                 folder};
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

Result<Scenery> Scenery::create(const Camera& camera, const std::string& folder,
                                std::uint64_t seed) {
  Scenery scenery;
  for (std::uint64_t k = 0; k < kTables; ++k) {
    const std::uint64_t own = kTables * seed + k;
    scenery.pictures_.push_back(k % 3 == 0 ? plain_backdrop(camera, own)
                                           : cluttered_backdrop(camera, own));
  }
  if (folder.empty()) return scenery;
  const auto paths = images_in(folder);
  if (!paths) return paths.error();
  for (const fs::path& path : *paths) {
    const auto picture = image_files::read_picture("backgrounds", path.string());
    if (!picture) return picture.error();
    scenery.pictures_.push_back(picture_backdrop(camera, scene::MipTexture(*picture)));
  }
  return scenery;
}

Picture Scenery::draw(Rng& rng) const {
  const Picture& chosen = pictures_[rng.below(static_cast<std::uint32_t>(pictures_.size()))];
  const bool mirror_x = rng.below(2) != 0, mirror_y = rng.below(2) != 0;
  const double gain = rng.uniform(0.4, 1.5);
  scene::Colour tint = scene::Colour::Zero();
  for (int k = 0; k < 3; ++k) tint[k] = static_cast<float>(gain * rng.uniform(0.8, 1.2));
  Picture drawn{chosen.width, chosen.height};
  drawn.pixels.reserve(chosen.pixels.size());
  for (int y = 0; y < chosen.height; ++y) {
    ask_to_go_on();
    for (int x = 0; x < chosen.width; ++x) {
      drawn.pixels.push_back(tint * chosen.at(mirror_x ? chosen.width - 1 - x : x,
                                              mirror_y ? chosen.height - 1 - y : y));
    }
  }
  return drawn;
}

}  // namespace weft::frex
