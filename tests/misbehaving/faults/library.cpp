// SPDX-License-Identifier: Apache-2.0
// The table of the library, and what happens when it is loaded.
#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>
#include <weft/abi.h>
#include <xmmintrin.h>

#include <array>
#include <cfenv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <locale>
#include <mutex>
#include <stdexcept>
#include <unordered_map>
#include <weft/sdk/export.hpp>

#include "faults.hpp"

namespace weft::faults {
namespace {

std::string setting(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// The table of the library to change. If it cannot be loaded, prints the reason and returns null.
const weft_library_table* load_original() {
  static const weft_component* const kPlain = &plain_filter();
  static const weft_library_table kOwn{
      WEFT_ABI_MAGIC, WEFT_ABI_MAJOR, WEFT_ABI_MINOR, sizeof(weft_library_table), 1, WEFT_ABI_NAME,
      &kPlain,        WEFT_ISA,       WEFT_COMPILER,  WEFT_NEEDS_MINOR,           0, 0,
      {0, 0, 0, 0}};
  const std::string library = setting("WEFT_FAULT_PLUGIN");
  if (library.empty()) return &kOwn;
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  const void* table = handle != nullptr ? dlsym(handle, "weft_library") : nullptr;
  if (table == nullptr) std::fprintf(stderr, "faulty: %s\n", dlerror());
  return static_cast<const weft_library_table*>(table);
}

const weft_library_table* original_table() {
  static const weft_library_table* const loaded = load_original();
  return loaded;
}

/// A text without its end, before memory that cannot be read.
const char* endless_text() {
  constexpr std::size_t kPage = 4096;
  void* const pages =
      mmap(nullptr, 2 * kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  char* const text = static_cast<char*>(pages) + kPage - 16;
  std::memset(text, 'x', 16);
  mprotect(static_cast<char*>(pages) + kPage, kPage, PROT_NONE);
  return text;
}

std::array<weft_component, 2> components;
std::array<const weft_component*, 2> pointers{&components[0], &components[1]};

void spoil(weft_component& part) {
  if (has("component_size_0")) part.struct_size = 0;
  if (has("component_small")) part.struct_size -= 8;
  if (has("component_larger")) part.struct_size += 64;
  if (has("flag_low")) part.flags = 1U << 15U;
  if (has("flag_high")) part.flags = 1U << 31U;
  if (has("null_id")) part.id = nullptr;
  if (has("illegal_id")) part.id = "Filters Upper";
  if (has("endless_id")) part.id = endless_text();
  if (has("other_role")) part.id = "clouds/test_faulty";
  if (has("null_text")) part.summary = nullptr;
  if (has("wrong_needs")) part.needs = "curtains";
  if (has("null_describe")) part.describe = nullptr;
  if (has("null_create")) part.create = nullptr;
  if (has("null_prepare")) part.prepare = nullptr;
  if (has("null_process")) part.process = nullptr;
  if (has("null_destroy")) part.destroy = nullptr;
  if (has("no_methods")) part.methods = 0;
  if (has("other_methods")) part.methods = 0b101;
}

void spoil(weft_library_table& table) {
  if (has("wrong_magic")) table.magic ^= 1U;
  if (has("major_0")) table.abi_major = 0;
  if (has("major_2")) table.abi_major = 2;
  if (has("needs_minor")) table.needs_minor = table.sdk_minor = 99;
  if (has("count_0")) table.count = 0;
  if (has("count_huge")) table.count = 0xFFFFFFFFU;
  if (has("null_components")) table.components = nullptr;
  if (has("null_component")) pointers[0] = nullptr;
  if (has("table_size_0")) table.struct_size = 0;
  if (has("table_small")) table.struct_size -= 8;
  if (has("table_larger")) table.struct_size += 64;
  if (has("reserved_used")) table.reserved[3] = 1;
  if (has("reserved_newer")) table.sdk_minor = 7;
  if (has("reserved_newer")) table.reserved[3] = table.reserved_half = 1;
  if (has("library_flag_high")) table.flags = 1U << 16U;
  if (has("null_isa")) table.isa = nullptr;
  if (has("twice")) table.count = 2;
}

weft_library_table make_table() {
  if (original_table() == nullptr) return {};
  weft_component& part = components[0];
  part = original();
  part.struct_size = sizeof(weft_component);
  part.describe = describe;
  part.create = create;
  part.prepare = prepare;
  part.process = process;
  part.destroy = destroy;
  part.get_extension = get_extension;
  components[1] = part;
  spoil(part);
  weft_library_table table = *original_table();
  table.struct_size = sizeof(weft_library_table);
  table.components = pointers.data();
  spoil(table);
  act_when_loaded();
  return table;
}

/// Numbers with a decimal comma.
struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

[[noreturn]] void take_all_memory() {
  constexpr std::size_t kPart = 64U << 20U;
  while (true) {
    if (std::malloc(kPart) == nullptr) std::abort();
  }
}

struct Instances {
  std::mutex mutex;
  std::unordered_map<void*, Instance> all;
};
Instances& instances() {
  static Instances known;
  return known;
}

}  // namespace

bool has(std::string_view fault) {
  static const std::string chosen = setting("WEFT_FAULT");
  return fault == std::string_view(chosen).substr(0, chosen.find('@'));
}

bool is_place(std::string_view place) {
  static const std::string chosen = setting("WEFT_FAULT");
  const std::size_t at = chosen.find('@');
  return place == (at == std::string::npos ? "process" : std::string_view(chosen).substr(at + 1));
}

const weft_component& original() { return *original_table()->components[0]; }

void write_where_nothing_is() {
  void* const nothing = mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  *static_cast<volatile int*>(nothing) = 1;
}

void sleep_for_ever() {
  while (true) pause();
}

std::int32_t refuse(weft_error& error, const char* message) {
  std::strncpy(error.message, message, sizeof(error.message) - 1);
  return WEFT_ERROR;
}

void act_when_loaded() {
  if (has("load_throws")) throw std::runtime_error("the sky fell down");
  if (has("load_crashes")) write_where_nothing_is();
  if (has("load_exits")) std::exit(0);
  if (has("load_hangs")) sleep_for_ever();
  if (has("load_eats")) take_all_memory();
  if (has("load_prints")) std::puts("{\"what\": \"nobody asked for\"}");
  if (has("load_locale")) std::locale::global(std::locale(std::locale(), new Comma));
  if (has("load_rounds")) std::fesetround(FE_UPWARD);
  if (has("load_flushes")) _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  if (has("load_slow")) std::this_thread::sleep_for(std::chrono::milliseconds(400));
  if (has("load_thread")) std::thread(sleep_for_ever).detach();
  disturb_process("load");
}

Instance& instance_of(void* self) {
  static int created = 0;
  const std::lock_guard lock(instances().mutex);
  const auto [known, is_new] = instances().all.try_emplace(self);
  if (is_new) known->second.number = created++;
  return known->second;
}

void forget_instance(void* self) {
  const std::lock_guard lock(instances().mutex);
  instances().all.erase(self);
}

std::size_t instance_count() {
  const std::lock_guard lock(instances().mutex);
  return instances().all.size();
}

}  // namespace weft::faults

/// Filled in when the library is loaded, as it depends on another library.
const weft_library_table weft_library = weft::faults::make_table();
