// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <algorithm>
#include <boost/dll/shared_library.hpp>

#include "describe/build_id.hpp"
#include "host/loading/registry.hpp"

namespace weft::host {
namespace {

Error incompatible(const std::string& file, const std::string& message) {
  return {Errc::incompatible, message, file};
}

Result<void> check_table(const weft_library_table& table, const std::string& file) {
  if (table.magic != WEFT_ABI_MAGIC) {
    return incompatible(file,
                        "its symbol 'weft_library' is no Weft library table; rebuild it with "
                        "weft_add_plugin()");
  }
  if (const std::string mismatch = abi_mismatch(table.abi_major, table.needs_minor);
      !mismatch.empty()) {
    return incompatible(file, mismatch + "; rebuild the plugin against this version of Weft");
  }
  const auto damaged = [](const weft_component* component) {
    return component == nullptr || component->struct_size < sizeof(weft_component) ||
           component->id == nullptr || component->describe == nullptr ||
           component->create == nullptr || component->prepare == nullptr ||
           component->process == nullptr || component->destroy == nullptr;
  };
  // What a later minor version has made of the reserved fields can be ignored, or it would say so.
  const bool reserved_used = table.sdk_minor <= WEFT_ABI_MINOR &&
                             std::any_of(std::begin(table.reserved), std::end(table.reserved),
                                         [](std::uint64_t field) { return field != 0; });
  if (table.struct_size < sizeof(weft_library_table) || reserved_used || table.count == 0 ||
      table.components == nullptr ||
      std::any_of(table.components, table.components + table.count, damaged)) {
    return incompatible(file, "has a damaged library table; rebuild the plugin");
  }
  return {};
}

/// Of flags, those that a host must not ignore.
constexpr std::uint32_t kMustBeKnown = 0xFFFF0000U;

}  // namespace

std::string abi_version() {
  return std::to_string(WEFT_ABI_MAJOR) + "." + std::to_string(WEFT_ABI_MINOR);
}

std::string abi_mismatch(int major, int needs_minor) {
  if (major != WEFT_ABI_MAJOR) {
    return "has plugin ABI " + std::to_string(major) + ", this host has " + abi_version();
  }
  if (needs_minor <= WEFT_ABI_MINOR) return {};
  return "needs plugin ABI " + std::to_string(major) + "." + std::to_string(needs_minor) +
         ", this host has " + abi_version();
}

Result<const weft_library_table*> load_library(const std::string& file) {
  if (auto whole = check_library_file(file); !whole) {
    return incompatible(file, "cannot be loaded: it " + whole.error().message +
                                  "; build or install the plugin again");
  }
  using boost::dll::load_mode::rtld_local;
  using boost::dll::load_mode::rtld_now;
  // Never unloaded: code and type information of a plugin may be in use until the process ends.
  const auto mode = static_cast<boost::dll::load_mode::type>(rtld_now | rtld_local | RTLD_NODELETE);
  boost::dll::fs::error_code code;
  const boost::dll::shared_library library(boost::dll::fs::path(file), mode, code);
  if (code) {
    const char* reason = dlerror();
    return incompatible(file, std::string("cannot be loaded: ") +
                                  (reason != nullptr ? reason : code.message().c_str()) +
                                  "; install the library it needs, or rebuild the plugin");
  }
  if (!library.has("weft_library")) {
    return incompatible(file,
                        "exports no symbol 'weft_library'; end a source file with "
                        "WEFT_PLUGIN(...) and build it with weft_add_plugin()");
  }
  const auto& table = library.get<const weft_library_table>("weft_library");
  if (auto valid = check_table(table, file); !valid) return valid.error();
  return &table;
}

Result<const weft_component*> load(const Installed& installed) {
  const std::string& file = installed.library->library;
  const auto table = load_library(file);
  if (!table) return table.error();
  for (std::uint32_t i = 0; i < (*table)->count; ++i) {
    const weft_component* component = (*table)->components[i];
    if (component->id != installed.component.id) continue;
    if ((((*table)->flags | component->flags) & kMustBeKnown) == 0) return component;
    return incompatible(file, "'" + installed.component.id +
                                  "' asks for what this version of Weft cannot do; install a newer "
                                  "one");
  }
  return incompatible(file, "does not contain '" + installed.component.id +
                                "'; rebuild it so that library and manifest belong together");
}

}  // namespace weft::host
