// SPDX-License-Identifier: Apache-2.0
#include <numbers>
#include <weft/data/matrix.hpp>

#include "../local_smoothness.hpp"
#include "../robust_affine.hpp"
#include "../shrinking_warp.hpp"
#include "common/tests/filter_bench.hpp"

namespace weft::testing {
namespace {

constexpr double kWidthPx = 960.0, kHeightPx = 575.0;

/// Flat up to 0.35 of the width, then rolled away from the camera (parallel projection): from
/// `edge` on the surface is behind the roll.
struct RolledSheet {
  double flat_px = 0.35 * kWidthPx, edge_px = kWidthPx * 2.0 / 3.0;
  double radius_px = (edge_px - flat_px) / (0.5 * std::numbers::pi);

  Eigen::RowVector2d operator()(double u, double v) const {
    const double rolled = std::max(0.0, u - flat_px) / radius_px;
    const double x = std::min(u, flat_px) + radius_px * std::sin(rolled);
    return {50.0 + 0.5 * x, 60.0 + 0.5 * v};
  }
};

/// Matches on what the camera sees.
std::pair<Points2, Points2> seen_of(const RolledSheet& sheet, int count, std::uint64_t seed) {
  Rng rng(seed);
  Points2 p(count, 2), q(count, 2);
  for (int k = 0; k < count; ++k) {
    p.row(k) << rng.uniform(0.0, sheet.edge_px), rng.uniform(0.0, kHeightPx - 1.0);
    q.row(k) = sheet(p(k, 0), p(k, 1)) + 0.3 * Eigen::RowVector2d(rng.normal(), rng.normal());
  }
  return {p, q};
}

TEST(Pizarro, FindsMostMismatchesAndLosesFewMatches) {
  for (const std::uint64_t seed : {11U, 12U}) {
    FilterBench bench("filters/pizarro");
    const Rates half = bench.rates(bent_matches({500, 0.5, 0.5, 2.0}, 0.2, seed));
    EXPECT_GT(half.tpr_percent, 95.0) << "seed " << seed;
    EXPECT_LT(half.fpr_percent, 15.0) << "seed " << seed;
  }
}

TEST(Pizarro, KeepsMoreTheFurtherOffAMatchMayBe) {
  const LabelledMatches drawn = bent_matches({400, 0.7, 0.5, 2.0}, 0.2, 21);
  FilterBench strict("filters/pizarro", "{theta: 0.05}"), lax("filters/pizarro", "{theta: 0.6}");
  const Rates few = strict.rates(drawn), many = lax.rates(drawn);
  EXPECT_GT(few.fpr_percent, many.fpr_percent);
  EXPECT_GE(few.tpr_percent, many.tpr_percent);
}

TEST(Pizarro, KeepsTheContractOfFilters) {
  expect_filter_contract("filters/pizarro", bent_matches({150, 0.7, 0.5, 2.0}, 0.2, 31).matches);
}

TEST(Pizarro, JudgesFewMatchesByOneAffineMap) {
  FilterBench bench("filters/pizarro");
  LabelledMatches drawn = flat_matches({11, 1.0, 0.0, 2.0}, 41);
  drawn.matches.image_px(4, 0) += 90.0;
  const PluginAnswer outcome = bench.run(drawn.matches);
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE) << outcome.message;
  const auto mask = *outcome.get<InlierMask>();
  for (std::int64_t i = 0; i < 11; ++i) EXPECT_EQ(mask.kept(i), i == 4 ? 0 : 1) << i;
  EXPECT_EQ(bench.run(flat_matches({3, 1.0, 0.0, 2.0}, 42).matches).status, WEFT_NO_RESULT);
}

/// Four distant rows: the nearest ten of most matches lie in the row.
TEST(Pizarro, TakesMoreNeighboursWhereTheNearestLieOnALine) {
  LabelledMatches drawn = flat_matches({160, 1.0, 0.0, 2.0}, 46);
  for (std::int64_t i = 0; i < 160; ++i) {
    const double u = 20.0 * static_cast<double>(i % 40), v = 130.0 * static_cast<double>(i / 40);
    drawn.matches.template_px(i, 0) = u;
    drawn.matches.template_px(i, 1) = v;
    drawn.matches.image_px(i, 0) = 60.0 + 0.5 * u - 0.1 * v;
    drawn.matches.image_px(i, 1) = 40.0 + 0.1 * u + 0.6 * v;
  }
  drawn.matches.image_px(60, 1) += 80.0;
  FilterBench bench("filters/pizarro");
  const InlierMask mask = bench.mask(drawn.matches);
  for (std::int64_t i = 0; i < 160; ++i) EXPECT_EQ(mask.kept(i), i == 60 ? 0 : 1) << i;
}

TEST(Pizarro, HasNoResultWhereNeighboursPredictNothing) {
  LabelledMatches drawn = flat_matches({30, 1.0, 0.0, 2.0}, 45);
  for (std::int64_t i = 0; i < 30; ++i) drawn.matches.template_px(i, 1) = 100.0;  // on a line
  FilterBench bench("filters/pizarro");
  const PluginAnswer outcome = bench.run(drawn.matches);
  EXPECT_EQ(outcome.status, WEFT_NO_RESULT);
  EXPECT_NE(outcome.message.find("agrees"), std::string::npos) << outcome.message;
}

TEST(Pizarro, RejectsWhatLiesOnTheHiddenPart) {
  const RolledSheet sheet;
  const auto [p, q] = seen_of(sheet, 400, 51);
  LabelledMatches drawn = flat_matches({400, 1.0, 0.0, 2.0}, 52);
  for (std::int64_t i = 0; i < 400; ++i) {
    for (int x = 0; x < 2; ++x) {
      drawn.matches.template_px(i, x) = p(i, x);
      drawn.matches.image_px(i, x) = q(i, x);
    }
  }
  // A few that seem to be seen through the roll, at its edge, where smoothness predicts them.
  for (std::int64_t i = 0; i < 12; ++i) {
    const double u = sheet.edge_px + 15.0 * static_cast<double>(i + 3), v = 40.0 * (i + 1.0);
    drawn.matches.template_px(i, 0) = u;
    drawn.matches.template_px(i, 1) = v;
    const Eigen::RowVector2d edge = sheet(sheet.edge_px, v);
    for (int x = 0; x < 2; ++x) drawn.matches.image_px(i, x) = edge[x];
  }
  FilterBench aware("filters/pizarro", "{theta: 1}");
  FilterBench blind("filters/pizarro", "{theta: 1, self_occlusion: false}");
  const InlierMask with = aware.mask(drawn.matches), without = blind.mask(drawn.matches);
  int kept_with = 0, kept_without = 0;
  for (std::int64_t i = 0; i < 12; ++i) {
    kept_with += with.kept(i);
    kept_without += without.kept(i);
  }
  EXPECT_GT(kept_without, 6);
  EXPECT_LT(kept_with, 3);
}

/// Intersection over union of the cells that are found and those that are hidden.
template <class Hidden>
double overlap(const pizarro::HiddenMap& map, const Hidden& hidden) {
  int both = 0, either = 0;
  for (int r = 0; r < map.rows; ++r) {
    for (int c = 0; c < map.columns; ++c) {
      const double u = (c + 0.5) * map.cell_px - 0.5, v = (r + 0.5) * map.cell_px - 0.5;
      const bool truly = hidden(u, v), found = map.at(u, v);
      both += truly && found ? 1 : 0;
      either += truly || found ? 1 : 0;
    }
  }
  return static_cast<double>(both) / either;
}

/// A strip in the middle is behind the left part: the right one comes next to it in the image.
TEST(ShrinkingWarp, ContractsAFoldAndSaysWhereItIs) {
  Rng rng(71);
  Points2 p(600, 2), q(600, 2);
  for (int k = 0; k < 600; ++k) {
    const double s = rng.uniform(0.0, 700.0), u = s < 400.0 ? s : s + 260.0;
    const double v = rng.uniform(0.0, 574.0);
    p.row(k) << u, v;
    q.row(k) << 40.0 + 0.5 * (u < 500.0 ? u : u - 260.0), 60.0 + 0.5 * v;
  }
  const auto map = pizarro::hidden_by_itself(p, q, {kWidthPx, kHeightPx});
  ASSERT_TRUE(map);
  EXPECT_GT(map->least_det, -0.02) << "turned over";
  EXPECT_GT(overlap(*map, [](double u, double) { return u > 400.0 && u < 660.0; }), 0.7);
}

/// Rolled over three eighths of a cylinder that a perspective camera sees from six radii: convex,
/// so that what faces the camera is what is seen of it.
TEST(ShrinkingWarp, FindsTheThirdThatIsRolledBehindTheHorizon) {
  constexpr double kAngleRad = 0.75 * std::numbers::pi, kRadius = kWidthPx / kAngleRad;
  constexpr double kDistance = 6.0 * kRadius;
  const auto angle = [&](double u) { return kAngleRad * u / kWidthPx; };
  const auto hidden = [&](double u, double) { return std::cos(angle(u)) < kRadius / kDistance; };
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    Rng rng(seed);
    Points2 p(400, 2), q(400, 2);
    for (int k = 0; k < 400;) {
      p.row(k) << rng.uniform(0.0, kWidthPx), rng.uniform(0.0, kHeightPx);
      if (hidden(p(k, 0), p(k, 1))) continue;
      const double depth = kDistance - kRadius * std::cos(angle(p(k, 0)));
      const double scale = 0.5 * kDistance / depth;
      q.row(k) << 320.0 + scale * kRadius * std::sin(angle(p(k, 0))) + 0.5 * rng.normal(),
          240.0 + scale * (p(k, 1) - 0.5 * kHeightPx) + 0.5 * rng.normal();
      ++k;
    }
    const auto map = pizarro::hidden_by_itself(p, q, {kWidthPx, kHeightPx});
    ASSERT_TRUE(map);
    EXPECT_GT(overlap(*map, hidden), 0.7) << "seed " << seed;
  }
}

TEST(ShrinkingWarp, HidesNothingOfAFlatSheet) {
  const LabelledMatches drawn = flat_matches({300, 1.0, 0.0, 2.0}, 81);
  const Points2 p = drawn.matches.template_px.matrix<2>();
  const Points2 q = drawn.matches.image_px.matrix<2>();
  const auto map = pizarro::hidden_by_itself(p, q, {kWidthPx, kHeightPx});
  ASSERT_TRUE(map);
  EXPECT_EQ(map->share(), 0.0);
}

TEST(RobustAffine, FollowsTheMajority) {
  Rng rng(91);
  Points2 p(11, 2), q(11, 2);
  for (int k = 0; k < 11; ++k) {
    p.row(k) << rng.uniform(0.0, 100.0), rng.uniform(0.0, 100.0);
    q.row(k) << 3.0 + 0.5 * p(k, 0), 7.0 + 0.5 * p(k, 1) - 0.1 * p(k, 0);
  }
  for (int k = 0; k < 4; ++k) q.row(k) << rng.uniform(0.0, 100.0), rng.uniform(0.0, 100.0);
  const auto map = pizarro::least_median_affine(p, q, pizarro::spread_triples(11, 1000));
  ASSERT_TRUE(map);
  EXPECT_LT(((*map)(p.row(9)) - q.row(9)).norm(), 1e-9);
  EXPECT_EQ(pizarro::spread_triples(11, 1000).size(), 165U);
  EXPECT_EQ(pizarro::spread_triples(10, 12).size(), 12U);
  EXPECT_FALSE(pizarro::least_median_affine(Points2::Constant(5, 2, 1.0), Points2::Zero(5, 2),
                                            pizarro::spread_triples(5, 99)));
}

}  // namespace
}  // namespace weft::testing
