// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/scaffold.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>
#include <weft/core/component_id.hpp>
#include <weft/core/name.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>
#include <weft/core/text_file.hpp>

#include "host/roles/role_rules.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostBytes = 10'000'000;

/// "filter" of "filters", "pass" of "passes".
std::string one_of(const std::string& role) {
  return role.substr(0, role.size() - (role.ends_with("sses") ? 2 : 1));
}

Result<std::string> role_named(const std::string& word) {
  std::vector<std::string> known;
  for (const RoleRules& rules : all_role_rules()) {
    known.push_back(one_of(rules.role.name));
    if (word == rules.role.name || word == known.back()) return rules.role.name;
  }
  const std::string all = fmt::format("; there are: {}", fmt::join(known, ", "));
  return Error{Errc::invalid_value, "no role " + quote(word) + did_you_mean(word, known, all)};
}

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }

/// The word with what is not legal in it replaced: "my_filter" for "My-Filter".
std::string made_legal(const std::string& word) {
  std::string legal;
  for (char c : word) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    const bool is_digit = c >= '0' && c <= '9';
    if (legal.empty() && !is_lower(c)) continue;
    legal += is_lower(c) || is_digit ? c : '_';
  }
  return legal;
}

Error illegal_name(const std::string& word, const std::string& what) {
  return {Errc::invalid_value,
          quote(word) + " cannot be the " + what +
              " of a plugin, which begins with a letter and has a to z, 0 to 9 and _ alone" +
              meant(made_legal(word))};
}

/// "MyFilter" of "my_filter".
std::string camel_case(const std::string& name) {
  std::string camel;
  bool begins = true;
  for (const char c : name) {
    if (c != '_') camel += begins && is_lower(c) ? static_cast<char>(c - 'a' + 'A') : c;
    begins = c == '_';
  }
  return camel;
}

using Words = std::vector<std::pair<std::string, std::string>>;

/// The words of the scaffold and their replacements; of two with the same beginning the longer one
/// comes first.
Words words_of(const PluginName& plugin) {
  const std::string library = plugin.role + "_" + plugin.component();
  return {{"roles/my_plugin", plugin.id()},          {"roles_my_plugin", library},
          {plugin.role + "/my_plugin", plugin.id()}, {plugin.role + "_my_plugin", library},
          {"MyPlugin", camel_case(plugin.name)},     {"my_plugin", plugin.name}};
}

std::string replaced(const std::string& text, const Words& words) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const auto word = std::find_if(words.begin(), words.end(), [&](const auto& each) {
      return text.compare(at, each.first.size(), each.first) == 0;
    });
    result += word == words.end() ? text.substr(at, 1) : word->second;
    at += word == words.end() ? 1 : word->first.size();
  }
  return result;
}

/// A language in which plugins can be begun.
struct Language {
  const char* name;
  const char* folder;    ///< folder of its sources, which replace those of the role
  const char* replaces;  ///< extension or ending of the replaced names
};
constexpr Language kLanguages[] = {
    {"c++", "", ""}, {"c", "c", "my_plugin.cpp"}, {"python", "python", ".cpp"}};

/// Adds the files of a folder, without those whose names end in `but`, if it is not empty.
Result<void> add_files(const fs::path& folder, const Words& words, const std::string& but,
                       std::map<std::string, std::string>& files) {
  std::error_code code;
  for (fs::recursive_directory_iterator entry(folder, code), end; entry != end && !code;
       entry.increment(code)) {
    const bool is_left_out = !but.empty() && entry->path().string().ends_with(but);
    if (!entry->is_regular_file(code) || is_left_out) continue;
    auto content = read_text_file(entry->path().string(), kMostBytes);
    if (!content) return content.error();
    const std::string path = entry->path().lexically_relative(folder).generic_string();
    const bool is_picture = entry->path().extension() == ".png";
    files[replaced(path, words)] += is_picture ? *content : replaced(*content, words);
  }
  if (!code) return {};
  return Error{
      Errc::not_found,
      "what new plugins are made of cannot be read: " + code.message() +
          "; it comes with the package weft-dev, or the component dev of `cmake --install`",
      folder.string()};
}

}  // namespace

Result<PluginName> plugin_name(const std::string& role, const std::string& name,
                               const std::string& vendor) {
  const auto known = role_named(role);
  if (!known) return known.error();
  if (!is_part_of_id(name)) return illegal_name(name, "name");
  if (!vendor.empty() && !is_part_of_id(vendor)) return illegal_name(vendor, "vendor");
  PluginName plugin{*known, vendor, name};
  if (plugin.id().size() > Name::kLongest) {
    return Error{Errc::invalid_value, quote(plugin.id()) + " has more than " +
                                          std::to_string(Name::kLongest) +
                                          " characters; take a shorter name"};
  }
  return plugin;
}

std::vector<std::string> scaffold_languages() {
  std::vector<std::string> names;
  for (const Language& language : kLanguages) names.emplace_back(language.name);
  return names;
}

Result<std::map<std::string, std::string>> scaffold_files(const PluginName& plugin,
                                                          const std::string& language,
                                                          const fs::path& scaffold) {
  const auto* chosen = std::find_if(std::begin(kLanguages), std::end(kLanguages),
                                    [&](const Language& each) { return each.name == language; });
  Words words = words_of(plugin);
  if (language == "c") {
    words.insert(words.begin(),
                 {{"LANGUAGES CXX", "LANGUAGES C CXX"},
                  {"SOURCES my_plugin.cpp", "SOURCES " + plugin.name + ".c\n  LINK m"}});
  }
  std::map<std::string, std::string> files;
  const auto add = [&](const fs::path& part, const std::string& but) {
    return add_files(scaffold / part, words, but, files);
  };
  std::error_code code;
  const fs::path own = chosen->folder;
  if (!own.empty() && fs::exists(scaffold / plugin.role, code) &&
      !fs::exists(scaffold / own / plugin.role, code)) {
    const char* in = language == "c" ? "C" : "Python";
    return Error{Errc::unsupported,
                 plugin.role + " in " + in + " cannot be begun yet; begin a filter and change it"};
  }
  auto added = add(plugin.role, chosen->replaces);
  if (added && !own.empty()) added = add(own / plugin.role, "");
  if (added) added = add(language == "python" ? own / "common" : fs::path("common"), "");
  if (!added) return added.error();
  return files;
}

}  // namespace weft::cli
