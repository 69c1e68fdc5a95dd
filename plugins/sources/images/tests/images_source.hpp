// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/testing/plugin_under_test.hpp>

#include "common/cameras/tests/frame_folder.hpp"

namespace weft::testing {

/// sources/images on the files `pattern` of the folder; `more` is further YAML, after a comma.
inline PluginUnderTest images_source(const FrameFolder& folder,
                                     const std::string& pattern = "frames/*.png",
                                     const std::string& more = "") {
  return PluginUnderTest("sources/images", "{path: '" + folder.path(pattern) + "', camera: '" +
                                               folder.path("camera.yaml") + "'" +
                                               (more.empty() ? "" : ", " + more) + "}");
}

}  // namespace weft::testing
