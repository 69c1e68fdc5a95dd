// SPDX-License-Identifier: Apache-2.0
#include "host/loading/sanitizer.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

namespace weft::host {
namespace {

struct Sanitizer {
  const char *name, *option;
  std::string_view symbol;   ///< symbol that instrumented code calls, or a prefix of it
  std::string_view library;  ///< how the name of GCC's runtime begins
  const char* preloaded;     ///< Clang's runtime; null where a program not built so
                             ///< reports anything
  bool comes_late;           ///< the runtime may be loaded with the library
};

constexpr Sanitizer kSanitizers[] = {
    {"AddressSanitizer", "address", "__asan_init", "libasan.so", "libclang_rt.asan-x86_64.so",
     false},
    {"ThreadSanitizer", "thread", "__tsan_init", "libtsan.so", nullptr, false},
    {"HWAddressSanitizer", "hwaddress", "__hwasan_init", "libhwasan.so", nullptr, false},
    {"MemorySanitizer", "memory", "__msan_init", "libmsan.so", nullptr, false},
    {"UndefinedBehaviorSanitizer", "undefined", "__ubsan_handle_", "libubsan.so",
     "libclang_rt.ubsan_standalone-x86_64.so", true},
};

/// For each sanitizer the first names of a library that begin like its symbol
/// and its runtime, or empty texts.
struct Names {
  std::string_view symbol, runtime;
};
std::array<Names, std::size(kSanitizers)> names_in(std::string_view names) {
  std::array<Names, std::size(kSanitizers)> found{};
  for (std::size_t end = 0; !names.empty(); names.remove_prefix(std::min(end + 1, names.size()))) {
    end = std::min(names.find('\0'), names.size());
    const std::string_view name = names.substr(0, end);
    if (!name.starts_with("__") && !name.starts_with("lib")) continue;
    for (std::size_t i = 0; i < found.size(); ++i) {
      auto& [symbol, runtime] = found[i];
      if (symbol.empty() && name.starts_with(kSanitizers[i].symbol)) symbol = name;
      if (runtime.empty() && name.starts_with(kSanitizers[i].library)) runtime = name;
    }
  }
  return found;
}

bool is_loaded(const std::string& library) {
  void* const handle = dlopen(library.c_str(), RTLD_LAZY | RTLD_NOLOAD);
  if (handle != nullptr) dlclose(handle);
  return handle != nullptr;
}

std::string fix_of(const Sanitizer& sanitizer, const std::string& runtime) {
  std::string fix = "rebuild it without -fsanitize=" + std::string(sanitizer.option);
  if (sanitizer.preloaded == nullptr) return fix;
  const std::string of_clang =
      "$(clang++ -print-file-name=" + std::string(sanitizer.preloaded) + ")";
  return fix + ", or start Weft with LD_PRELOAD=" + (runtime.empty() ? of_clang : runtime);
}

}  // namespace

std::optional<MissingSanitizer> missing_sanitizer(const std::string& library) {
  const auto file = ElfFile::open(library);
  return file ? missing_sanitizer(*file) : std::nullopt;
}

std::optional<MissingSanitizer> missing_sanitizer(const ElfFile& library) {
  const std::string names = dynamic_names(library);
  const auto all_found = names_in(names);
  for (std::size_t i = 0; i < all_found.size(); ++i) {
    const Sanitizer& sanitizer = kSanitizers[i];
    const std::string symbol(all_found[i].symbol), runtime(all_found[i].runtime);
    const bool has_own = !runtime.empty() && sanitizer.comes_late;
    if (symbol.empty() || has_own) continue;
    const bool is_here =
        runtime.empty() ? dlsym(RTLD_DEFAULT, symbol.c_str()) != nullptr : is_loaded(runtime);
    if (is_here) continue;
    return MissingSanitizer{"is built with " + std::string(sanitizer.name) +
                                ", whose runtime must be in a program from its start and is not "
                                "in this one",
                            fix_of(sanitizer, runtime)};
  }
  return std::nullopt;
}

}  // namespace weft::host
