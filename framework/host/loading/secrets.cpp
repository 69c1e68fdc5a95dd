// SPDX-License-Identifier: Apache-2.0
#include "host/loading/secrets.hpp"

#include <algorithm>
#include <cctype>

namespace weft::host {
namespace {

constexpr std::string_view kWords[] = {"token", "password", "passphrase", "secret", "api_key"};
constexpr const char* kShown = "...";

std::string variable_for(std::string_view parameter) {
  std::string name = "${WEFT_" + std::string(parameter) + "}";
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name;
}

/// Begin and length of the password in `scheme://user:password@host`; nothing where there is none.
std::optional<std::pair<std::size_t, std::size_t>> password_in(const std::string& text) {
  const std::size_t scheme = text.find("://");
  if (scheme == text.npos) return std::nullopt;
  const std::size_t begin = scheme + 3;
  const std::size_t end = std::min(text.find_first_of("/ \t\"'", begin), text.size());
  const std::size_t at = text.substr(0, end).rfind('@');
  const std::size_t colon = text.find(':', begin);
  if (at == text.npos || at < begin || colon >= at) return std::nullopt;
  return std::pair(colon + 1, at - colon - 1);
}

/// True if a value of YAML contains a secret parameter, such as {token: x}.
bool gives_secret(std::string_view value) {
  for (std::size_t colon = value.find(':'); colon != value.npos;
       colon = value.find(':', colon + 1)) {
    std::size_t end = colon;
    while (end > 0 && (value[end - 1] == ' ' || value[end - 1] == '"' || value[end - 1] == '\'')) {
      --end;
    }
    std::size_t begin = end;
    while (begin > 0 && (std::isalnum(static_cast<unsigned char>(value[begin - 1])) != 0 ||
                         value[begin - 1] == '_')) {
      --begin;
    }
    if (is_secret(value.substr(begin, end - begin))) return true;
  }
  return false;
}

}  // namespace

bool is_secret(std::string_view parameter) {
  return std::any_of(std::begin(kWords), std::end(kWords), [&](std::string_view word) {
    return parameter == word ||
           (parameter.ends_with(word) && parameter[parameter.size() - word.size() - 1] == '_');
  });
}

std::optional<std::string> hidden_text(std::string_view parameter, const std::string& written,
                                       const std::string& value) {
  const auto password = password_in(value);
  const bool secret = is_secret(parameter);
  if (value.empty() || (!secret && !password)) return std::nullopt;
  if (written.find("${") != written.npos) return written;
  if (secret) return variable_for(parameter);
  std::string hidden = value;
  return hidden.replace(password->first, password->second, variable_for("password"));
}

yaml::Node without_secrets(const ComponentSpec& spec) {
  yaml::Node shown = spec.effective;
  for (yaml::Entry& entry : shown.entries) {
    if (entry.key != "params") continue;
    for (yaml::Entry& parameter : entry.value.entries) {
      const auto hidden = spec.hidden.find(parameter.key);
      if (hidden != spec.hidden.end()) {
        parameter.value = yaml::text_node(hidden->second, parameter.value.at);
      }
      for (const NestedSpec& nested : spec.nested) {
        if (nested.parameter == parameter.key && nested.component.installed != nullptr) {
          parameter.value = without_secrets(nested.component);
        }
      }
    }
  }
  return shown;
}

std::string shown_setting(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == setting.npos) return setting;
  const std::string path = setting.substr(0, equals);
  const std::string value = setting.substr(equals + 1);
  const std::string name = path.substr(path.rfind('.') + 1);  // the whole where there is no dot
  if (is_secret(name) || gives_secret(value)) return path + "=" + kShown;
  if (const auto hidden = hidden_text(name, value, value); hidden && *hidden != value) {
    return path + "=" + *hidden;
  }
  return setting;
}

}  // namespace weft::host
