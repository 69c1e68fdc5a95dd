// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
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

inline const SheetSpec kSheet{};

/// Runs a filter on matches of a template of 960 x 575 px.
struct FilterBench {
  FilterBench(const std::string& id, const std::string& params = "{}") : plugin(id, params) {}

  PluginAnswer run(const Correspondences& matches) {
    return plugin.process(0, {input("correspondences", matches), input("template", templ),
                              input("camera", make_camera())});
  }
  InlierMask mask(const Correspondences& matches) {
    const PluginAnswer outcome = run(matches);
    EXPECT_TRUE(outcome.status == WEFT_OK || outcome.status == WEFT_DEGENERATE) << outcome.message;
    return *outcome.get<InlierMask>();
  }
  Rates rates(const LabelledMatches& drawn) { return rates_of(mask(drawn.matches), drawn.correct); }

  PluginUnderTest plugin;
  Template templ = make_template(kSheet);
};

/// Matches on the template's flat surface.
inline LabelledMatches flat_matches(const MatchSpec& spec, std::uint64_t seed) {
  Rng rng(seed);
  const DevelopableSheet sheet = make_bent_sheet({}, {}, {0.65, 0.0, 0.0, 0.2, -0.3, 0.1});
  return draw_matches(make_template(), make_camera(), sheet, spec, rng);
}

/// Matches on a surface bent to a cylinder.
inline LabelledMatches bent_matches(const MatchSpec& spec, double radius_m, std::uint64_t seed) {
  Rng rng(seed);
  const DevelopableSheet sheet = make_cylinder({}, radius_m, 0.4);
  return draw_matches(make_template(), make_camera(), sheet, spec, rng);
}

/// The matches in the order of `rows`.
inline Correspondences reordered(const Correspondences& matches,
                                 const std::vector<std::int64_t>& rows) {
  const auto pick = [&](const auto& values, auto& picked) {
    if (!values.present()) return;
    const std::int64_t width = values.row_elements();
    const auto count = static_cast<std::int64_t>(rows.size());
    using Values = std::decay_t<decltype(values)>;
    picked = values.ndim() == 2 ? Values({count, width}) : Values({count});
    for (std::int64_t i = 0; i < count; ++i) {
      std::copy_n(values.row(rows[to_index(i)]), width, picked.row(i));
    }
  };
  Correspondences result;
  pick(matches.template_px, result.template_px);
  pick(matches.image_px, result.image_px);
  pick(matches.face, result.face);
  pick(matches.barycentrics, result.barycentrics);
  pick(matches.ratio, result.ratio);
  pick(matches.scale_ratio, result.scale_ratio);
  pick(matches.angle_difference_rad, result.angle_difference_rad);
  pick(matches.kept, result.kept);
  pick(matches.score, result.score);
  return result;
}

/// Expects that a filter's result does not depend on the order of the matches.
inline void expect_no_order(FilterBench& bench, const Correspondences& matches) {
  std::vector<std::int64_t> rows(to_index(matches.count()));
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

/// The contract of every filter, on matches that it can judge. Results depend on the input alone,
/// copies are judged alike, and nothing is restored. Invalid input gives an error or no result.
inline void expect_filter_contract(const std::string& id, const Correspondences& matches) {
  FilterBench bench(id), fresh(id);
  expect_no_order(bench, matches);
  const InlierMask warm = bench.mask(matches), first = fresh.mask(matches);
  const std::int64_t count = matches.count();
  for (std::int64_t i = 0; i < count; ++i) {
    ASSERT_EQ(warm.kept(i), first.kept(i)) << i;
    ASSERT_EQ(warm.score(i), first.score(i)) << i;
    ASSERT_TRUE(first.score(i) >= 0.0 && first.score(i) <= 1.0) << first.score(i);
  }
  std::vector<std::int64_t> rows(to_index(count));
  std::iota(rows.begin(), rows.end(), 0);
  for (const std::int64_t copied : {3, 8, 21}) rows.push_back(copied);
  const InlierMask with_copies = bench.mask(reordered(matches, rows));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(with_copies.kept(static_cast<std::int64_t>(i)), first.kept(rows[i])) << i;
  }
  Correspondences changed = reordered(matches, rows);
  changed.image_px(7, 1) = std::numeric_limits<double>::quiet_NaN();
  const PluginAnswer refused = bench.run(changed);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_NE(refused.message.find("match 7"), std::string::npos) << refused.message;
  changed.kept(7) = 0;
  EXPECT_EQ(bench.mask(changed).kept(7), 0);
  EXPECT_EQ(bench.run(reordered(matches, {})).status, WEFT_NO_RESULT);
  const std::vector<std::int64_t> one_place(rows.size(), 5);
  EXPECT_EQ(bench.run(reordered(matches, one_place)).status, WEFT_NO_RESULT);
}

/// Matches with ratios, angles and scales as descriptors give them: those of mismatches are random.
inline LabelledMatches with_descriptors(LabelledMatches drawn, std::uint64_t seed) {
  Rng rng(seed);
  const std::int64_t count = drawn.matches.count();
  drawn.matches.ratio = Array<double>({count}, 0.0);
  drawn.matches.angle_difference_rad = Array<double>({count}, 0.0);
  drawn.matches.scale_ratio = Array<double>({count}, 0.0);
  for (std::int64_t i = 0; i < count; ++i) {
    const bool correct = drawn.correct[to_index(i)] != 0;
    drawn.matches.ratio(i) = correct ? rng.uniform(0.3, 0.8) : rng.uniform(0.6, 0.8);
    drawn.matches.angle_difference_rad(i) = correct ? 0.1 * rng.normal() : rng.uniform(-3.1, 3.1);
    drawn.matches.scale_ratio(i) = std::exp(correct ? 0.1 * rng.normal() : rng.normal());
  }
  return drawn;
}

}  // namespace weft::testing
