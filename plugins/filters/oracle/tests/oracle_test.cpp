// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {
namespace {

constexpr std::uint64_t kSeed = 31;

/// Matches on a bent mesh, whose truth is that mesh.
class OracleTest : public ::testing::Test {
 protected:
  OracleTest() {
    const Points3 vertices_m = bent_vertices(templ_, make_cylinder({}, 0.2, 0.4));
    Rng rng(kSeed);
    drawn_ = draw_matches(templ_, make_camera(), vertices_m, {300, 0.6, 0.5, 2.0}, rng);
    truth_.template_xy_m = make_array<double>(templ_.vertices_m.matrix<3>().leftCols<2>());
    truth_.points_m = make_array<double>(vertices_m);
    truth_.faces = templ_.faces;
    truth_.kind = "mesh";
  }

  PluginAnswer run(const std::string& params = "{}") {
    oracle_.emplace("filters/oracle", params);
    return oracle_->process(0, {input("correspondences", drawn_.matches), input("template", templ_),
                                input("camera", make_camera()), input("ground_truth", truth_)});
  }

  std::vector<std::uint8_t> kept(const std::string& params = "{}") {
    const auto mask = run(params).get<InlierMask>();
    return {mask->kept.data(), mask->kept.data() + mask->kept.rows()};
  }

  Template templ_ = make_template();
  LabelledMatches drawn_;
  GroundTruth truth_;
  std::optional<PluginUnderTest> oracle_;
};

TEST_F(OracleTest, KeepsTheCorrectMatchesAndNoOthers) {
  EXPECT_EQ(kept(), drawn_.correct) << "seed " << kSeed;
  const auto mask = *run().get<InlierMask>();
  EXPECT_EQ(mask.diag.value("correct_matches", -1) + mask.diag.value("mismatches", -1), 300.0);
  EXPECT_EQ(mask.diag.value("unknown_matches", -1), 0.0);
  EXPECT_EQ(mask.score(0), static_cast<double>(drawn_.correct[0]));
}

TEST_F(OracleTest, KeepsMoreTheLargerTheToleranceIs) {
  const auto narrow = kept("{tolerance_px: 0.5}"), wide = kept("{tolerance_px: 5.0}");
  int more = 0;
  for (std::size_t n = 0; n < narrow.size(); ++n) {
    EXPECT_LE(narrow[n], wide[n]) << n;
    more += wide[n] - narrow[n];
  }
  EXPECT_GT(more, 30);
}

TEST_F(OracleTest, RejectsMatchesOfHiddenPoints) {
  truth_.visible = Array<std::uint8_t>({truth_.count()}, 0);
  for (const std::uint8_t each : kept()) EXPECT_EQ(each, 0);
}

TEST_F(OracleTest, JudgesTheSourcesOwnMatchesByTheirTruth) {
  Points2 own_px = drawn_.true_px;
  own_px.row(299).setConstant(std::numeric_limits<double>::quiet_NaN());
  own_px.row(298).array() += 10.0;
  truth_.match_xy_px = make_array<double>(own_px);
  EXPECT_EQ(drawn_.correct[298] + drawn_.correct[299], 2);
  const auto mask = *run().get<InlierMask>();
  EXPECT_EQ(mask.kept(297), drawn_.correct[297]);
  EXPECT_EQ(mask.kept(298), 0);
  EXPECT_EQ(mask.kept(299), 0);
  EXPECT_EQ(mask.score(299), 0.5);
  EXPECT_EQ(kept("{keep_unknown: true}")[299], 1);
}

TEST_F(OracleTest, KnowsNothingWithoutPointsOrScale) {
  truth_ = {Array<double>({0, 2}, 0.0), Array<double>({0, 3}, 0.0), "none", ""};
  const auto mask = *run().get<InlierMask>();
  EXPECT_EQ(mask.diag.value("unknown_matches", -1), 300.0);
  for (const std::uint8_t each : kept("{keep_unknown: true}")) EXPECT_EQ(each, 1);
}

TEST_F(OracleTest, GivesNoResultWhereNoMatchIsLeft) {
  std::fill_n(drawn_.matches.kept.data(), 300, std::uint8_t{0});
  EXPECT_EQ(run().status, WEFT_NO_RESULT);
  Rng rng(kSeed);
  drawn_ = draw_matches(templ_, make_camera(), truth_.points_m.matrix<3>(), {0}, rng);
  const PluginAnswer outcome = run();
  EXPECT_EQ(outcome.status, WEFT_NO_RESULT);
  EXPECT_EQ(outcome.message, "no match is left to judge: 0 of 0");
}

TEST_F(OracleTest, FlagsAMaskThatKeepsNothing) {
  truth_.visible = Array<std::uint8_t>({truth_.count()}, 0);
  EXPECT_EQ(run().status, WEFT_DEGENERATE);
}

TEST_F(OracleTest, LeavesRejectedWhatAnEarlierFilterRejected) {
  for (std::int64_t n = 0; n < 300; n += 2) drawn_.matches.kept(n) = 0;
  const auto now = kept();
  for (std::size_t n = 0; n < now.size(); ++n) {
    EXPECT_EQ(now[n], n % 2 == 0 ? 0 : drawn_.correct[n]) << n;
  }
}

TEST_F(OracleTest, NamesAFaceThatTheTruthHasNoPointsFor) {
  truth_.faces = make_array<std::int32_t>(templ_.faces.matrix<3>());
  truth_.faces(4, 0) = 60;
  const PluginAnswer outcome = run();
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_NE(outcome.message.find("the faces of the truth: face 4"), std::string::npos)
      << outcome.message;
}

}  // namespace
}  // namespace weft::testing
