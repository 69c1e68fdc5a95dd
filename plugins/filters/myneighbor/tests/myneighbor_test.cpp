// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "myneighbor_bench.hpp"
#include "published_rates.hpp"

namespace {

using weft::Correspondences;
using weft::InlierMask;
using weft::Points2;
using weft::Rng;
using namespace weft::testing;

class MyNeighbor : public MyNeighborTest {};

TEST_F(MyNeighbor, KeepsAllMatchesOfASimilarity) {
  Rng rng(1);
  const Points2 points = uniform_points(300, rng);
  const PluginAnswer outcome = run(make_matches(points, similar(points)));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto mask = *outcome.get<InlierMask>();
  for (int i = 0; i < 300; ++i) {
    EXPECT_EQ(mask.kept(i), 1) << i;
    EXPECT_GT(mask.score(i), 0.99) << i;
    EXPECT_EQ(evidence(mask, "mismatch_factor_percent")(i), 0.0) << i;
    EXPECT_EQ(evidence(mask, "stage")(i), 2.0) << i;
  }
  EXPECT_EQ(mask.diag.value("kept_matches", 0), 300.0);
}

TEST_F(MyNeighbor, AnswersForFiftyMatches) {
  const LabelledMatches drawn = bent_matches(50, 0.7, 2);
  const PluginAnswer outcome = run(drawn.matches);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto mask = *outcome.get<InlierMask>();
  int agreed = 0;
  for (int i = 0; i < 50; ++i) agreed += mask.kept(i) == drawn.correct[weft::to_index(i)];
  EXPECT_GE(agreed, 45);
}

TEST_F(MyNeighbor, RejectsTheOneMatchThatIsDisplaced) {
  Rng rng(3);
  const Points2 points = uniform_points(200, rng);
  Points2 image = similar(points);
  image.row(60) += Eigen::RowVector2d(70.0, -50.0);
  const auto mask = *run(make_matches(points, image)).get<InlierMask>();
  for (int i = 0; i < 200; ++i) EXPECT_EQ(mask.kept(i), i == 60 ? 0 : 1) << i;
  EXPECT_LT(mask.score(60), 0.5);
}

TEST_F(MyNeighbor, DoesNotDependOnTheOrderOfMatches) {
  const LabelledMatches drawn = bent_matches(300, 0.5, 4);
  std::vector<Eigen::Index> order(300);
  std::iota(order.begin(), order.end(), 0);
  Rng rng(5);
  rng.shuffle(order);
  const auto first = *run(drawn.matches).get<InlierMask>();
  const auto second = *run(take(drawn.matches, order)).get<InlierMask>();
  for (std::size_t i = 0; i < order.size(); ++i) {
    EXPECT_EQ(second.kept(static_cast<Eigen::Index>(i)), first.kept(order[i])) << i;
  }
}

TEST_F(MyNeighbor, DoesNotChangeUnderASimilarityOfTheImage) {
  const LabelledMatches drawn = bent_matches(300, 0.5, 6);
  const Points2 image = drawn.matches.image_px.matrix<2>();
  const auto first = *run(drawn.matches).get<InlierMask>();
  const auto second =
      *run(make_matches(drawn.matches.template_px.matrix<2>(), similar(image))).get<InlierMask>();
  EXPECT_EQ(flags(first), flags(second));
  EXPECT_NEAR(second.diag.value("l_s_px", 0) / first.diag.value("l_s_px", 0), std::sqrt(0.29),
              1e-6);
}

TEST_F(MyNeighbor, KeepsMoreTheLargerAlphaIs) {
  const LabelledMatches drawn = bent_matches(200, 0.4, 9);
  std::vector<int> smaller(200, 0);
  for (const char* alpha : {"0", "0.02", "0.07", "0.15", "0.3", "1"}) {
    const auto mask =
        *run(drawn.matches, std::string("{alpha_s: ") + alpha + "}").get<InlierMask>();
    const std::vector<int> kept = flags(mask);
    for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_GE(kept[i], smaller[i]) << alpha;
    if (std::string(alpha) == "0") {
      EXPECT_EQ(kept, smaller);
    }
    smaller = kept;
  }
  EXPECT_GT(std::accumulate(smaller.begin(), smaller.end(), 0), 100);
}

TEST_F(MyNeighbor, KeepsWhatItsLastStepLeaves) {
  const LabelledMatches drawn = bent_matches(200, 0.5, 14);
  const auto full = *run(drawn.matches).get<InlierMask>();
  const auto step1 = *run(drawn.matches, "{steps: 1}").get<InlierMask>();
  const auto step2 = *run(drawn.matches, "{steps: 2}").get<InlierMask>();
  for (int i = 0; i < 200; ++i) {
    const double stage = evidence(full, "stage")(i);
    EXPECT_EQ(step1.kept(i), stage >= 1.0 ? 1 : 0) << i;
    EXPECT_EQ(step2.kept(i), stage >= 2.0 ? 1 : 0) << i;
    EXPECT_NEAR(100.0 * (1.0 - step1.score(i)), evidence(full, "mismatch_factor_percent")(i), 1e-9);
  }
  EXPECT_NE(flags(step1), flags(step2));
  EXPECT_NE(flags(step2), flags(full));
}

TEST_F(MyNeighbor, GivesTheSameAnswerFreshAndWarm) {
  PluginUnderTest warm("filters/myneighbor", "{passes: 2, weighted_fit: true}");
  ASSERT_EQ(run_on(warm, bent_matches(400, 0.8, 12).matches).status, WEFT_OK);
  ASSERT_EQ(run_on(warm, bent_matches(5, 1.0, 12).matches).status, WEFT_NO_RESULT);
  PluginUnderTest fresh("filters/myneighbor", "{passes: 2, weighted_fit: true}");
  const LabelledMatches drawn = bent_matches(150, 0.5, 13);
  const auto first = *run_on(warm, drawn.matches).get<InlierMask>();
  const auto second = *run_on(fresh, drawn.matches).get<InlierMask>();
  EXPECT_EQ(first.score.matrix<1>(), second.score.matrix<1>());
}

TEST_F(MyNeighbor, FindsTheRatesOfThePublishedExperiment) {
  constexpr std::uint64_t kSeed = 24;
  PluginUnderTest filter("filters/myneighbor");
  const auto shapes = draw_shapes(25, kSeed);
  for (const std::size_t row : {std::size_t{0}, std::size_t{4}}) {
    const PublishedRates& expected = kPublishedRates[row];
    SCOPED_TRACE(expected.matches);
    const MeasuredRates measured =
        measure_rates(filter, shapes, expected.matches, expected.correct_rate, kSeed + 1);
    EXPECT_EQ(measured.failures, 0);
    EXPECT_NEAR(measured.true_positive, expected.true_positive, 3.0);
    EXPECT_NEAR(measured.false_positive, expected.false_positive, 3.0);
  }
}

TEST_F(MyNeighbor, RejectsFewerCorrectMatchesInASecondPassWhereMostAreWrong) {
  constexpr std::uint64_t kSeed = 25;
  PluginUnderTest once("filters/myneighbor");
  PluginUnderTest twice("filters/myneighbor", "{passes: 2}");
  const auto shapes = draw_shapes(20, kSeed);
  const MeasuredRates first = measure_rates(once, shapes, 200, 0.3, kSeed);
  const MeasuredRates second = measure_rates(twice, shapes, 200, 0.3, kSeed);
  EXPECT_LT(second.false_positive, 0.5 * first.false_positive);
  EXPECT_GT(second.true_positive, first.true_positive - 1.0);
}

TEST_F(MyNeighbor, KeepsWhatFitsASmoothSheetWithRobustRefits) {
  Rng rng(26);
  const weft::DevelopableSheet sheet = make_cylinder({}, 0.15, 0.4);
  const LabelledMatches drawn =
      draw_matches(kTemplate, make_camera(), sheet, {1000, 0.6, 0.5, 3.0}, rng);
  const auto mask = *run(drawn.matches, "{refinement: irls}").get<InlierMask>();
  int missed = 0, lost = 0;
  for (Eigen::Index i = 0; i < 1000; ++i) {
    const bool correct = drawn.correct[weft::to_index(i)] != 0;
    missed += !correct && mask.kept(i) != 0;
    lost += correct && mask.kept(i) == 0;
  }
  EXPECT_LE(missed, 4);
  EXPECT_LE(lost, 6);
  EXPECT_EQ(mask.diag.value("threshold_px", 0), 4.0);
}

}  // namespace
