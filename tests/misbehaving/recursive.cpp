// SPDX-License-Identifier: Apache-2.0
// Holds itself by default, which would never end.
#include <weft/sdk/filter.hpp>

namespace {

class Recursive final : public weft::Filter {
 public:
  explicit Recursive(weft::Params& p) {
    p.component("left", left_, "another of its kind");
    p.component("right", right_, "another of its kind");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput&) override {
    return weft::no_result("does nothing");
  }

 private:
  weft::ComponentHandle left_{"filters", "filters/test_recursive"};
  weft::ComponentHandle right_{"filters", "filters/test_recursive"};
};

}  // namespace

WEFT_PLUGIN(Recursive, "filters/test_recursive", "1.0.0", "Holds itself by default.")
