// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft::films {

/// The EXIF orientation that corresponds to the display matrix of an MP4 or QuickTime file. It is 1
/// without a matrix and in other containers, and 0 where the matrix is none of the eight. OpenCV
/// reports an angle instead, which has the wrong sign in some versions and does not distinguish
/// mirrored frames.
int orientation_of_film(const std::string& path);

}  // namespace weft::films
