// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft::films {

/// The EXIF orientation that the display matrix of an MP4 or QuickTime file stands for: 1 without
/// one and in other containers, 0 where it is none of the eight. OpenCV reports an angle instead,
/// which has the wrong sign in some versions and does not tell mirrored frames.
int orientation_of_film(const std::string& path);

}  // namespace weft::films
