// SPDX-License-Identifier: Apache-2.0
#include "region_files.hpp"

#include "files_by_stem.hpp"

namespace weft::images {

void RegionFiles::declare(Params& p) {
  p.input_path("region", pattern_,
               "masks of the frames, one channel, 0 where the object cannot be visible, with the "
               "stems of the frames");
}

Result<void> RegionFiles::open(const std::vector<std::string>& stems) {
  auto files = files_by_stem("region", pattern_, stems);
  if (!files) return files.error();
  path_of_ = *std::move(files);
  if (path_of_.empty()) return {};
  for (const std::string& stem : stems) {
    if (path_of_.count(stem) > 0) continue;
    return Error{Errc::not_found, "the frame '" + stem +
                                      "' has no mask: 'region' has no file of its stem; add one, "
                                      "white where all may be used, or narrow 'path'"};
  }
  return {};
}

Result<std::optional<Region>> RegionFiles::read(const std::string& stem,
                                                const cameras::CalibratedCamera& camera) const {
  const auto found = path_of_.find(stem);
  if (found == path_of_.end()) return std::optional<Region>();
  const auto stored = cameras::read_image_beside(found->second, camera);
  if (!stored) return stored.error();
  if (stored->channels() != 1) {
    return Error{Errc::unsupported,
                 found->second + ": a mask has one channel, this image has " +
                     std::to_string(stored->channels()) +
                     ": save it in grey levels, 0 where the object cannot be seen"};
  }
  auto mask = camera.undistorted_mask(*stored, found->second);
  if (!mask) return mask.error();
  return std::optional<Region>(Region{*std::move(mask)});
}

}  // namespace weft::images
