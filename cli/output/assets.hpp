// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft::cli {

/// The path of a file or folder that comes with the program, in the build tree and in an
/// installation: "report", "pipelines/live.yaml".
std::string asset(const std::string& name);

}  // namespace weft::cli
