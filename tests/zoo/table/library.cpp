// SPDX-License-Identifier: Apache-2.0
// The table of the library, which is filled in when it is loaded.
#include <fenv.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xmmintrin.h>

#include <array>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <locale>
#include <stdexcept>

#include "animal.hpp"

namespace zoo {

bool is(std::string_view mistake) {
  const char* told = std::getenv("WEFT_ZOO_ANIMAL");
  return told != nullptr && mistake == told;
}

void write_where_nothing_is() {
  void* const nothing = mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  *static_cast<volatile int*>(nothing) = 1;
}

void sleep_for_ever() {
  while (true) pause();
}

namespace {

/// Numbers as most of Europe writes them.
struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

/// A text without its end: what comes behind it is nobody's.
const char* endless_text() {
  constexpr std::size_t kPage = 4096;
  void* const pages =
      mmap(nullptr, 2 * kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  char* const text = static_cast<char*>(pages) + kPage - 16;
  std::memset(text, 'x', 16);
  mprotect(static_cast<char*>(pages) + kPage, kPage, PROT_NONE);
  return text;
}

[[noreturn]] void eat_all_memory() {
  constexpr std::size_t kPart = 64U << 20U;
  while (true) {
    if (std::malloc(kPart) == nullptr) std::abort();
  }
}

weft_component component;
weft_component other;
std::array<const weft_component*, 2> components{&component, &other};

}  // namespace

void act_when_loaded() {
  if (is("load_throws")) throw std::runtime_error("the sky fell down");
  if (is("load_crashes")) write_where_nothing_is();
  if (is("load_exits")) std::exit(0);
  if (is("load_hangs")) sleep_for_ever();
  if (is("load_eats")) eat_all_memory();
  if (is("load_prints")) std::printf("{\"what\": \"nobody asked for\"}\n");
  if (is("load_locale")) std::locale::global(std::locale(std::locale(), new Comma));
  if (is("load_rounds")) std::fesetround(FE_UPWARD);
  if (is("load_flushes")) _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
}

void spoil(weft_library_table& table, weft_component& part) {
  if (is("major_0")) table.abi_major = 0;
  if (is("major_2")) table.abi_major = 2;
  if (is("needs_minor")) table.needs_minor = table.sdk_minor = 99;
  if (is("count_0")) table.count = 0;
  if (is("count_huge")) table.count = 0xFFFFFFFFU;
  if (is("null_components")) table.components = nullptr;
  if (is("null_component")) components[0] = nullptr;
  if (is("table_size_0")) table.struct_size = 0;
  if (is("table_small")) table.struct_size -= 8;
  if (is("table_larger")) table.struct_size += 64;
  if (is("reserved_used")) table.reserved[3] = 1;
  if (is("reserved_newer")) table.sdk_minor = 7;
  if (is("reserved_newer")) table.reserved[3] = table.reserved_half = 1;
  if (is("library_flag_high")) table.flags = 1U << 16U;
  if (is("twice")) table.count = 2;
  if (is("component_size_0")) part.struct_size = 0;
  if (is("component_small")) part.struct_size -= 8;
  if (is("component_larger")) part.struct_size += 64;
  if (is("flag_low")) part.flags = 1U << 15U;
  if (is("flag_high")) part.flags = 1U << 31U;
  if (is("null_id")) part.id = nullptr;
  if (is("illegal_id")) part.id = "Filters Animal";
  if (is("endless_id")) part.id = endless_text();
  if (is("other_role")) part.id = "clouds/zoo_animal";
  if (is("null_text")) part.summary = nullptr;
  if (is("null_isa")) table.isa = nullptr;
  if (is("wrong_needs")) part.needs = "curtains";
  if (is("null_describe")) part.describe = nullptr;
  if (is("null_create")) part.create = nullptr;
  if (is("null_prepare")) part.prepare = nullptr;
  if (is("null_process")) part.process = nullptr;
  if (is("null_destroy")) part.destroy = nullptr;
  if (is("no_methods")) part.methods = 0;
}

}  // namespace zoo

// Under another name in C++, where the symbol is declared constant.
extern "C" WEFT_EXPORT weft_library_table animal __asm__("weft_library");
weft_library_table animal = {WEFT_ABI_MAGIC,
                             WEFT_ABI_MAJOR,
                             WEFT_ABI_MINOR,
                             sizeof(weft_library_table),
                             1,
                             zoo::components.data(),
                             "",
                             "by hand",
                             0,
                             0,
                             0,
                             {0, 0, 0, 0}};

namespace {

const bool filled_in = [] {
  zoo::component = zoo::other = {sizeof(weft_component),
                                 0,
                                 "filters/zoo_animal",
                                 "1.0.0",
                                 "Makes the mistake that it is told to make.",
                                 "",
                                 "",
                                 "exact",
                                 "",
                                 "",
                                 "",
                                 1,
                                 &zoo::describe,
                                 &zoo::create,
                                 &zoo::prepare,
                                 &zoo::process,
                                 &zoo::destroy,
                                 &zoo::get_extension};
  zoo::spoil(animal, zoo::component);
  zoo::act_when_loaded();
  return true;
}();

}  // namespace
