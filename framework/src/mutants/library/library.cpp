// SPDX-License-Identifier: Apache-2.0
// The library: its table is that of the plugin that it loads, with functions in between.
#include <dlfcn.h>
#include <weft/abi.h>

#include <array>
#include <fstream>
#include <iostream>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "mutants/library/component.hpp"
#include "mutants/library/deeds.hpp"

namespace weft::mutants {
namespace {

constexpr std::size_t kMostComponents = 16;

/// The end of the line that begins with this word.
std::string line_of(const std::string& file, const std::string& word) {
  std::ifstream text(file);
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with(word + " ")) return line.substr(word.size() + 1);
  }
  return {};
}

struct Place {
  char text[kOrderRoom];
};
constexpr Place marked() {
  Place place{};
  for (std::size_t i = 0; i < kOrderMark.size(); ++i) place.text[i] = kOrderMark[i];
  return place;
}
/// Who makes a mutant writes behind the mark, into the file.
constinit volatile Place place_of_order = marked();

std::string written_place() {
  std::string path;
  for (std::size_t i = kOrderMark.size(); place_of_order.text[i] != '\0'; ++i) {
    path += place_of_order.text[i];
  }
  return path;
}

/// Written into the library, or beside it.
std::string file_of_order() {
  if (std::string written = written_place(); !written.empty()) return written;
  Dl_info info{};
  static const char here = 0;
  if (dladdr(&here, &info) == 0) return {};
  std::string file = info.dli_fname;
  if (file.ends_with(".so")) file.resize(file.size() - 3);
  return file + ".mutant";
}

Order read_order() {
  const std::string file = file_of_order();
  return {line_of(file, "library"), line_of(file, "component"), line_of(file, "operator")};
}

/// Null, and a line that says why, where there is no plugin to load.
const weft_library_table* load_original() {
  void* handle = dlopen(order().library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  const void* table = handle != nullptr ? dlsym(handle, "weft_library") : nullptr;
  if (table == nullptr) std::cerr << "mutant: " << dlerror() << '\n';
  return static_cast<const weft_library_table*>(table);
}

struct Tables {
  const weft_library_table* original = load_original();
  std::array<weft_component, kMostComponents> components{};
  std::array<const weft_component*, kMostComponents> pointers{};
};
Tables& tables() {
  static Tables both;
  return both;
}

/// The functions of the component at one place: the contract gives them nothing to tell it by.
template <std::size_t place>
struct Functions {
  static const weft_component& original() { return *tables().original->components[place]; }

  static std::int32_t describe(const weft_describe* sink, weft_error* error) {
    return mutants::describe(original(), *sink, *error);
  }
  static std::int32_t create(const weft_create* with, void** self, weft_error* error) {
    return mutants::create(original(), *with, self, *error);
  }
  static std::int32_t prepare(void* self, const weft_call* call, const weft_record* inputs,
                              std::uint64_t count, weft_error* error) {
    return mutants::prepare(original(), self, *call, {inputs, inputs + count}, *error);
  }
  static std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                              std::uint64_t count, weft_error* error) {
    return mutants::process(original(), self, *call, {inputs, inputs + count}, *error);
  }
  static void destroy(void* self) { mutants::destroy(original(), self); }
  static const void* get_extension(const char* name) {
    return mutants::get_extension(original(), name);
  }
};

template <std::size_t place>
void put_between(weft_component& component) {
  using Mine = Functions<place>;
  component = Mine::original();
  component.struct_size = does("short_component") ? 16 : sizeof(weft_component);
  component.describe = Mine::describe;
  component.create = Mine::create;
  component.prepare = Mine::prepare;
  component.process = Mine::process;
  component.destroy = does("no_destroy") ? nullptr : Mine::destroy;
  component.get_extension = Mine::get_extension;
}

template <std::size_t... places>
void put_all_between(std::uint32_t count, std::index_sequence<places...>) {
  ((places < count ? put_between<places>(tables().components[places]) : void()), ...);
}

weft_library_table make_table() {
  const weft_library_table* original = tables().original;
  if (original == nullptr || original->count > kMostComponents) return {};
  put_all_between(original->count, std::make_index_sequence<kMostComponents>());
  for (std::size_t i = 0; i < kMostComponents; ++i) {
    tables().pointers[i] = &tables().components[i];
  }
  weft_library_table table = *original;
  table.struct_size = does("short_table") ? 8 : sizeof(weft_library_table);
  table.components = tables().pointers.data();
  if (does("wrong_magic")) table.magic ^= 1U;
  if (does("wrong_major")) ++table.abi_major;
  if (does("needs_newer_host")) table.needs_minor = 99;
  if (does("uses_reserved")) table.reserved[3] = 1;
  misbehave_when_loaded();
  return table;
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

const Order& order() {
  static const Order read = read_order();
  return read;
}

bool does(Deed deed) {
  static const Operator* const chosen = find_operator(order().deed);
  return chosen != nullptr && chosen->name == kOperators[deed.place].name;
}

bool is_subject(const weft_component& component) { return order().component == component.id; }

Instance& instance_of(void* self) {
  const std::lock_guard lock(instances().mutex);
  return instances().all[self];
}

void forget_instance(void* self) {
  const std::lock_guard lock(instances().mutex);
  instances().all.erase(self);
}

std::size_t instance_count() {
  const std::lock_guard lock(instances().mutex);
  return instances().all.size();
}

}  // namespace weft::mutants

/// Filled when the library is loaded: until then nobody knows what stands in the other.
const weft_library_table weft_library = weft::mutants::make_table();
