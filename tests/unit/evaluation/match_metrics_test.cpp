// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <numeric>
#include <weft/core/rng.hpp>
#include <weft/core/statistics.hpp>
#include <weft/evaluation/match_metrics.hpp>
#include <weft/evaluation/truth_map.hpp>
#include <weft/geometry/sheet_motion.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::evaluation {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

constexpr std::uint64_t kSeed = 4711;

Array<std::uint8_t> mask_of(const std::vector<int>& kept) {
  Array<std::uint8_t> mask({static_cast<std::int64_t>(kept.size())});
  std::copy(kept.begin(), kept.end(), mask.data());
  return mask;
}

const std::vector<int> kAll(10, 1);
// Three mismatches, of which two are rejected; seven correct ones, of which one is.
const std::vector<std::int8_t> kLabels{0, 0, 0, 1, 1, 1, 1, 1, 1, 1};
const std::vector<int> kVerdict{0, 0, 1, 0, 1, 1, 1, 1, 1, 1};

TEST(FilterRates, OfTenMatchesByHand) {
  const FilterCounts counts = count_filter(mask_of(kAll), mask_of(kVerdict), kLabels);
  const FilterMetrics rates = summarise_filter("filters", {counts});
  EXPECT_NEAR(rates.tpr_percent, 200.0 / 3, 1e-9);
  EXPECT_NEAR(rates.fpr_percent, 100.0 / 7, 1e-9);
  EXPECT_NEAR(rates.kept_percent, 70.0, 1e-9);
  EXPECT_NEAR(rates.precision_percent, 600.0 / 7, 1e-9);
  EXPECT_NEAR(rates.recall_percent, 600.0 / 7, 1e-9);
  EXPECT_NEAR(rates.f1_percent, 600.0 / 7, 1e-9);
  EXPECT_EQ(rates.frames, 1);
}

TEST(FilterRates, DoNotDependOnTheOrderOfTheMatches) {
  std::vector<std::size_t> order(10);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Rng rng(kSeed);
  rng.shuffle(order);
  std::vector<std::int8_t> labels;
  std::vector<int> verdict;
  for (const std::size_t i : order) {
    labels.push_back(kLabels[i]);
    verdict.push_back(kVerdict[i]);
  }
  const auto rates =
      summarise_filter("filters", {count_filter(mask_of(kAll), mask_of(verdict), labels)});
  EXPECT_NEAR(rates.tpr_percent, 200.0 / 3, 1e-9) << "seed " << kSeed;
  EXPECT_NEAR(rates.fpr_percent, 100.0 / 7, 1e-9) << "seed " << kSeed;
}

TEST(FilterRates, LeaveOutWhatEarlierFiltersRejectedAndWhatHasNoLabel) {
  std::vector<int> before = kAll;
  before[0] = 0;
  std::vector<std::int8_t> labels = kLabels;
  labels[9] = -1;
  const FilterCounts counts = count_filter(mask_of(before), mask_of(kVerdict), labels);
  EXPECT_EQ(counts.entered, 9);
  EXPECT_EQ(counts.kept, 7);
  EXPECT_EQ(counts.mismatches, 2);
  EXPECT_EQ(counts.rejected_wrong, 1);
  EXPECT_EQ(counts.correct, 6);
  EXPECT_EQ(counts.rejected_right, 1);
}

TEST(FilterRates, AverageOverTheFramesInWhichTheyAreDefined) {
  const std::vector<std::int8_t> right(10, 1), wrong(10, 0), unknown(10, -1);
  const std::vector<int> none(10, 0);
  const auto frame = [&](const auto& labels, const auto& verdict) {
    return count_filter(mask_of(kAll), mask_of(verdict), labels);
  };
  const auto rates = summarise_filter("filters", {frame(right, kAll), frame(wrong, none),
                                                  frame(unknown, kAll), frame(kLabels, kVerdict)});
  EXPECT_EQ(rates.frames, 3);
  EXPECT_EQ(rates.frames_without_mismatch, 1);
  EXPECT_EQ(rates.frames_without_correct, 1);
  EXPECT_EQ(rates.frames_without_kept, 1);
  EXPECT_EQ(rates.labelled, 30);
  EXPECT_NEAR(rates.tpr_percent, (100.0 + 200.0 / 3) / 2, 1e-9);
  EXPECT_NEAR(rates.fpr_percent, (0.0 + 100.0 / 7) / 2, 1e-9);
}

TEST(FilterRates, CountARightMatchThatIsNotKeptAgainstF1) {
  const std::vector<int> none(10, 0);
  const auto rates =
      summarise_filter("filters", {count_filter(mask_of(kAll), mask_of(kVerdict), kLabels),
                                   count_filter(mask_of(kAll), mask_of(none), kLabels)});
  EXPECT_NEAR(rates.f1_percent, (600.0 / 7 + 0.0) / 2, 1e-9);
  EXPECT_NEAR(rates.precision_percent, 600.0 / 7, 1e-9);
  EXPECT_EQ(rates.frames_without_kept, 1);
}

TEST(FilterRates, AreUnknownWithoutLabels) {
  const auto rates = summarise_filter("filters", {});
  EXPECT_TRUE(std::isnan(rates.tpr_percent));
  EXPECT_TRUE(std::isnan(rates.f1_percent));
}

/// A cylinder with truth on a grid, as a source with exact truth gives it.
struct Bent {
  testing::SheetSpec spec;
  Template templ = testing::make_template(spec);
  Camera camera = testing::make_camera();
  DevelopableSheet sheet = testing::make_cylinder(spec, 0.2, 0.4);

  GroundTruth truth(int columns, int rows) const {
    Points2 xy_m(columns * rows, 2);
    Points3 points_m(columns * rows, 3);
    for (int k = 0; k < columns * rows; ++k) {
      const double x = spec.width_m * (k % columns) / (columns - 1);
      const double y = spec.height_m * (k / columns) / (rows - 1);
      xy_m.row(k) << x, y;
      points_m.row(k) = sheet.at(x, y).transpose();
    }
    return {make_array<double>(xy_m), make_array<double>(points_m), "grid", ""};
  }
};

TEST(TruthMap, InterpolatesABentSheetToAFiftiethOfAPixel) {
  const Bent bent;
  const TruthMap map(bent.truth(25, 15));
  const Pinhole camera = testing::pinhole(bent.camera);
  Rng rng(kSeed);
  double worst_px = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d xy_m(bent.spec.width_m * rng.uniform(0.0, 1.0),
                               bent.spec.height_m * rng.uniform(0.0, 1.0));
    const auto found_m = map.at(xy_m);
    ASSERT_TRUE(found_m) << xy_m.transpose();
    const Eigen::Vector3d true_m = bent.sheet.at(xy_m.x(), xy_m.y());
    worst_px = std::max(worst_px, (project(camera, *found_m) - project(camera, true_m)).norm());
  }
  EXPECT_LT(worst_px, 0.02) << "seed " << kSeed;
  EXPECT_LT(map.leave_one_out_px(camera), 0.1);
}

TEST(TruthMap, InterpolatesTheMovingSheetOfTheDemo) {
  const SheetMotion motion;
  constexpr int kColumns = 15, kRows = 11;
  const Pinhole camera = testing::pinhole(testing::make_camera());
  Rng rng(kSeed);
  std::vector<double> errors_px;
  for (int frame = 0; frame < 60; ++frame) {
    const auto sheet = motion.at(frame / 15.0);
    ASSERT_TRUE(sheet);
    Points2 xy_m(kColumns * kRows, 2);
    Points3 points_m(kColumns * kRows, 3);
    for (int k = 0; k < kColumns * kRows; ++k) {
      xy_m.row(k) << motion.width_m * (k % kColumns) / (kColumns - 1),
          motion.height_m * (k / kColumns) / (kRows - 1);
      points_m.row(k) = sheet->at(xy_m(k, 0), xy_m(k, 1)).transpose();
    }
    const TruthMap map({make_array<double>(xy_m), make_array<double>(points_m), "grid", ""});
    for (int i = 0; i < 20; ++i) {
      const double x_m = rng.uniform(0.0, motion.width_m), y_m = rng.uniform(0.0, motion.height_m);
      const auto found_m = map.at({x_m, y_m});
      ASSERT_TRUE(found_m) << x_m << " " << y_m;
      errors_px.push_back(
          (project(camera, *found_m) - project(camera, sheet->at(x_m, y_m))).norm());
    }
  }
  std::cout << "seed " << kSeed << ": mean " << mean(errors_px) << " px, P95 "
            << percentile(errors_px, 95.0) << " px, worst " << percentile(errors_px, 100.0)
            << " px\n";
  EXPECT_LT(percentile(errors_px, 95.0), 0.03);
  EXPECT_LT(percentile(errors_px, 100.0), 0.12);
}

TEST(TruthMap, ReachesTheBorderOfTheTruth) {
  const Bent bent;
  const TruthMap map(bent.truth(25, 15));
  const Pinhole camera = testing::pinhole(bent.camera);
  for (int i = 0; i <= 40; ++i) {
    const double x_m = bent.spec.width_m * i / 40.0;
    const auto found_m = map.at({x_m, 0.0});
    ASSERT_TRUE(found_m) << i;
    const Eigen::Vector3d true_m = bent.sheet.at(x_m, 0.0);
    EXPECT_LT((project(camera, *found_m) - project(camera, true_m)).norm(), 0.1) << i;
  }
}

TEST(TruthMap, SaysNothingWhereTruthDoesNotSurroundThePoint) {
  const Bent bent;
  const TruthMap map(bent.truth(25, 15));
  EXPECT_FALSE(map.at({-0.01, 0.09}));
  EXPECT_FALSE(map.at({0.3, 0.2}));
  EXPECT_TRUE(map.at({0.0, 0.0}));  // a truth point itself
  EXPECT_FALSE(TruthMap(bent.truth(2, 1)).at({0.1, 0.0}));
  EXPECT_FALSE(TruthMap(bent.truth(25, 1)).at({0.1, 0.0001}));  // all on a line
  EXPECT_TRUE(std::isnan(TruthMap(GroundTruth{Array<double>({0, 2}), Array<double>({0, 3}), "", ""})
                             .leave_one_out_px(testing::pinhole(bent.camera))));
}

TEST(MatchLabels, AgreeWithHowTheMatchesWereDrawn) {
  const Bent bent;
  Rng rng(kSeed);
  testing::MatchSpec spec;
  spec.count = 500;
  spec.correct_rate = 0.6;
  spec.noise_px = 0.5;
  spec.label_distance_px = 3.0;
  const auto drawn = testing::draw_matches(bent.templ, bent.camera, bent.sheet, spec, rng);
  const Eigen::Vector2d m_per_px = bent.templ.m_per_px.matrix<1>();
  const auto labels = label_matches(drawn.matches, TruthMap(bent.truth(25, 15)), m_per_px,
                                    testing::pinhole(bent.camera), spec.label_distance_px);
  int unknown = 0, disagree = 0;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    unknown += labels[n] < 0;
    disagree += labels[n] >= 0 && labels[n] != static_cast<std::int8_t>(drawn.correct[n]);
  }
  EXPECT_LT(unknown, 25) << "seed " << kSeed;
  EXPECT_LE(disagree, 1) << "seed " << kSeed;
}

}  // namespace
}  // namespace weft::evaluation
