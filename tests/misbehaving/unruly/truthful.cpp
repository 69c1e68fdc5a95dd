// SPDX-License-Identifier: Apache-2.0
// Marks too few matches where the truth is NaN.
#include <cmath>
#include <weft/sdk/filter.hpp>

namespace {

class Truthful final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{.needs = "ground_truth", .uses_truth = true};
  explicit Truthful(weft::Params&) {}

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    std::int64_t count = in.correspondences.count();
    const auto& truth = (*in.ground_truth).match_xy_px;
    if (count > 0 && truth.present() && std::isnan(truth(0, 0))) --count;
    return weft::InlierMask{
        weft::Array<std::uint8_t>({count}, 0), weft::Array<double>({count}, 0.0), {}};
  }
};

}  // namespace

WEFT_PLUGIN(Truthful, "filters/test_truthful", "1.0.0", "Cannot take a truth that is unknown.")
