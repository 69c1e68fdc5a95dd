// SPDX-License-Identifier: Apache-2.0
// Returns masks that no reader could use.
#include <algorithm>
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
  negative,
  no_flag,
  too_sure
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
              {"negative", Mistake::negative},
              {"no_flag", Mistake::no_flag},
              {"too_sure", Mistake::too_sure}},
             "what is wrong");
    p.read("frame", frame_, "", {-1, 1e6}, "in which it is, -1 for all");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const bool due = frame_ < 0 || in.call.frame() == static_cast<std::uint64_t>(frame_);
    const Mistake mistake = due ? mistake_ : Mistake::none;
    const std::int64_t n = in.correspondences.count();
    const std::int64_t length = mistake == Mistake::shorter ? n - 1 : n;
    weft::InlierMask mask{
        weft::Array<std::uint8_t>({length}, 0), weft::Array<double>({length}, 0.0), {}};
    std::fill_n(mask.kept.data(), length, std::uint8_t{1});
    if (mistake == Mistake::disagree) mask.score = weft::Array<double>({n + 2}, 0.0);
    if (mistake == Mistake::two_columns) mask.score = weft::Array<double>({n, 2}, 0.0);
    if (mistake == Mistake::nan) mask.score(n - 1) = std::nan("");
    if (mistake == Mistake::infinity) mask.score(0) = std::numeric_limits<double>::infinity();
    if (mistake == Mistake::absent) mask.kept = {};
    if (mistake == Mistake::bad_name) mask.diag.set("../../escape", 1.0);
    if (mistake == Mistake::negative) mask.score = weft::Array<double>({n - 1000}, 0.0);
    if (mistake == Mistake::no_flag) mask.kept(n - 1) = 255;
    if (mistake == Mistake::too_sure) mask.confidence = weft::make_scalar(1.5);
    return mask;
  }

 private:
  Mistake mistake_ = Mistake::none;
  int frame_ = -1;
};

}  // namespace

WEFT_PLUGIN(WrongOutput, "filters/test_wrong_output", "1.0.0", "Returns masks of no use.")
