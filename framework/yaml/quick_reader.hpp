// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "yaml/yaml.hpp"

namespace weft::yaml::detail {

/// Reads the part of YAML in which manifests are written, in a tenth of the time of yaml-cpp. This
/// part has maps in block style and lists of them. Values are texts in double quotes, plain words,
/// and lists of both in one line. The result is empty for any other text, which need not be wrong:
/// only yaml-cpp refuses. `text` has no character that Text::check() refuses.
std::optional<Node> read_quickly(std::string_view text);

}  // namespace weft::yaml::detail
