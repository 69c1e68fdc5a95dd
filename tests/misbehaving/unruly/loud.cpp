// SPDX-License-Identifier: Apache-2.0
// A library that exports a thread-local variable, as it is linked without the version script.
#include <weft/sdk/filter.hpp>

extern "C" {
__attribute__((visibility("default"), tls_model("initial-exec"))) __thread int test_loud_counter =
    0;
}

namespace {

class Loud final : public weft::Filter {
 public:
  explicit Loud(weft::Params&) { ++test_loud_counter; }
  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("never finds one");
  }
};

}  // namespace

WEFT_PLUGIN(Loud, "filters/test_loud", "1.0.0", "Exports more than a library should.")
