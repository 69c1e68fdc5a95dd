// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/filter.hpp>

#include "faults.hpp"

namespace weft::faults {
namespace {

enum class Colour { red, green };

/// Keeps what was kept before.
class Plain final : public Filter {
 public:
  static constexpr Sweep kSweep{"strictness", {0.1, 0.9}};

  explicit Plain(Params& p) {
    p.read("strictness", strictness_, "", {0.0, 1.0}, "how strict it is");
    p.read("bias", bias_, "", {0.0, 1.0}, "how biased it is");
    p.choice("colour", colour_, {{"red", Colour::red}, {"green", Colour::green}}, "its colour");
  }

  Result<InlierMask> filter(const FilterInput& in) override {
    const std::int64_t count = in.correspondences.count();
    InlierMask mask{Array<std::uint8_t>({count}, 0), Array<double>({count}, 1.0 / 3.0), {}};
    bool is_any_kept = false;
    for (std::int64_t i = 0; i < count; ++i) {
      mask.kept(i) = in.correspondences.kept(i);
      is_any_kept = is_any_kept || mask.kept(i) != 0;
    }
    if (!is_any_kept) return no_result("no match is kept");
    mask.diag.set("strictness", strictness_);
    mask.diag.set("bias", bias_);
    mask.diag.set("last_x_px", in.correspondences.image_px(count - 1, 0));
    mask.diag.set("red", colour_ == Colour::red ? 1.0 : 0.0);
    return mask;
  }

 private:
  double strictness_ = 0.5, bias_ = 0.0;
  Colour colour_ = Colour::red;
};

constexpr weft_component kPlain =
    WEFT_COMPONENT(Plain, "filters/test_faulty", "1.0.0", "Makes the fault that is chosen.");

}  // namespace

const weft_component& plain_filter() { return kPlain; }

}  // namespace weft::faults
