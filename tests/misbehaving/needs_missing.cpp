// SPDX-License-Identifier: Apache-2.0
// Linked with a library that is not there when it is loaded.
#include "idle.hpp"

extern "C" int test_absent();

namespace {

class NeedsMissing final : public weft::Filter {
 public:
  explicit NeedsMissing(weft::Params&) {}

  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("answer " + std::to_string(test_absent()));
  }
};

}  // namespace

WEFT_PLUGIN(NeedsMissing, "filters/test_needs_missing", "1.0.0", "Needs a library that is absent.")
