// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace weft {

/// Extensions of image files that are searched for in a folder, in order of priority.
inline const std::vector<std::string>& image_extensions() {
  static const std::vector<std::string> kExtensions{".png", ".jpg",  ".jpeg", ".bmp",
                                                    ".tif", ".tiff", ".webp"};
  return kExtensions;
}

}  // namespace weft
