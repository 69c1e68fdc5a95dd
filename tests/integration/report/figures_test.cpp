// SPDX-License-Identifier: Apache-2.0
#include "lab/report/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "fake_results.hpp"
#include "lab/report/parts.hpp"

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

/// The content of a folder's figures.
struct Drawn {
  explicit Drawn(const FakeResults& fake) {
    auto read = read_results(fake.folder());
    if (!read) throw std::runtime_error(read.error().message);
    results = *std::move(read);
    auto made = make_tables(results);
    if (!made) throw std::runtime_error(made.error().message);
    tables = *std::move(made);
    auto drawn = make_figures(results, tables);
    if (!drawn) throw std::runtime_error(drawn.error().message);
    figures = *std::move(drawn);
  }
  std::size_t place_of(const std::string& name) const {
    for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
      if (tables.combinations[i].name == name) return i;
    }
    throw std::runtime_error("no combination " + name);
  }

  Results results;
  ReportTables tables;
  Figures figures;
};

TEST(ReportFigures, TakeDifferencesOverTheFramesFromTheSmallestMeanSequenceBySequence) {
  const Drawn drawn{FakeResults({})};
  EXPECT_EQ(drawn.figures.reference, drawn.place_of("steady · 0.05"));
  const FrameCurve& steady = drawn.figures.over_frames[drawn.place_of("steady · 0.1")];
  const FrameCurve& shaky = drawn.figures.over_frames[drawn.place_of("shaky · 0.1")];
  ASSERT_THAT(shaky.difference.y, SizeIs(FakeResults::kFrames));
  for (int t = 0; t < FakeResults::kFrames; ++t) {
    EXPECT_NEAR(steady.error.y[t], 2.35 + 0.01 * t, 1e-5);
    EXPECT_NEAR(steady.difference.y[t], 0.0, 1e-5);
    // It errs by 1 mm more in four of eight sequences; the first of them lacks the last frame.
    EXPECT_NEAR(shaky.difference.y[t], t + 1 < FakeResults::kFrames ? 4.0 / 8.0 : 4.0 / 7.0, 1e-5);
  }
  ASSERT_THAT(shaky.difference.band.x, SizeIs(FakeResults::kFrames));
  EXPECT_LT(shaky.difference.band.low[0], 0.5F);
  EXPECT_GT(shaky.difference.band.high[0], 0.5F);
}

TEST(ReportFigures, HaveNoBandsOfFewSequences) {
  FakeResults::Choice few;
  few.sequences = 5;
  const Drawn drawn{FakeResults(few)};
  for (const FrameCurve& curve : drawn.figures.over_frames) {
    EXPECT_THAT(curve.error.band.x, IsEmpty());
    EXPECT_THAT(curve.difference.band.x, IsEmpty());
  }
}

TEST(ReportFigures, ShowSceneBySceneWhereOneIsBetter) {
  const Drawn drawn{FakeResults({})};
  const ComparisonResult& comparison = drawn.tables.comparisons.at(0);
  ASSERT_THAT(comparison.scenes, SizeIs(comparison.table.pairs.size()));
  ASSERT_EQ(comparison.table.pairs[0].a, "shaky");
  ASSERT_THAT(comparison.scenes[0], SizeIs(8));
  for (std::size_t s = 0; s < 8; ++s) {
    const SceneEffect& effect = comparison.scenes[0][s];
    const double expected = s % 2 == 1 ? 1.0 : 0.0;
    EXPECT_EQ(effect.scene, "plain_" + std::to_string(101 + s));
    EXPECT_NEAR(effect.mean, expected, 1e-9);
    EXPECT_NEAR(effect.interval.low, expected, 1e-9) << "the frames do not differ";
    EXPECT_NEAR(effect.interval.high, expected, 1e-9);
  }
  EXPECT_THAT(comparison.scenes[1], IsEmpty()) << "broken has no value anywhere";
}

TEST(ReportFigures, GiveAKindOfDataARowWhereThereAreManySequences) {
  FakeResults::Choice many;
  many.sequences = 26;
  many.seeds = {1};
  FakeResults fake(many);
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  nlohmann::json even = nlohmann::json::array(), odd = nlohmann::json::array();
  for (int s = 0; s < many.sequences; ++s) {
    (s % 2 == 0 ? even : odd).push_back("plain_" + std::to_string(101 + s));
  }
  plan["data"] = {{{"name", "even"}, {"sequences", even}}, {{"name", "odd"}, {"sequences", odd}}};
  fake.write("plan.json", plan);
  const Drawn drawn{fake};
  const std::vector<SceneEffect>& scenes = drawn.tables.comparisons.at(0).scenes.at(0);
  ASSERT_THAT(scenes, SizeIs(2));
  EXPECT_EQ(scenes[0].scene, "even");
  EXPECT_NEAR(scenes[0].mean, 0.0, 1e-9);
  EXPECT_EQ(scenes[1].scene, "odd");
  EXPECT_NEAR(scenes[1].mean, 1.0, 1e-9);
  EXPECT_EQ(scenes[1].n, 13);
}

TEST(ReportFigures, LeaveMeasuresOutThatAnAxisDoesNotChange) {
  const Drawn drawn{FakeResults({})};
  ASSERT_THAT(drawn.figures.sweeps, SizeIs(2));
  EXPECT_THAT(drawn.figures.sweeps[1].measures, ElementsAre("filters: TPR, %", "filters: FPR, %"));
  for (const SweepCurve& curve : drawn.figures.sweeps[1].curves) {
    EXPECT_THAT(curve.figures, SizeIs(2));
  }
}

TEST(ReportFigures, AreLeftOutWhereTheySayNothing) {
  Drawn drawn{FakeResults({})};
  const auto certainty = [&] { return certainty_part(drawn.results, drawn.tables, true); };
  const auto curves = [&] { return curves_part(drawn.tables, drawn.figures); };
  EXPECT_THAT(certainty(), HasSubstr("figure-reliability"));
  EXPECT_THAT(curves(), HasSubstr("figure-by-frame"));
  for (Combination& combination : drawn.tables.combinations) {
    for (std::size_t bin = 0; bin < combination.certainty.bins.size(); ++bin) {
      if (bin != 9) combination.certainty.bins[bin].frames = 0;
    }
  }
  for (FrameCurve& curve : drawn.figures.over_frames) {
    if (!curve.error.x.empty()) curve.error.x.resize(1);
  }
  EXPECT_THAT(certainty(), Not(HasSubstr("figure-reliability")));
  EXPECT_THAT(curves(), Not(HasSubstr("figure-by-frame")));
}

}  // namespace
}  // namespace weft::lab
