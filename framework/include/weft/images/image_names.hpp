// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace weft {

/// Extensions of the image files that are looked for in a folder, the first ones first.
inline const std::vector<std::string>& image_extensions() {
  static const std::vector<std::string> kExtensions{".png", ".jpg",  ".jpeg", ".bmp",
                                                    ".tif", ".tiff", ".webp"};
  return kExtensions;
}

}  // namespace weft
