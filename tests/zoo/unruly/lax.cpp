// SPDX-License-Identifier: Apache-2.0
// A filter whose table is in disorder: it takes any value of its parameter but one of a name that
// it does not know, and has every extension, another one each time.
#include <cstring>
#include <weft/sdk/filter.hpp>

namespace {

class Lax final : public weft::Filter {
 public:
  explicit Lax(weft::Params& p) { p.read("share", share_, "", {0.0, 1.0}, "of nothing"); }
  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("never finds one");
  }

 private:
  double share_ = 0.5;
};

std::int32_t create(const weft_create* with, void** self, weft_error* error) {
  for (std::uint64_t i = 0; i < with->count; ++i) {
    if (std::strcmp(with->values[i].name, "share") == 0) continue;
    std::strcpy(error->message, "what is that");
    return WEFT_ERROR;
  }
  const weft_create with_nothing{sizeof(weft_create), 0, with->host, nullptr, 0};
  return weft::detail::Functions<Lax>::create(&with_nothing, self, error);
}

/// The first is one that nobody asks for anything here.
const void* get_extension(const char* name) {
  static weft_device_memory extensions[2] = {{sizeof(weft_device_memory), 0, {}, {}, {}},
                                             {sizeof(weft_device_memory), 0, {}, {}, {}}};
  static int asked = 0;
  const bool has = std::strcmp(name, WEFT_DEVICE_MEMORY) == 0 || std::strstr(name, "no_such");
  return has ? &extensions[asked++ % 2] : nullptr;
}

constexpr weft_component kComponent = [] {
  weft_component lax = WEFT_COMPONENT(Lax, "filters/zoo_lax", "1.0.0", "Lets everything pass.");
  lax.create = &create;
  lax.methods = 0b101;
  return lax;
}();

/// With a table that has another extension each time once it is described.
constexpr weft_component kChanging = [] {
  weft_component changing = kComponent;
  changing.id = "filters/zoo_changing";
  changing.get_extension = &get_extension;
  return changing;
}();
constexpr const weft_component* kPointers[] = {&kComponent, &kChanging};

}  // namespace

const weft_library_table weft_library = {WEFT_ABI_MAGIC,
                                         WEFT_ABI_MAJOR,
                                         WEFT_ABI_MINOR,
                                         sizeof(weft_library_table),
                                         2,
                                         kPointers,
                                         WEFT_ISA,
                                         WEFT_COMPILER,
                                         0,
                                         0,
                                         0,
                                         {0, 0, 0, 0}};
