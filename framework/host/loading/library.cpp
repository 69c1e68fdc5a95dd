// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <boost/dll/shared_library.hpp>
#include <cstddef>
#include <locale>

#include "host/describe/build_id.hpp"
#include "host/guarding/first_sizes.hpp"
#include "host/guarding/library_call.hpp"
#include "host/guarding/loaded_code.hpp"
#include "host/loading/registry.hpp"
#include "host/loading/sanitizer.hpp"

namespace weft::host {
namespace {

Error incompatible(const std::string& file, const std::string& message) {
  return {Errc::incompatible, message, file};
}

/// The error of a component in a table, or null.
const char* damage_of(const weft_component& component) {
  const auto any_null = [](auto... pointers) { return ((pointers == nullptr) || ...); };
  if (component.struct_size < kFirstSize<weft_component>) return "its struct_size is too small";
  if (any_null(component.id, component.version, component.summary, component.reference,
               component.licence, component.determinism, component.needs, component.reads,
               component.produces)) {
    return "one of its texts is null";
  }
  if (any_null(component.describe, component.create, component.prepare, component.process,
               component.destroy)) {
    return "one of its functions is null";
  }
  return nullptr;
}

/// The error of a library's table, or empty.
std::string damage_of(const weft_library_table& table) {
  constexpr std::uint32_t kMostComponents = 4096;
  if (table.struct_size < kFirstSize<weft_library_table>) return "its struct_size is too small";
  // A host can ignore the reserved fields that a later minor version uses, unless a flag forbids
  // it.
  const bool reserved_used =
      table.reserved_half != 0 || std::any_of(std::begin(table.reserved), std::end(table.reserved),
                                              [](std::uint64_t field) { return field != 0; });
  if (reserved_used && table.sdk_minor <= WEFT_ABI_MINOR) return "a reserved field is not zero";
  if (table.count == 0 || table.count > kMostComponents) {
    return "its count of components is " + std::to_string(table.count);
  }
  if (table.components == nullptr || table.isa == nullptr || table.compiler == nullptr) {
    return "its components, isa or compiler is null";
  }
  if (table.abi == nullptr || std::string_view(table.abi) != WEFT_ABI_NAME) {
    return "its abi is not " WEFT_ABI_NAME;
  }
  for (std::uint32_t i = 0; i < table.count; ++i) {
    const weft_component* component = table.components[i];
    const char* damage = component != nullptr ? damage_of(*component) : "it is null";
    if (damage != nullptr) return "component " + std::to_string(i) + ": " + damage;
  }
  return {};
}

Result<void> check_table(const weft_library_table& table, const std::string& file) {
  constexpr std::uint32_t kMagicOfCandidate = 0x54464557;
  if (table.magic == kMagicOfCandidate) {
    return incompatible(file,
                        "was built with a release candidate of plugin ABI 1.0, whose tables have "
                        "another layout; rebuild it against this version of Weft");
  }
  if (table.magic != WEFT_ABI_MAGIC) {
    return incompatible(file,
                        "its symbol 'weft_library' is no Weft library table; rebuild it with "
                        "weft_add_plugin()");
  }
  if (const std::string mismatch = abi_mismatch(table.abi_major, table.needs_minor);
      !mismatch.empty()) {
    return incompatible(file, mismatch + "; rebuild the plugin against this version of Weft");
  }
  const std::string damage = damage_of(table);
  if (damage.empty()) return {};
  return incompatible(file, "has a damaged library table: " + damage + "; rebuild the plugin");
}

/// True if a symbol is data of at least `bytes` bytes.
bool is_data(const void* symbol, std::size_t bytes) {
  Dl_info where{};
  const ElfW(Sym)* entry = nullptr;
  void* const found = static_cast<void*>(&entry);
  return dladdr1(symbol, &where, static_cast<void**>(found), RTLD_DL_SYMENT) != 0 &&
         entry != nullptr && ELF64_ST_TYPE(entry->st_info) == STT_OBJECT && entry->st_size >= bytes;
}

/// Never unloaded: code and type information of a plugin may be in use until the process ends. An
/// exception of a library that is being loaded ends the process, since it leaves the dynamic linker
/// locked. How this thread computes and how numbers are written stays as it was.
boost::dll::shared_library open_library(const std::string& file,
                                        boost::dll::fs::error_code& code) noexcept {
  using boost::dll::load_mode::rtld_local;
  using boost::dll::load_mode::rtld_now;
  const auto mode = static_cast<boost::dll::load_mode::type>(rtld_now | rtld_local | RTLD_NODELETE);
  const OneProcess one;
  const FloatingPointMode computing;
  const std::locale writing;
  boost::dll::shared_library library(boost::dll::fs::path(file), mode, code);
  computing.restore();
  if (std::locale() != writing) std::locale::global(writing);
  return library;
}

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
  if (const auto missing = missing_sanitizer(file)) {
    return incompatible(file, "cannot be loaded: it " + missing->cause + "; " + missing->fix);
  }
  boost::dll::fs::error_code code;
  const boost::dll::shared_library library = open_library(file, code);
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
  constexpr std::size_t kSmallest = offsetof(weft_library_table, abi);
  if (!is_data(&table, kSmallest)) {
    return incompatible(file,
                        "its symbol 'weft_library' is no table of data; end a source file with "
                        "WEFT_PLUGIN(...) and build it with weft_add_plugin()");
  }
  if (auto valid = check_table(table, file); !valid) return valid.error();
  note_code_of(&table, file);
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
    return incompatible(
        file, "'" + installed.component.id +
                  "' requires a feature that this version of Weft lacks; install a newer one");
  }
  return incompatible(file, "does not contain '" + installed.component.id +
                                "'; rebuild it so that library and manifest belong together");
}

}  // namespace weft::host
