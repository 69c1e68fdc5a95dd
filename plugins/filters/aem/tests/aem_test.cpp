// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/atlas.hpp>

#include "common/tests/filter_bench.hpp"
#include "match_scenes.hpp"

namespace weft::testing {
namespace {

/// The mean over a few sets.
Rates mean_rates(const SceneSpec& spec, std::initializer_list<std::uint64_t> seeds) {
  FilterBench bench("filters/aem");
  Rates mean;
  for (const std::uint64_t seed : seeds) {
    const Rates rates = bench.rates(draw_scene(spec, seed));
    mean.tpr_percent += rates.tpr_percent / static_cast<double>(seeds.size());
    mean.fpr_percent += rates.fpr_percent / static_cast<double>(seeds.size());
  }
  return mean;
}

double confidence_of(const PluginAnswer& outcome) {
  const auto mask = outcome.get<InlierMask>();
  return mask ? mask->diag.value("confidence", -1.0) : 0.0;
}

TEST(Aem, FindsTheSheetWhereMyNeighborDoesNot) {
  for (const auto& [count, rate] : {std::pair(1000, 0.3), {200, 0.3}, {200, 0.2}, {50, 0.3}}) {
    const Rates rates = mean_rates({Kind::paper, count, rate}, {1, 2, 3, 4});
    EXPECT_GT(rates.tpr_percent, 99.0) << count << " matches, " << rate;
    EXPECT_LT(rates.fpr_percent, 2.5) << count << " matches, " << rate;
  }
}

TEST(Aem, FindsTheObjectOfAnAtlasOfWhichItCoversATwelfth) {
  const LabelledMatches drawn = draw_scene({Kind::paper, 200, 0.8}, 8);
  FilterBench bench("filters/aem");
  const Rates alone = bench.rates(drawn);
  LabelledMatches moved = drawn;
  const Eigen::RowVector2d corner_px(1700.0, 1200.0);
  moved.matches.template_px.matrix<2>().rowwise() += corner_px;
  put_in_atlas(bench.templ, 3000, 2165, corner_px);
  const Rates in_atlas = bench.rates(moved);
  EXPECT_GT(alone.tpr_percent, 97.0);
  EXPECT_LT(alone.fpr_percent, 1.0);
  EXPECT_EQ(in_atlas.tpr_percent, alone.tpr_percent);
  EXPECT_EQ(in_atlas.fpr_percent, alone.fpr_percent);
}

TEST(Aem, IsNotDisturbedByTurnsClustersAndCopies) {
  for (const SceneSpec& spec :
       {SceneSpec{Kind::turned, 200, 0.3}, SceneSpec{Kind::strong, 200, 0.2},
        SceneSpec{Kind::clusters, 200, 0.2}, SceneSpec{Kind::copy, 200, 0.35}}) {
    const Rates rates = mean_rates(spec, {5, 6, 7});
    EXPECT_GT(rates.tpr_percent, 99.0) << static_cast<int>(spec.kind);
    EXPECT_LT(rates.fpr_percent, 1.5) << static_cast<int>(spec.kind);
  }
}

TEST(Aem, UsesScalesAndAnglesWhereFewAreCorrect) {
  FilterBench with("filters/aem"), without("filters/aem", "{use_orientation: false}");
  int found = 0, found_without = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const LabelledMatches drawn = draw_scene({Kind::paper, 200, 0.05, 0.0, true}, seed);
    const auto right = [&](FilterBench& bench) {
      const auto mask = bench.run(drawn.matches).get<InlierMask>();
      return mask && rates_of(*mask, drawn.correct).fpr_percent < 50.0;
    };
    found += right(with);
    found_without += right(without);
  }
  EXPECT_GE(found, 5);
  EXPECT_LT(found_without, found);
}

TEST(Aem, IsNotSureWhereNothingIsCorrect) {
  FilterBench bench("filters/aem");
  for (const int count : {50, 200}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const PluginAnswer outcome = bench.run(draw_scene({Kind::paper, count, 0.0}, seed).matches);
      EXPECT_NE(outcome.status, WEFT_OK) << count << " matches, seed " << seed;
    }
  }
}

TEST(Aem, ScoresAreProbabilitiesThatTheThresholdCuts) {
  const LabelledMatches drawn = draw_scene({Kind::paper, 200, 0.5, 0.5}, 8);
  Rates before{0.0, 0.0};
  for (const double threshold : {0.0, 0.1, 0.9}) {
    FilterBench bench("filters/aem", "{min_probability: " + std::to_string(threshold) + "}");
    const InlierMask mask = bench.mask(drawn.matches);
    for (std::int64_t i = 0; i < 200; ++i) {
      ASSERT_EQ(mask.kept(i) != 0, mask.score(i) >= threshold) << i;
    }
    const Rates rates = rates_of(mask, drawn.correct);
    EXPECT_GE(rates.tpr_percent, before.tpr_percent) << threshold;
    EXPECT_GE(rates.fpr_percent, before.fpr_percent) << threshold;
    before = rates;
  }
  EXPECT_EQ(before.tpr_percent, 100.0);
}

TEST(Aem, HasNoResultWhereTheThresholdKeepsNothing) {
  const LabelledMatches drawn = draw_scene({Kind::paper, 200, 0.5, 0.5}, 8);
  const PluginAnswer outcome =
      FilterBench("filters/aem", "{min_probability: 1.0}").run(drawn.matches);
  EXPECT_EQ(outcome.status, WEFT_NO_RESULT);
  EXPECT_EQ(outcome.message, "none of 200 matches has the probability min_probability");
}

TEST(Aem, OwesWhatEveryFilterOwes) {
  for (const bool oriented : {false, true}) {
    expect_filter_contract("filters/aem",
                           draw_scene({Kind::turned, 300, 0.5, 0.5, oriented}, 9).matches);
  }
}

/// The surface and, with as many matches, a copy of it that is moved.
struct TwoSheets {
  Correspondences matches;
  std::vector<std::uint8_t> on_sheet, on_copy;
  Shape sheet;
};

TwoSheets two_sheets(int of_sheet, int of_copy) {
  const Template templ = make_template();
  Rng rng(12);
  const DevelopableSheet sheet = make_cylinder({}, 0.4, 0.3, {1.1, -0.09, -0.06, 0.0, 0.2, 0.2});
  const DevelopableSheet copy = make_cylinder({}, 0.5, 1.0, {1.1, 0.12, 0.08, 0.1, 0.0, 1.0});
  const auto drawn =
      draw_matches(templ, make_camera(), sheet, {of_sheet + of_copy, 1.0, 0.0, 2.0}, rng);
  TwoSheets both{drawn.matches, {}, {}, {}};
  const Eigen::Vector2d pitch = templ.m_per_px.matrix<1>();
  for (int i = 0; i < of_sheet + of_copy; ++i) {
    both.on_sheet.push_back(i < of_sheet ? 1 : 0);
    both.on_copy.push_back(i < of_sheet ? 0 : 1);
    if (i < of_sheet) continue;
    const Eigen::Vector2d at = both.matches.template_px.matrix<2>().row(i).transpose();
    both.matches.image_px.matrix<2>().row(i) =
        project(pinhole(make_camera()), copy.at(pitch.x() * at.x(), pitch.y() * at.y()));
  }
  both.sheet.vertices_m = make_array<double>(bent_vertices(templ, sheet));
  both.sheet.source = Array<std::uint8_t>({both.sheet.vertices_m.rows()}, 0);
  return both;
}

PluginAnswer run_after(FilterBench& bench, const Correspondences& matches, const Shape& previous) {
  return bench.plugin.process(0,
                              {input("correspondences", matches), input("template", bench.templ),
                               input("camera", make_camera()), input("previous.shape", previous)});
}

TEST(Aem, SaysThatACopyIsAsLikely) {
  FilterBench bench("filters/aem");
  const PluginAnswer equal = bench.run(two_sheets(100, 100).matches);
  EXPECT_EQ(equal.status, WEFT_DEGENERATE) << equal.message;
  EXPECT_LT(confidence_of(equal), 0.7);
  const TwoSheets larger = two_sheets(140, 60);
  const PluginAnswer outcome = bench.run(larger.matches);
  EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
  EXPECT_LT(rates_of(*outcome.get<InlierMask>(), larger.on_sheet).fpr_percent, 1.0);
}

TEST(Aem, PrefersThePreviousShapeToALikelierCopyAndSaysSo) {
  const TwoSheets sheets = two_sheets(60, 140);
  FilterBench bench("filters/aem");
  const PluginAnswer alone = bench.run(sheets.matches);
  EXPECT_LT(rates_of(*alone.get<InlierMask>(), sheets.on_copy).fpr_percent, 1.0);
  const PluginAnswer tracked = run_after(bench, sheets.matches, sheets.sheet);
  const auto mask = tracked.get<InlierMask>();
  EXPECT_EQ(tracked.status, WEFT_DEGENERATE);
  EXPECT_EQ(mask->diag.value("tracked", 0.0), 1.0);
  EXPECT_LT(confidence_of(tracked), 0.7);
  EXPECT_LT(rates_of(*mask, sheets.on_sheet).fpr_percent, 1.0);
  FilterBench off("filters/aem", "{track: false}");
  const auto without = run_after(off, sheets.matches, sheets.sheet).get<InlierMask>();
  EXPECT_EQ(without->diag.value("tracked", 1.0), 0.0);
}

TEST(Aem, FollowsThePreviousShapeWithFewMatchesAndLeavesItAfterACut) {
  const Template templ = make_template();
  Rng rng(13);
  const DevelopableSheet sheet = make_cylinder({}, 0.25, 0.4, {0.65, 0.01, 0.0, 0.1, 0.1, 0.1});
  Shape near, elsewhere;
  near.vertices_m = make_array<double>(
      bent_vertices(templ, make_cylinder({}, 0.27, 0.4, {0.65, 0.005, 0.0, 0.1, 0.08, 0.1})));
  elsewhere.vertices_m = make_array<double>(
      bent_vertices(templ, make_cylinder({}, 0.3, 0.4, {0.9, -0.1, 0.08, 0.1, 0.1, 2.1})));
  for (Shape* shape : {&near, &elsewhere}) {
    shape->source = Array<std::uint8_t>({shape->vertices_m.rows()}, 0);
  }
  FilterBench bench("filters/aem");
  const auto few = draw_matches(templ, make_camera(), sheet, {150, 0.1, 0.5, 2.0}, rng);
  const auto mask = run_after(bench, few.matches, near).get<InlierMask>();
  ASSERT_TRUE(mask);
  EXPECT_LT(rates_of(*mask, few.correct).fpr_percent, 20.0);
  EXPECT_GT(rates_of(*mask, few.correct).tpr_percent, 98.0);
  const auto many = draw_matches(templ, make_camera(), sheet, {300, 0.5, 0.5, 2.0}, rng);
  const auto after_cut = run_after(bench, many.matches, elsewhere).get<InlierMask>();
  EXPECT_EQ(after_cut->diag.value("tracked", 1.0), 0.0);
  EXPECT_LT(rates_of(*after_cut, many.correct).fpr_percent, 1.0);
}

TEST(Aem, IgnoresAPreviousShapeThatIsLost) {
  const TwoSheets sheets = two_sheets(100, 60);
  Shape lost = sheets.sheet;
  lost.state = static_cast<std::int32_t>(ShapeState::lost);
  FilterBench bench("filters/aem");
  const auto mask = run_after(bench, sheets.matches, lost).get<InlierMask>();
  EXPECT_EQ(mask->diag.value("tracked", 1.0), 0.0);
}

TEST(Aem, SaysWhereThereIsNoSheet) {
  FilterBench bench("filters/aem");
  EXPECT_EQ(bench.run(flat_matches({2, 1.0, 0.0, 2.0}, 14).matches).status, WEFT_NO_RESULT);
  const LabelledMatches drawn = flat_matches({60, 1.0, 0.0, 2.0}, 15);
  for (const bool in_image : {false, true}) {
    for (const double slope : {0.0, 0.4}) {
      LabelledMatches line = drawn;
      Array<double>& points = in_image ? line.matches.image_px : line.matches.template_px;
      for (std::int64_t i = 0; i < 60; ++i) points(i, 1) = 100.0 + slope * points(i, 0);
      const PluginAnswer outcome = bench.run(line.matches);
      EXPECT_EQ(outcome.status, WEFT_NO_RESULT) << in_image << " " << slope << outcome.message;
    }
  }
  LabelledMatches point = drawn;
  for (std::int64_t i = 0; i < 60; ++i)
    point.matches.image_px(i, 0) = point.matches.image_px(i, 1) = 7;
  EXPECT_EQ(bench.run(point.matches).status, WEFT_NO_RESULT);
  LabelledMatches mirrored = drawn;
  for (std::int64_t i = 0; i < 60; ++i) mirrored.matches.image_px(i, 0) *= -1.0;
  EXPECT_EQ(bench.run(mirrored.matches).status, WEFT_NO_RESULT);
}

TEST(Aem, KeepsAllMatchesWithoutNoiseAndNoneThatWasRejectedBefore) {
  LabelledMatches drawn = flat_matches({80, 1.0, 0.0, 2.0}, 16);
  drawn.matches.kept(3) = 0;
  drawn.matches.image_px(3, 0) = std::numeric_limits<double>::quiet_NaN();
  FilterBench bench("filters/aem");
  const InlierMask mask = bench.mask(drawn.matches);
  for (std::int64_t i = 0; i < 80; ++i) EXPECT_EQ(mask.kept(i), i == 3 ? 0 : 1) << i;
  drawn.matches.kept(3) = 1;
  const PluginAnswer outcome = bench.run(drawn.matches);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_NE(outcome.message.find("match 3 "), std::string::npos) << outcome.message;
}

TEST(Aem, DoesWithoutScalesThatAreNoNumbers) {
  LabelledMatches drawn = draw_scene({Kind::paper, 200, 0.5, 0.5, true}, 17);
  FilterBench plain("filters/aem", "{use_orientation: false}"), bench("filters/aem");
  drawn.matches.scale_ratio(5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(bench.mask(drawn.matches).score.matrix<1>(),
            plain.mask(drawn.matches).score.matrix<1>());
}

}  // namespace
}  // namespace weft::testing
