// SPDX-License-Identifier: Apache-2.0
// Does what WEFT_ZOO_FALLS says as soon as it is loaded.
#include <signal.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>
#include <weft/sdk/filter.hpp>

namespace {

struct WhenLoaded {
  WhenLoaded() {
    const char* said = std::getenv("WEFT_ZOO_FALLS");
    const std::string deed = said != nullptr ? said : "";
    if (deed == "fault") raise(SIGSEGV);
    if (deed == "exit") std::exit(0);
    if (deed == "print") std::printf("what nobody asked for");
  }
};
const WhenLoaded when_loaded;

class Falls final : public weft::Filter {
 public:
  explicit Falls(weft::Params&) {}

  static std::vector<std::string> devices() { return {"a device"}; }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("is only looked at");
  }
};

}  // namespace

WEFT_PLUGIN(Falls, "filters/zoo_falls", "1.0.0", "Falls over when it is loaded.")
