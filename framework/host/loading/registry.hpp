// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/loading/manifest.hpp"

namespace weft::host {

/// A folder that is searched for plugins, and the setting that named it.
struct SearchFolder {
  std::string path;
  std::string origin;  ///< "--plugin-path", "WEFT_PLUGIN_PATH", kOwnOrigin
};

/// The origin of what comes with the program.
inline constexpr const char* kOwnOrigin = "beside the program";

/// The folders given, then those of WEFT_PLUGIN_PATH (separated by colons), then the plugin folder
/// beside the running program.
std::vector<SearchFolder> search_path(const std::vector<std::string>& given);

/// Why a file in the search path cannot be used, and what to do about it.
struct Refusal {
  std::string file, cause, fix;
  std::vector<std::string> ids;  ///< components that it would have brought, where known
};

/// A component that can be used, or that an earlier folder shadows.
struct Installed {
  ComponentManifest component;
  std::shared_ptr<const Manifest> library;
  std::string origin;
  bool shadowed = false;
  bool is_own = false;  ///< it came with the program: its folder is that beside it
};

/// The installed components, read from manifests alone: no library is loaded.
class Registry {
 public:
  /// Reads all manifests of the folders; the first folder that has an id wins.
  static Registry scan(const std::vector<SearchFolder>& folders);

  /// The component of this id, or the one that had it before it was renamed; null when there is
  /// none.
  const Installed* find(std::string_view id) const;
  const std::vector<Installed>& installed() const { return installed_; }
  const std::vector<Refusal>& refusals() const { return refusals_; }
  const std::vector<SearchFolder>& folders() const { return folders_; }

  /// "no plugin 'filters/x'; did you mean ...?", or why the one that has this id is refused.
  std::string explain_missing(std::string_view id) const;

  /// The component of this role that an id was meant for, or nothing: warps/bbs for wajprs/bbs.
  std::string nearest_of_role(std::string_view id, const std::string& role) const;

 private:
  void scan_folder(const SearchFolder& folder);
  void add(const SearchFolder& folder, std::vector<Manifest> manifests);

  std::string own_folder_;  ///< the folder "beside the program", even if another setting named it
                            ///< first; or empty
  std::vector<SearchFolder> folders_;
  std::vector<Installed> installed_;
  std::vector<Refusal> refusals_;
};

/// The version of the binary contract that this host implements: "0.2".
std::string abi_version();

/// Why a library of this major version, which needs this minor one, cannot be used; empty where it
/// can.
std::string abi_mismatch(int major, int needs_minor);

/// Opens the library of an installed component and returns its table. The library stays mapped for
/// the life of the process. Fails with incompatible: missing library, symbol or id, wrong ABI.
Result<const weft_component*> load(const Installed& installed);

/// Opens any library file and returns its table, after the same checks.
Result<const weft_library_table*> load_library(const std::string& file);

}  // namespace weft::host
