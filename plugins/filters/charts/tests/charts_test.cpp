// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "chart_scene.hpp"
#include "common/tests/filter_bench.hpp"

namespace weft::charts {
namespace {

using testing::FilterBench;
using testing::PluginAnswer;
using testing::PluginUnderTest;

TEST(Charts, KeepAllSidesOfACubeWhereOneFilterLosesThem) {
  const ChartScene scene;
  PluginUnderTest bare("filters/aem"), charts("filters/charts");
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const SceneMatches made = matches_of(scene, {300, 120, 90}, 0.4, seed);
    const PluginAnswer of_bare = run_filter(bare, scene, made.matches);
    const PluginAnswer of_charts = run_filter(charts, scene, made.matches);
    ASSERT_EQ(of_charts.status, WEFT_OK) << of_charts.message;
    const InlierMask alone = *of_bare.get<InlierMask>(), mask = *of_charts.get<InlierMask>();
    EXPECT_GT(kept_share(alone, made, 0), 0.9);
    EXPECT_LT(kept_share(alone, made, 1) + kept_share(alone, made, 2), 0.2);
    for (int chart = 0; chart < 3; ++chart) {
      EXPECT_GT(kept_share(mask, made, chart), 0.95) << chart;
      EXPECT_LT(kept_share(mask, made, chart, false), 0.05) << chart;
    }
    EXPECT_GT(*mask.confidence.data(), 0.9);
    EXPECT_EQ(mask.diag.value("charts", 0.0), 3.0);
    EXPECT_EQ(mask.diag.value("kept_charts", 0.0), 3.0);
    EXPECT_EQ(mask.diag.value("misplaced_charts", -1.0), 0.0);
  }
}

TEST(Charts, RejectAChartThatIsElsewhere) {
  const ChartScene scene;
  SceneMatches made = matches_of(scene, {150, 100, 80}, 0.2, 4);
  displace(made, 2, {-150.0, 120.0});
  PluginUnderTest charts("filters/charts"), without("filters/charts", "{rigid_tolerance: 0}");
  const PluginAnswer checked = run_filter(charts, scene, made.matches);
  const PluginAnswer unchecked = run_filter(without, scene, made.matches);
  ASSERT_EQ(checked.status, WEFT_OK) << checked.message;
  EXPECT_EQ(kept_share(*checked.get<InlierMask>(), made, 2), 0.0);
  EXPECT_GT(kept_share(*checked.get<InlierMask>(), made, 0), 0.95);
  EXPECT_GT(kept_share(*checked.get<InlierMask>(), made, 1), 0.95);
  EXPECT_EQ(checked.get<InlierMask>()->diag.value("misplaced_charts", 0.0), 1.0);
  EXPECT_GT(kept_share(*unchecked.get<InlierMask>(), made, 2), 0.95);
}

TEST(Charts, KeepAnObjectThatIsBentABit) {
  const ChartScene scene;
  SceneMatches made = matches_of(scene, {150, 100, 80}, 0.2, 5);
  displace(made, 2, {12.0, -10.0});
  PluginUnderTest charts("filters/charts");
  const PluginAnswer answer = run_filter(charts, scene, made.matches);
  for (int chart = 0; chart < 3; ++chart) {
    EXPECT_GT(kept_share(*answer.get<InlierMask>(), made, chart), 0.95) << chart;
  }
}

TEST(Charts, AreNotSpoiledByOneWithoutACoherentSet) {
  const ChartScene scene;
  SceneMatches made = matches_of(scene, {150, 100, 40}, 0.2, 6);
  Rng rng(7);
  for (std::size_t i = 0; i < made.chart.size(); ++i) {
    if (made.chart[i] != 2) continue;
    made.correct[i] = 0;
    made.matches.image_px(static_cast<std::int64_t>(i), 0) = rng.uniform(0.0, 639.0);
    made.matches.image_px(static_cast<std::int64_t>(i), 1) = rng.uniform(0.0, 479.0);
  }
  PluginUnderTest charts("filters/charts");
  const PluginAnswer answer = run_filter(charts, scene, made.matches);
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  EXPECT_GT(*answer.get<InlierMask>()->confidence.data(), 0.9);
  EXPECT_EQ(kept_share(*answer.get<InlierMask>(), made, 2, false), 0.0);
  EXPECT_GT(kept_share(*answer.get<InlierMask>(), made, 0), 0.95);
}

TEST(Charts, RejectSmallChartsUnlessTheyAreToBeKept) {
  const ChartScene scene;
  const SceneMatches made = matches_of(scene, {150, 100, 7}, 0.3, 8);  // 3 of the 7 are wrong
  PluginUnderTest charts("filters/charts"), keeping("filters/charts", "{small: keep}"),
      few("filters/charts", "{min_matches: 7}");
  const PluginAnswer rejected = run_filter(charts, scene, made.matches);
  EXPECT_EQ(kept_share(*rejected.get<InlierMask>(), made, 2), 0.0);
  EXPECT_EQ(rejected.get<InlierMask>()->diag.value("small_chart_matches", 0.0), 7.0);
  const PluginAnswer kept = run_filter(keeping, scene, made.matches);
  const InlierMask mask = *kept.get<InlierMask>();
  EXPECT_EQ(kept_share(mask, made, 2), 1.0);
  EXPECT_LT(kept_share(mask, made, 2, false), 1.0);
  for (std::int64_t i = 250; i < 257; ++i) EXPECT_EQ(mask.score(i), mask.kept(i) != 0 ? 0.5 : 0.0);
  EXPECT_EQ(run_filter(few, scene, made.matches)
                .get<InlierMask>()
                ->diag.value("small_chart_matches", -1.0),
            0.0);
}

TEST(Charts, RejectMatchesBesideAllCharts) {
  const ChartScene scene;
  SceneMatches made = matches_of(scene, {100, 100, 100}, 0.0, 9);
  for (std::int64_t i = 0; i < 10; ++i) made.matches.face(i) = -1;
  PluginUnderTest charts("filters/charts");
  const InlierMask mask = *run_filter(charts, scene, made.matches).get<InlierMask>();
  for (std::int64_t i = 0; i < 10; ++i) EXPECT_EQ(mask.kept(i), 0) << i;
  EXPECT_EQ(mask.diag.value("matches_beyond_charts", 0.0), 10.0);
}

TEST(Charts, GiveTheResultOfTheNestedFilterForOneChart) {
  for (const std::string nested : {"filters/famouri", "filters/pizarro"}) {
    FilterBench alone(nested), charts("filters/charts", "{filter: {use: " + nested + "}}");
    const auto drawn = testing::bent_matches({300, 0.6, 0.5, 2.0}, 0.2, 31);
    const PluginAnswer a = alone.run(drawn.matches), b = charts.run(drawn.matches);
    ASSERT_EQ(a.status, b.status);
    const InlierMask expected = *a.get<InlierMask>(), mask = *b.get<InlierMask>();
    for (std::int64_t i = 0; i < 300; ++i) {
      EXPECT_EQ(mask.kept(i), expected.kept(i)) << i;
      EXPECT_EQ(mask.score(i), expected.score(i)) << i;
    }
    EXPECT_EQ(mask.diag.entries().size(), expected.diag.entries().size());
    EXPECT_EQ(mask.confidence.present(), expected.confidence.present());
  }
}

TEST(Charts, HaveNoResultWithoutMatches) {
  const ChartScene scene;
  PluginUnderTest charts("filters/charts");
  const PluginAnswer none = run_filter(charts, scene, matches_of(scene, {0, 0, 0}, 0.0, 1).matches);
  EXPECT_EQ(none.status, WEFT_NO_RESULT);
  EXPECT_EQ(none.message, "no chart has 8 matches");
  EXPECT_EQ(run_filter(charts, scene, matches_of(scene, {7, 7, 7}, 0.0, 1).matches).status,
            WEFT_NO_RESULT);
  SceneMatches line = matches_of(scene, {50, 50, 50}, 0.0, 1);
  for (std::int64_t i = 0; i < 150; ++i) line.matches.image_px(i, 1) = 100.0;
  const PluginAnswer collinear = run_filter(charts, scene, line.matches);
  EXPECT_EQ(collinear.status, WEFT_NO_RESULT);
  EXPECT_NE(collinear.message.find("no chart has a coherent set of matches: "), std::string::npos)
      << collinear.message;
}

TEST(Charts, NameAMatchThatIsNotFinite) {
  const ChartScene scene;
  SceneMatches made = matches_of(scene, {50, 50, 50}, 0.0, 10);
  made.matches.image_px(120, 1) = std::numeric_limits<double>::quiet_NaN();
  PluginUnderTest charts("filters/charts");
  const PluginAnswer refused = run_filter(charts, scene, made.matches);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_NE(refused.message.find("match 120"), std::string::npos) << refused.message;
  made.matches.kept(120) = 0;
  EXPECT_EQ(run_filter(charts, scene, made.matches).status, WEFT_OK);
}

TEST(Charts, DoNotDependOnTheOrderOfTheMatches) {
  const ChartScene scene;
  const SceneMatches made = matches_of(scene, {120, 80, 60}, 0.3, 11);
  std::vector<std::int64_t> rows(260);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = static_cast<std::int64_t>((7 * i + 31) % rows.size());
  }
  PluginUnderTest charts("filters/charts"), other("filters/charts");
  const PluginAnswer first = run_filter(charts, scene, made.matches);
  const PluginAnswer second = run_filter(other, scene, testing::reordered(made.matches, rows));
  const InlierMask a = *first.get<InlierMask>(), b = *second.get<InlierMask>();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(b.kept(static_cast<std::int64_t>(i)), a.kept(rows[i])) << i;
    ASSERT_EQ(b.score(static_cast<std::int64_t>(i)), a.score(rows[i])) << i;
  }
}

TEST(Charts, KeepTheContractOfFiltersOnOneChart) {
  testing::expect_filter_contract("filters/charts",
                                  testing::bent_matches({300, 0.6, 0.5, 2.0}, 0.2, 31).matches);
}

}  // namespace
}  // namespace weft::charts
