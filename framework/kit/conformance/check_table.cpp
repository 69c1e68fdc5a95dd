// SPDX-License-Identifier: Apache-2.0
// Checks extensions beyond a component's declarations, and hosts that are older or newer than this
// one.
#include <fmt/format.h>

#include <array>
#include <cstring>

#include "kit/conformance/groups.hpp"
#include "kit/conformance/probes/passages.hpp"

namespace weft::conformance {
namespace {

constexpr std::array kExtensions = {WEFT_DEVICE_MEMORY, WEFT_DEVICES,   WEFT_CHECK,
                                    WEFT_SWEEP,         WEFT_ISOLATION, WEFT_STEERING};

const void* extension(const weft_component& component, const char* name) {
  return component.get_extension != nullptr ? component.get_extension(&component, name) : nullptr;
}

void check_unknown(const weft_component& component, Page& page) {
  for (const char* name : {"weft.there_is_no_such/1", "x.later.extension/1", ""}) {
    page.expect(extension(component, name) == nullptr,
                fmt::format("it has an extension of the name '{}': compare the whole name, and "
                            "return null for what you do not know",
                            name));
  }
}

void check_stable(const weft_component& component, const host::ComponentManifest& manifest,
                  Page& page) {
  for (const char* name : kExtensions) {
    const void* first = extension(component, name);
    page.expect(first == extension(component, name),
                fmt::format("{} is another table each time: return one that is static", name));
    const auto& listed = manifest.extensions;
    const bool is_listed = std::find(listed.begin(), listed.end(), name) != listed.end();
    page.expect(is_listed == (first != nullptr),
                fmt::format("{} is in one of library and manifest only: describe it again", name));
    std::uint32_t size = 0;
    if (first != nullptr) std::memcpy(&size, first, sizeof(size));
    page.expect(first == nullptr || size >= 2 * sizeof(std::uint32_t),
                fmt::format("{} does not begin with its size", name));
  }
}

void check_methods(Play& play, const weft_component& component, Page& page) {
  const std::size_t count = play.subject().rules().role.methods.size();
  page.expect(component.methods != 0, "it has no method: set the bits of those of its role");
  page.expect(count >= 64 || component.methods >> count == 0,
              "it declares methods that its role does not have");
}

/// Calls a method that does not exist, on each call by the execution context.
class OddMethod final : public testing::Passage {
 public:
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override {
    weft_call odd = call;
    odd.method = 63;
    status_ = Passage::process(component, self, odd, inputs, error);
    return status_;
  }
  std::int32_t status() const { return status_; }

 private:
  std::int32_t status_ = WEFT_OK;
};

void check_unknown_method(Play& play, Page& page) {
  OddMethod odd;
  const auto answers = play.whole({.passage = &odd});
  page.expect(odd.status() == WEFT_ERROR,
              fmt::format("it answers a method that there is not with status {}: compare "
                          "weft_call.method, and answer WEFT_ERROR with WEFT_CODE_UNSUPPORTED",
                          odd.status()));
}

void check_host(Play& play, Usual& usual, testing::Passage& host, const char* fix, Page& page) {
  const std::string how =
      difference(play.subject(), play.whole({.passage = &host}), usual.answers());
  if (!how.empty()) page.fail(how + "; " + fix);
}

}  // namespace

void check_table(const Setting& setting, Notebook& notebook) {
  const host::Installed& entry = *setting.candidate.installed();
  const auto loaded = host::load(entry);
  if (!loaded) return;  // reported by the check of its loading
  const weft_component& component = **loaded;
  notebook.check("table/unknown_extension", [&](Page& page) { check_unknown(component, page); });
  notebook.check("table/extensions_stable",
                 [&](Page& page) { check_stable(component, entry.component, page); });
  const auto play = Play::of(setting);
  if (!play) return;  // reported by the check of its parameters
  notebook.check("table/methods", [&](Page& page) { check_methods(**play, component, page); });
  notebook.check("table/unknown_method", [&](Page& page) { check_unknown_method(**play, page); });
  Usual usual(**play);
  notebook.check("table/older_host", [&](Page& page) {
    OldHost host;
    check_host(**play, usual, host, "of the host's structs, read no more than struct_size bytes",
               page);
  });
  notebook.check("table/newer_host", [&](Page& page) {
    NewHost host;
    check_host(**play, usual, host, "accept structs that are longer than those you know", page);
  });
}

}  // namespace weft::conformance
