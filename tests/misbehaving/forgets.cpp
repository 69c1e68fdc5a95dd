// SPDX-License-Identifier: Apache-2.0
// Returns ok without the output that it has promised.
#include <weft/sdk/pass.hpp>

namespace {

class Forgets final : public weft::Pass {
 public:
  static constexpr weft::About kAbout{.produces = "sightlines visibility"};

  explicit Forgets(weft::Params& p) { p.read("vertices", vertices_, "", {0, 1000}, "seen"); }

  weft::Result<weft::PassOutput> run(const weft::PassInput&) override {
    weft::PassOutput out;
    const std::int64_t n = vertices_;
    out.visibility = weft::Visibility{weft::Array<std::uint8_t>({n}, 0),
                                      weft::Array<double>({n}, 0.0),
                                      weft::Array<std::uint8_t>({n}, 0),
                                      {}};
    return out;
  }

 private:
  int vertices_ = 4;
};

}  // namespace

WEFT_PLUGIN(Forgets, "passes/test_forgets", "1.0.0", "Forgets its sightlines.")
