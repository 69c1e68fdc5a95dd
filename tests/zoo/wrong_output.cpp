// SPDX-License-Identifier: Apache-2.0
// Returns masks that no reader could use.
#include <cmath>
#include <limits>
#include <weft/sdk/filter.hpp>

namespace {

enum class Mistake {
  none,
  shorter,
  disagree,
  two_columns,
  nan,
  infinity,
  absent,
  bad_name,
  negative
};

class WrongOutput final : public weft::Filter {
 public:
  explicit WrongOutput(weft::Params& p) {
    p.choice("mistake", mistake_,
             {{"none", Mistake::none},
              {"shorter", Mistake::shorter},
              {"disagree", Mistake::disagree},
              {"two_columns", Mistake::two_columns},
              {"nan", Mistake::nan},
              {"infinity", Mistake::infinity},
              {"absent", Mistake::absent},
              {"bad_name", Mistake::bad_name},
              {"negative", Mistake::negative}},
             "what is wrong");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t n = in.correspondences.count();
    const std::int64_t length = mistake_ == Mistake::shorter ? n - 1 : n;
    weft::InlierMask mask{weft::Array<std::uint8_t>({length}), weft::Array<double>({length}), {}};
    if (mistake_ == Mistake::disagree) mask.score = weft::Array<double>({n + 2});
    if (mistake_ == Mistake::two_columns) mask.score = weft::Array<double>({n, 2});
    if (mistake_ == Mistake::nan) mask.score(n - 1) = std::nan("");
    if (mistake_ == Mistake::infinity) mask.score(0) = std::numeric_limits<double>::infinity();
    if (mistake_ == Mistake::absent) mask.kept = {};
    if (mistake_ == Mistake::bad_name) mask.diag.set("../../escape", 1.0);
    if (mistake_ == Mistake::negative) mask.score = weft::Array<double>({n - 1000});
    return mask;
  }

 private:
  Mistake mistake_ = Mistake::none;
};

}  // namespace

WEFT_PLUGIN(WrongOutput, "filters/zoo_wrong_output", "1.0.0", "Returns masks of no use.")
