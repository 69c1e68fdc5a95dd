// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/truth/match_labels.hpp>

namespace {

using weft::Array;
using weft::FilterInput;
using weft::InlierMask;

/// Keeps the matches that the ground truth labels as inliers: the upper bound of any filter.
/// Matches that an earlier filter rejected stay rejected; their labels count and score as any
/// others.
class Oracle final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference = "own: Shetab-Bushehri et al. 2023, ROBUSfT, Sections V and VI (inliers)",
      .needs = "template camera ground_truth",
      .uses_truth = true};

  explicit Oracle(weft::Params& p) {
    p.read("tolerance_px", tolerance_px_, "px", {1e-6, 1e4},
           "distance from the true image point below which a match is an inlier");
    p.read("keep_unknown", keep_unknown_, "acceptance of matches without ground truth");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    if (!in.templ || !in.camera || !in.ground_truth) {
      return weft::Error{weft::Errc::invalid_data,
                         "template, camera and ground_truth are needed: connect all three"};
    }
    const Array<std::uint8_t>& left = in.correspondences.kept;
    if (std::count(left.data(), left.data() + left.size(), 1) == 0) {
      return weft::no_result("no match is left to judge: 0 of " + std::to_string(left.size()));
    }
    const auto truth = weft::TruthMap::create(*in.ground_truth);
    if (!truth) return truth.error();
    const weft::Pinhole camera{in.camera->fx, in.camera->fy, in.camera->cx, in.camera->cy};
    const auto labels =
        weft::label_matches(in.correspondences, *truth, *in.templ, camera, tolerance_px_);
    InlierMask mask = judge(labels, left);
    const bool keeps_any = std::count(mask.kept.data(), mask.kept.data() + left.size(), 1) > 0;
    if (!keeps_any) return weft::degenerate(std::move(mask), "the truth calls no match correct");
    return mask;
  }

 private:
  InlierMask judge(const std::vector<std::int8_t>& labels, const Array<std::uint8_t>& left) const {
    const auto count = static_cast<std::int64_t>(labels.size());
    InlierMask mask;
    mask.kept = Array<std::uint8_t>({count});
    mask.score = Array<double>({count});
    for (std::int64_t n = 0; n < count; ++n) {
      const std::int8_t label = labels[weft::to_index(n)];
      const bool unknown = label == weft::kUnknownMatch;
      const bool keeps = label == weft::kCorrectMatch || (unknown && keep_unknown_);
      mask.kept(n) = keeps && left(n) != 0 ? 1 : 0;
      mask.score(n) = unknown ? 0.5 : static_cast<double>(label);
    }
    for (const auto& [name, label] : {std::pair("correct_matches", weft::kCorrectMatch),
                                      std::pair("mismatches", weft::kMismatch),
                                      std::pair("unknown_matches", weft::kUnknownMatch)}) {
      mask.diag.set(name, static_cast<double>(std::count(labels.begin(), labels.end(), label)));
    }
    return mask;
  }

  double tolerance_px_ = 2.0;
  bool keep_unknown_ = false;
};

}  // namespace

WEFT_PLUGIN(Oracle, "filters/oracle", "1.0.0",
            "Keeps the inliers according to the ground truth; for experiments only.")
