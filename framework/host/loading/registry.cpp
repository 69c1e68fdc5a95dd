// SPDX-License-Identifier: Apache-2.0
#include "host/loading/registry.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <weft/core/component_id.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/shell_word.hpp>
#include <weft/core/suggest.hpp>

#include "host/describe/build_id.hpp"
#include "host/loading/former_names.hpp"
#include "host/loading/processor.hpp"
#include "host/loading/sanitizer.hpp"
#include "host/roles/role_rules.hpp"

namespace weft::host {
namespace {

namespace fs = std::filesystem;

/// An error text about the features that a library assumes but that are
/// missing, or an empty text. A feature that only a later Weft can name counts
/// as missing.
std::string missing_features(const std::vector<std::string>& isa) {
  std::string missing, unknown;
  for (const std::string& feature : isa) {
    if (processor_has(feature)) continue;
    std::string& list = is_processor_feature(feature) ? missing : unknown;
    list += (list.empty() ? "" : " ") + feature;
  }
  if (!missing.empty()) return "it needs processor features that this machine lacks: " + missing;
  if (unknown.empty()) return {};
  return "it needs processor features that this version of Weft does not "
         "know: " +
         unknown;
}

std::vector<std::string> ids_of(const Manifest& manifest) {
  std::vector<std::string> ids;
  for (const ComponentManifest& component : manifest.components) ids.push_back(component.id);
  return ids;
}

/// The error of the ids of a library, or empty.
std::string illegal_id(const Manifest& manifest) {
  std::vector<std::string> seen;
  for (const ComponentManifest& component : manifest.components) {
    const std::string& id = component.id;
    if (!is_component_id(id)) {
      return "'" + id + "' is not of the form role/name or role/vendor.name";
    }
    if (std::find(seen.begin(), seen.end(), id) != seen.end()) return "'" + id + "' is in it twice";
    seen.push_back(id);
  }
  return {};
}

/// A record type for which the component supports only other versions, in
/// words, or empty. A type with another name belongs to an optional slot, which
/// is never delivered here.
std::string other_version(const ComponentManifest& component) {
  const auto name_of = [](std::string_view type) { return type.substr(0, type.find('/')); };
  for (const RoleMethod& method : component.rules().role.methods) {
    for (const auto* slots : {&method.inputs, &method.outputs}) {
      for (const RoleSlot& slot : *slots) {
        std::string others;
        bool is_known = false;
        for (const std::string& type : component.records) {
          is_known = is_known || type == slot.type;
          if (name_of(type) == name_of(slot.type)) others += (others.empty() ? "" : ", ") + type;
        }
        if (!is_known && !others.empty()) {
          return "'" + component.id + "' knows " + others + ", and this version of Weft " +
                 slot.type;
        }
      }
    }
  }
  return {};
}

/// Why this version of Weft cannot use one component of a library that it can
/// use, or empty.
std::string unknown_part(const ComponentManifest& component) {
  if (!component.unknown.empty()) return component.unknown;
  if (std::string other = other_version(component); !other.empty()) return other;
  if (!rules_of(component.role()).role.name.empty()) return {};
  const std::string near = role_meant(component.id);
  return "'" + component.role() + "' of '" + component.id + "' is no role" +
         (near == component.role() ? "" : " (the nearest is '" + near + "')");
}

Refusal unreadable(const std::string& manifest, const Error& error) {
  const std::string library = manifest.substr(0, manifest.rfind(".plugin.yaml")) + ".so";
  return {library,
          "its manifest cannot be read: " + error.message + " (" + error.where + ")",
          "run: weft plugins describe " + shell_word(library),
          {}};
}

Refusal without_manifest(const std::string& library) {
  if (std::error_code code; !fs::exists(library, code) && code) {  // such as a loop of links
    return {library, "it cannot be read: " + code.message(), "remove it, or install it again", {}};
  }
  // It could not be described, and so has none.
  if (const auto missing = missing_sanitizer(library)) {
    return {library, "it " + missing->cause, missing->fix, {}};
  }
  return {library,
          "it has no manifest beside it",
          "run: weft plugins describe " + shell_word(library),
          {}};
}

/// Nothing when the library beside the manifest can be used.
std::optional<Refusal> check(const Manifest& manifest) {
  const auto refuse = [&](std::string cause, std::string fix) {
    return Refusal{manifest.library, std::move(cause), std::move(fix), ids_of(manifest)};
  };
  std::error_code code;
  if (!fs::exists(manifest.library, code)) {
    return refuse(code ? "the library cannot be read: " + code.message()
                       : "the library is missing, only its manifest is there",
                  "build or install the plugin again, or remove " + manifest.file);
  }
  if (const std::string mismatch = abi_mismatch(manifest.abi_major, manifest.needs_minor);
      !mismatch.empty()) {
    return refuse("it " + mismatch, "rebuild the plugin against this version of Weft");
  }
  const auto file = ElfFile::open(manifest.library);
  const auto whole = file ? check_dynamic_tables(*file) : file.error();
  if (!whole) return refuse("it " + whole.error().message, "build or install the plugin again");
  if (const auto missing = missing_sanitizer(*file)) {
    return refuse("it " + missing->cause, missing->fix);
  }
  const std::string build_id = build_id_of(*file);
  if (build_id.empty()) {
    return refuse("it has no build-id",
                  "link it with -Wl,--build-id=sha1, as weft_add_plugin() does");
  }
  if (build_id != manifest.build_id) {
    return refuse("its manifest belongs to another build of it",
                  "run: weft plugins describe " + shell_word(manifest.library));
  }
  if (const std::string missing = missing_features(manifest.isa); !missing.empty()) {
    return refuse(missing, "rebuild the plugin without the flags that require them");
  }
  if (const std::string illegal = illegal_id(manifest); !illegal.empty()) {
    return refuse(illegal, "correct the id in the plugin's source and rebuild it");
  }
  return std::nullopt;
}

}  // namespace

std::vector<SearchFolder> search_path(const std::vector<std::string>& given) {
  std::vector<SearchFolder> folders;
  for (const std::string& path : given) folders.push_back({path, "--plugin-path"});
  if (const char* variable = std::getenv("WEFT_PLUGIN_PATH")) {
    std::istringstream stream{std::string(variable)};
    for (std::string path; std::getline(stream, path, ':');) {
      if (!path.empty()) folders.push_back({path, "WEFT_PLUGIN_PATH"});
    }
  }
  std::error_code code;
  const fs::path program = fs::read_symlink("/proc/self/exe", code);
  if (!code) {
    const fs::path beside = program.parent_path().parent_path() / "lib/weft/plugins";
    if (fs::is_directory(beside, code)) folders.push_back({beside.string(), kOwnOrigin});
  }
  return folders;
}

Registry Registry::scan(const std::vector<SearchFolder>& folders) {
  Registry registry;
  std::error_code code;
  for (const SearchFolder& folder : folders) {
    if (folder.origin != kOwnOrigin) continue;
    registry.own_folder_ = fs::weakly_canonical(folder.path, code).string();
  }
  for (const SearchFolder& folder : folders) {
    const fs::path canonical = fs::weakly_canonical(folder.path, code);
    const bool known =
        std::any_of(registry.folders_.begin(), registry.folders_.end(),
                    [&](const SearchFolder& other) { return fs::path(other.path) == canonical; });
    if (known) continue;
    registry.folders_.push_back({canonical.string(), folder.origin});
    registry.scan_folder(registry.folders_.back());
  }
  return registry;
}

void Registry::scan_folder(const SearchFolder& folder) {
  std::error_code code;
  std::vector<std::string> manifests, libraries;
  for (const auto& entry : fs::directory_iterator(folder.path, code)) {
    const std::string file = entry.path().string();
    if (file.ends_with(".plugin.yaml")) manifests.push_back(file);
    if (file.ends_with(".so")) libraries.push_back(file);
  }
  if (code) {
    refusals_.push_back({folder.path,
                         "the folder cannot be read: " + code.message(),
                         "correct " + folder.origin,
                         {}});
    return;
  }
  std::sort(manifests.begin(), manifests.end());
  std::sort(libraries.begin(), libraries.end());
  for (const std::string& library : libraries) {
    const std::string manifest = library.substr(0, library.size() - 3) + ".plugin.yaml";
    if (std::binary_search(manifests.begin(), manifests.end(), manifest)) continue;
    refusals_.push_back(without_manifest(library));
  }
  std::vector<Manifest> usable;
  for (const std::string& file : manifests) {
    auto manifest = read_manifest(file);
    if (!manifest) {
      refusals_.push_back(unreadable(file, manifest.error()));
    } else if (auto refusal = check(*manifest)) {
      refusals_.push_back(*std::move(refusal));
    } else {
      usable.push_back(*std::move(manifest));
    }
  }
  add(folder, std::move(usable));
}

void Registry::add(const SearchFolder& folder, std::vector<Manifest> manifests) {
  std::set<std::string, std::less<>> known;
  for (const Installed& entry : installed_) known.insert(entry.component.id);
  std::map<std::string, std::vector<std::string>> libraries_of;
  for (const Manifest& manifest : manifests) {
    for (const std::string& id : ids_of(manifest)) libraries_of[id].push_back(manifest.library);
  }
  for (Manifest& manifest : manifests) {
    const auto library = std::make_shared<const Manifest>(std::move(manifest));
    for (const ComponentManifest& component : library->components) {
      const std::vector<std::string>& owners = libraries_of[component.id];
      if (const std::string unknown = unknown_part(component); !unknown.empty()) {
        refusals_.push_back({library->library,
                             unknown,
                             "correct it in the plugin's source, or install a newer Weft",
                             {component.id}});
        continue;
      }
      if (owners.size() > 1) {
        const std::string& other = owners[0] == library->library ? owners[1] : owners[0];
        refusals_.push_back({library->library,
                             "'" + component.id + "' is also in " + other,
                             "keep one of the two in this folder",
                             {component.id}});
        continue;
      }
      const bool shadowed =
          known.contains(component.id) || known.contains(current_id(component.id));
      known.insert(component.id);
      installed_.push_back(
          {component, library, folder.origin, shadowed, folder.path == own_folder_});
    }
  }
}

const Installed* Registry::find(std::string_view id) const {
  for (const Installed& entry : installed_) {
    if (!entry.shadowed && entry.component.id == id) return &entry;
  }
  const std::string_view current = current_id(id);
  return current != id ? find(current) : nullptr;
}

std::string Registry::nearest_of_role(std::string_view id, const std::string& role) const {
  const std::string_view given = id.substr(0, id.find('/'));
  const std::string same = role + std::string(id.substr(given.size()));
  bool another = false;  // a role that is no misspelling of this one
  std::vector<std::string> ids, names;
  for (const Installed& entry : installed_) {
    another = another || (entry.component.role() == given && given != role);
    if (entry.component.role() != role) continue;
    ids.push_back(entry.component.id);
    names.push_back(entry.component.id.substr(role.size() + 1));
  }
  if (another) return std::find(ids.begin(), ids.end(), same) != ids.end() ? same : "";
  std::string near = nearest(id, ids);
  if (!near.empty()) return near;
  near = nearest(id.substr(id.find('/') + 1), names);  // npos + 1 is 0
  return near.empty() ? near : role + "/" + near;
}

std::string Registry::explain_missing(std::string_view id) const {
  // A library bears its first id, so a file without a readable manifest is
  // known by its name.
  std::string stem(id);
  std::replace(stem.begin(), stem.end(), '/', '_');
  for (const Refusal& refusal : refusals_) {
    const std::string name = fs::path(refusal.file).filename().string();
    const bool named = refusal.ids.empty() && name.substr(0, name.rfind(".so")) == stem;
    if (named || std::find(refusal.ids.begin(), refusal.ids.end(), id) != refusal.ids.end()) {
      return "plugin " + quote(id) + " cannot be used: " + refusal.cause + " (" + refusal.file +
             "); " + refusal.fix;
    }
  }
  const std::string role = role_of(id);
  const bool has_role =
      std::any_of(installed_.begin(), installed_.end(),
                  [&](const Installed& entry) { return entry.component.role() == role; });
  std::vector<std::string> ids;
  std::set<std::string> others;  // ids with this role, or the roles
  for (const Installed& entry : installed_) {
    ids.push_back(entry.component.id);
    if (!has_role) others.insert(entry.component.role());
    if (entry.component.role() == role) others.insert(entry.component.id);
  }
  std::string list;
  for (const std::string& other : others) list += (list.empty() ? "" : ", ") + other;
  if (list.empty()) list = "none";
  return "no plugin " + quote(id) + " is installed" +
         did_you_mean(id, ids,
                      (has_role ? "; there are: " : "; an id begins with one of these roles: ") +
                          list + "; give the folder of a custom plugin by --plugin-path");
}

}  // namespace weft::host
