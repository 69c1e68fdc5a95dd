// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <weft/data/matrix.hpp>

#include "myneighbor_bench.hpp"

namespace {

using weft::Correspondences;
using weft::InlierMask;
using weft::Points2;
using weft::Rng;
using namespace weft::testing;

class MyNeighborSpecialCases : public MyNeighborTest {};

TEST_F(MyNeighborSpecialCases, JudgesMatchesAlikeWhenSomeAreRepeated) {
  const LabelledMatches drawn = bent_matches(300, 0.6, 7);
  std::vector<Eigen::Index> rows(300);
  std::iota(rows.begin(), rows.end(), 0);
  for (Eigen::Index i = 0; i < 300; i += 20) rows.push_back(i);
  Correspondences repeated = take(drawn.matches, rows);
  const auto before = *run(drawn.matches).get<InlierMask>();
  const auto after = *run(repeated).get<InlierMask>();
  const double threshold_px = before.diag.value("threshold_px", 0);
  for (Eigen::Index i = 0; i < 300; ++i) {
    if (std::abs(evidence(before, "distance_px")(i) - threshold_px) < 1.0) continue;
    EXPECT_EQ(after.kept(i), before.kept(i)) << i;
  }
  for (std::size_t i = 300; i < rows.size(); ++i) {
    EXPECT_EQ(after.kept(static_cast<Eigen::Index>(i)), after.kept(rows[i])) << i;
  }
}

TEST_F(MyNeighborSpecialCases, SurvivesManyMatchesToOneImagePoint) {
  LabelledMatches drawn = bent_matches(300, 0.7, 8);  // the first 90 are wrong
  for (Eigen::Index i = 0; i < 60; ++i) {
    drawn.matches.image_px.matrix<2>().row(i) = Eigen::RowVector2d(5.0, 5.0);
  }
  const auto mask = *run(drawn.matches).get<InlierMask>();
  for (Eigen::Index i = 0; i < 60; ++i) EXPECT_EQ(mask.kept(i), 0) << i;
  int lost = 0;
  for (Eigen::Index i = 90; i < 300; ++i) lost += mask.kept(i) == 0;
  EXPECT_LE(lost, 6);
}

TEST_F(MyNeighborSpecialCases, IgnoresMatchesThatAreRejectedOrLieOffTheTemplate) {
  const LabelledMatches drawn = bent_matches(200, 0.6, 10);
  Points2 points(210, 2), image(210, 2);
  points.topRows(200) = drawn.matches.template_px.matrix<2>();
  image.topRows(200) = drawn.matches.image_px.matrix<2>();
  for (int i = 0; i < 10; ++i) {
    points.row(200 + i) << (i < 5 ? -300.0 : 400.0), 30.0 * i;
    image.row(200 + i) << 300.0, 10.0 * i;
  }
  Correspondences more = make_matches(points, image);
  for (Eigen::Index i = 205; i < 210; ++i) more.kept(i) = 0;
  const auto mask = *run(more).get<InlierMask>();
  std::vector<int> expected = flags(*run(drawn.matches).get<InlierMask>());
  expected.resize(210, 0);
  EXPECT_EQ(flags(mask), expected);
  for (Eigen::Index i = 200; i < 210; ++i) EXPECT_EQ(mask.score(i), 0.0);
}

TEST_F(MyNeighborSpecialCases, JudgesMatchesJustOutsideTheMeshByItsContinuation) {
  Rng rng(11);
  Points2 points = uniform_points(100, rng);
  points.row(0) << -20.0, 300.0;
  points.row(1) << 975.0, 100.0;
  Points2 image = similar(points);
  image.row(1) += Eigen::RowVector2d(80.0, 80.0);
  const auto mask = *run(make_matches(points, image)).get<InlierMask>();
  EXPECT_EQ(mask.kept(0), 1);
  EXPECT_LT(evidence(mask, "distance_px")(0), 0.01);
  EXPECT_EQ(mask.kept(1), 0);
}

TEST_F(MyNeighborSpecialCases, HasNoResultForTooFewMatches) {
  Rng rng(14);
  const Points2 seven = uniform_points(7, rng), eight = uniform_points(8, rng);
  EXPECT_EQ(run(make_matches(seven, similar(seven))).status, WEFT_NO_RESULT);
  EXPECT_EQ(run(make_matches(eight, similar(eight))).status, WEFT_OK);
  EXPECT_EQ(run(make_matches(Points2(0, 2), Points2(0, 2))).status, WEFT_NO_RESULT);
  Correspondences rejected = make_matches(eight, similar(eight));
  rejected.kept(3) = 0;
  EXPECT_EQ(run(rejected).status, WEFT_NO_RESULT);
}

TEST_F(MyNeighborSpecialCases, HasNoResultForMatchesOnALine) {
  Rng rng(15);
  const Points2 points = uniform_points(40, rng);
  Points2 line(40, 2);
  for (int i = 0; i < 40; ++i) line.row(i) << 10.0 + 8.0 * i, 20.0 + 4.0 * i;
  const PluginAnswer in_template = run(make_matches(line, similar(points)));
  EXPECT_EQ(in_template.status, WEFT_NO_RESULT);
  EXPECT_NE(in_template.message.find("template"), std::string::npos) << in_template.message;
  const PluginAnswer in_image = run(make_matches(points, line));
  EXPECT_EQ(in_image.status, WEFT_NO_RESULT);
  EXPECT_NE(in_image.message.find("image"), std::string::npos) << in_image.message;
}

TEST_F(MyNeighborSpecialCases, RefusesIllegalMatches) {
  Rng rng(16);
  const Points2 points = uniform_points(40, rng);
  Correspondences matches = make_matches(points, similar(points));
  matches.image_px(7, 0) = std::nan("");
  EXPECT_EQ(run(matches).status, WEFT_ERROR);
  matches = make_matches(points, similar(points));
  matches.face(7) = 90;  // the template has 90 faces
  const PluginAnswer outcome = run(matches);
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_NE(outcome.message.find("match 7"), std::string::npos) << outcome.message;
}

TEST_F(MyNeighborSpecialCases, AnswersOrDeclinesWhenNothingIsRight) {
  for (const std::uint64_t seed : {17U, 18U, 19U}) {
    const PluginAnswer outcome = run(bent_matches(100, 0.0, seed).matches);
    EXPECT_NE(outcome.status, WEFT_ERROR) << outcome.message;
  }
}

TEST_F(MyNeighborSpecialCases, FlagsAWarpThatTurnsPartOfTheMeshOverAsDegenerate) {
  Rng rng(20);
  const Points2 points = uniform_points(400, rng);
  Points2 image = 0.5 * points;
  for (Eigen::Index i = 0; i < 400; ++i) {
    if (points(i, 0) > 600.0) image.row(i) << 600.0 - image(i, 0), image(i, 1) + 320.0;
  }
  const PluginAnswer outcome = run(make_matches(points, image));
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_EQ(outcome.get<InlierMask>()->diag.value("warp_suspicious", 0), 1.0);
}

TEST_F(MyNeighborSpecialCases, FlagsATinyObjectAsDegenerate) {
  Rng rng(21);
  const Points2 points = uniform_points(60, rng);
  PluginUnderTest filter("filters/myneighbor");
  const PluginAnswer outcome =
      filter.process(0, {input("correspondences", make_matches(points, 0.02 * points)),
                         input("template", kTemplate), input("camera", make_camera())});
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_NE(outcome.message.find("tiny"), std::string::npos) << outcome.message;
}

TEST_F(MyNeighborSpecialCases, NeedsMoreThanFiftySelectedMatchesInTheAuthorsMode) {
  Rng rng(22);
  const Points2 fifty = uniform_points(50, rng), more = uniform_points(51, rng);
  EXPECT_EQ(run(make_matches(fifty, similar(fifty)), "{mode: authors_code}").status,
            WEFT_NO_RESULT);
  const PluginAnswer outcome = run(make_matches(more, similar(more)), "{mode: authors_code}");
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto mask = *outcome.get<InlierMask>();
  EXPECT_NEAR(mask.diag.value("threshold_px", 0), 0.07 * mask.diag.value("l_s_px", 0), 1e-9);
}

TEST_F(MyNeighborSpecialCases, PutsMatchesOutsideTheMeshAtTheOriginInTheAuthorsMode) {
  Rng rng(23);
  Points2 points = uniform_points(100, rng);
  points.row(0) << -20.0, 300.0;
  const auto mask =
      *run(make_matches(points, similar(points)), "{mode: authors_code}").get<InlierMask>();
  EXPECT_EQ(mask.kept(0), 0);
  EXPECT_EQ(mask.kept(1), 1);
  EXPECT_NEAR(evidence(mask, "distance_px")(0), similar(points).row(0).norm(), 1e-9);
}

TEST_F(MyNeighborSpecialCases, KeepsTheMatchesOfTheLargerOfTwoCopies) {
  Rng rng(24);
  const Points2 points = uniform_points(300, rng);
  Points2 image = 0.4 * points;
  for (Eigen::Index i = 0; i < 60; ++i) image.row(i) += Eigen::RowVector2d(0.0, 250.0);
  const auto mask = *run(make_matches(points, image)).get<InlierMask>();
  const auto* kept = mask.kept.data();
  EXPECT_LE(std::count(kept, kept + 60, 1), 3);
  EXPECT_GE(std::count(kept + 60, kept + 300, 1), 228);
}

TEST_F(MyNeighborSpecialCases, TakesTheSmallestFactorsWhereFewAreSelected) {
  const auto mask =
      *run(bent_matches(100, 0.8, 25).matches, "{min_selected: 1000}").get<InlierMask>();
  EXPECT_EQ(mask.diag.value("step1_fallback", 0), 1.0);
  EXPECT_GE(mask.diag.value("step1_matches", 0), 20.0);
  EXPECT_GE(mask.diag.value("kept_matches", 0), 70.0);
}

TEST_F(MyNeighborSpecialCases, WeighsAllAlikeWhereNoNeighbourChanged) {
  Rng rng(26);
  const Points2 points = uniform_points(60, rng);
  const PluginAnswer outcome = run(make_matches(points, similar(points)), "{weighted_fit: true}");
  EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
  EXPECT_EQ(outcome.get<InlierMask>()->diag.value("kept_matches", 0), 60.0);
}

TEST_F(MyNeighborSpecialCases, HasNoResultWhereTheWarpIsAPointOrNotFinite) {
  Rng rng(27);
  const Points2 points = uniform_points(60, rng);
  const PluginAnswer point = run(make_matches(points, 1e-200 * points));
  EXPECT_EQ(point.status, WEFT_NO_RESULT);
  EXPECT_EQ(point.message, "the warp shrinks the template to a point");
  EXPECT_EQ(run(make_matches(points, 1e200 * points)).status, WEFT_NO_RESULT);
}

TEST_F(MyNeighborSpecialCases, HasNoResultWhereTheWarpHasNone) {
  Rng rng(28);
  const Points2 points = uniform_points(20, rng);
  const PluginAnswer outcome = run(make_matches(points, similar(points)),
                                   "{warp: {use: warps/bbs, params: {lambda_px2: 0, ridge: 0}}}");
  EXPECT_EQ(outcome.status, WEFT_NO_RESULT);
  EXPECT_EQ(outcome.message.find("step I: "), 0U) << outcome.message;
}

TEST_F(MyNeighborSpecialCases, HandsOnThatItsWarpIsDegenerate) {
  Rng rng(29);
  const Points2 points = uniform_points(20, rng);
  const PluginAnswer outcome =
      run(make_matches(points, similar(points)),
          "{warp: {use: warps/bbs, params: {lambda_px2: 1e-11, ridge: 0}}}");
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_EQ(outcome.message, "the matches hardly determine the warp");
}

}  // namespace
