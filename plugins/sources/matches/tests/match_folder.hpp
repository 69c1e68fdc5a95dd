// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/testing/plugin_under_test.hpp>

#include "common/cameras/tests/frame_folder.hpp"
#include "common/tests/npz_archive.hpp"

namespace weft::testing {

/// sources/matches on files of the folder; `more` is further YAML, after a comma.
inline PluginUnderTest matches_source(const FrameFolder& folder, const std::string& pattern,
                                      const std::string& more = "") {
  return PluginUnderTest("sources/matches", "{path: '" + folder.path(pattern) + "', camera: '" +
                                                folder.path("camera.yaml") + "'" +
                                                (more.empty() ? "" : ", " + more) + "}");
}

}  // namespace weft::testing
