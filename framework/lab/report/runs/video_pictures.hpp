// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace weft::lab {

struct VideoPictures {
  std::uint64_t count = 0;                      ///< [] in the video
  std::map<std::uint64_t, std::string> wanted;  ///< JPEG files, by their number from 0
};

/// The wanted images of an AVI file with one stream of JPEG images (Motion JPEG). Other files give
/// none. A truncated or damaged file gives the images before that place.
VideoPictures video_pictures(const std::string& file, const std::set<std::uint64_t>& wanted);

}  // namespace weft::lab
