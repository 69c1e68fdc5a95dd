// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "host/loading/component_spec.hpp"

/// Values that must not be written into files, tables of contents of files, or messages.
namespace weft::host {

/// True if a parameter is secret by its name: `token`, `password`, `passphrase`, `secret`,
/// `api_key`, or a name that ends with an underscore and one of these, such as `camera_password`.
bool is_secret(std::string_view parameter);

/// The text that files contain instead of a secret. It is the written text if that names an
/// environment variable, else a variable to set, `${WEFT_TOKEN}` for `token`. Also hides the
/// password of an address such as rtsp://user:password@camera. Empty if the value is no secret.
std::optional<std::string> hidden_text(std::string_view parameter, const std::string& written,
                                       const std::string& value);

/// The effective configuration of a component as files have it.
yaml::Node without_secrets(const ComponentSpec& spec);

/// `live.token=...` of the setting `live.token=0123456789abcdef`; other settings as they are.
std::string shown_setting(const std::string& setting);

}  // namespace weft::host
