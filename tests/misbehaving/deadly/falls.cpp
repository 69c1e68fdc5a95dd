// SPDX-License-Identifier: Apache-2.0
// Performs the fault that WEFT_FALLS names when it is loaded, or when its component is created.
#include <signal.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/sdk/filter.hpp>

namespace {

std::string action() {
  const char* said = std::getenv("WEFT_FALLS");
  return said != nullptr ? said : "";
}

struct WhenLoaded {
  WhenLoaded() {
    if (action() == "fault") raise(SIGSEGV);
    if (action() == "exit") std::exit(0);
    if (action() == "print") std::printf("what nobody asked for");
  }
};
const WhenLoaded when_loaded;

class Falls final : public weft::Filter {
 public:
  explicit Falls(weft::Params&) {
    if (action() == "throw") throw std::runtime_error("no such table");
    if (action() == "leave") std::exit(7);
  }

  static std::vector<std::string> devices() { return {"a device"}; }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("is only looked at");
  }
};

}  // namespace

WEFT_PLUGIN(Falls, "filters/test_falls", "1.0.0", "Falls over when it is loaded.")
