// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>
#include <weft/sdk/filter.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {

/// How a filter did: TPR and FPR of Shetab-Bushehri et al. 2023, positive is a mismatch.
struct Rates {
  double tpr_percent = 0.0, fpr_percent = 0.0;
};

inline Rates rates_of(const InlierMask& mask, const std::vector<std::uint8_t>& correct) {
  double wrong = 0.0, right = 0.0, rejected_wrong = 0.0, rejected_right = 0.0;
  for (std::size_t i = 0; i < correct.size(); ++i) {
    const bool rejected = mask.kept(static_cast<std::int64_t>(i)) == 0;
    (correct[i] != 0 ? right : wrong) += 1.0;
    if (rejected) (correct[i] != 0 ? rejected_right : rejected_wrong) += 1.0;
  }
  return {100.0 * rejected_wrong / std::max(1.0, wrong),
          100.0 * rejected_right / std::max(1.0, right)};
}

/// Runs a filter on matches of a template of 960 x 575 px.
struct FilterBench {
  FilterBench(const std::string& id, const std::string& params = "{}") : plugin(id, params) {}

  Outcome run(const Correspondences& matches) {
    return plugin.process(0, {input("correspondences", matches), input("template", templ),
                              input("camera", make_camera())});
  }
  InlierMask mask(const Correspondences& matches) {
    const Outcome outcome = run(matches);
    EXPECT_TRUE(outcome.status == WEFT_OK || outcome.status == WEFT_DEGENERATE) << outcome.message;
    return *outcome.get<InlierMask>();
  }
  Rates rates(const LabelledMatches& drawn) { return rates_of(mask(drawn.matches), drawn.correct); }

  PluginUnderTest plugin;
  Template templ = make_template();
};

/// Matches on the template's flat sheet.
inline LabelledMatches flat_matches(const MatchSpec& spec, std::uint64_t seed) {
  Rng rng(seed);
  const DevelopableSheet sheet = make_bent_sheet({}, {}, {0.65, 0.0, 0.0, 0.2, -0.3, 0.1});
  return draw_matches(make_template(), make_camera(), sheet, spec, rng);
}

/// Matches on a sheet bent to a cylinder.
inline LabelledMatches bent_matches(const MatchSpec& spec, double radius_m, std::uint64_t seed) {
  Rng rng(seed);
  const DevelopableSheet sheet = make_cylinder({}, radius_m, 0.4);
  return draw_matches(make_template(), make_camera(), sheet, spec, rng);
}

/// The matches in the order of `rows`.
inline Correspondences reordered(const Correspondences& matches,
                                 const std::vector<std::int64_t>& rows) {
  const auto count = static_cast<std::int64_t>(rows.size());
  Correspondences result;
  result.template_px = Array<double>({count, 2});
  result.image_px = Array<double>({count, 2});
  result.face = Array<std::int32_t>({count});
  result.barycentrics = Array<double>({count, 3});
  result.kept = Array<std::uint8_t>({count});
  result.score = Array<double>({count});
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t from = rows[static_cast<std::size_t>(i)];
    std::copy_n(matches.template_px.row(from), 2, result.template_px.row(i));
    std::copy_n(matches.image_px.row(from), 2, result.image_px.row(i));
    std::copy_n(matches.barycentrics.row(from), 3, result.barycentrics.row(i));
    result.face(i) = matches.face(from);
    result.kept(i) = matches.kept(from);
    result.score(i) = matches.score(from);
  }
  return result;
}

/// That a filter's answer does not depend on the order of the matches.
inline void expect_no_order(FilterBench& bench, const Correspondences& matches) {
  std::vector<std::int64_t> rows(static_cast<std::size_t>(matches.count()));
  std::iota(rows.begin(), rows.end(), 0);
  std::reverse(rows.begin(), rows.end());
  std::rotate(rows.begin(), rows.begin() + 17, rows.end());
  const InlierMask first = bench.mask(matches);
  const InlierMask other = bench.mask(reordered(matches, rows));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(other.kept(static_cast<std::int64_t>(i)), first.kept(rows[i])) << i;
    ASSERT_EQ(other.score(static_cast<std::int64_t>(i)), first.score(rows[i])) << i;
  }
}

}  // namespace weft::testing
