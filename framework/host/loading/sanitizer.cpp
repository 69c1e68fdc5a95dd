// SPDX-License-Identifier: Apache-2.0
#include "host/loading/sanitizer.hpp"

#include <dlfcn.h>

#include <string_view>

#include "host/describe/elf_file.hpp"

namespace weft::host {
namespace {

struct Sanitizer {
  const char *name, *option;
  std::string_view symbol;   ///< symbol that instrumented code calls, or a prefix of it
  std::string_view library;  ///< how the name of GCC's runtime begins
  const char* preloaded;  ///< Clang's runtime; null where a program not built so reports anything
  bool comes_late;        ///< the runtime may be loaded with the library
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

/// The first name that begins so, or empty.
std::string name_with(const std::string& names, std::string_view start) {
  const std::size_t found = names.find('\0' + std::string(start));
  return found == std::string::npos ? std::string() : names.c_str() + found + 1;
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
  if (!file) return std::nullopt;
  const std::string names = dynamic_names(*file);
  for (const Sanitizer& sanitizer : kSanitizers) {
    const std::string symbol = name_with(names, sanitizer.symbol);
    const std::string runtime = name_with(names, sanitizer.library);
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
