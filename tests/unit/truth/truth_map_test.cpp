// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/generators/sheet_motion.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/testing/synthetic.hpp>
#include <weft/truth/match_labels.hpp>

namespace weft {
namespace {

constexpr std::uint64_t kMapSeed = 4711;

TruthMap map_of(const GroundTruth& truth) {
  auto map = TruthMap::create(truth);
  if (!map) throw std::invalid_argument(map.error().message);
  return *std::move(map);
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
  const TruthMap map = map_of(bent.truth(25, 15));
  const Pinhole camera = testing::pinhole(bent.camera);
  Rng rng(kMapSeed);
  double worst_px = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d xy_m(bent.spec.width_m * rng.uniform(0.0, 1.0),
                               bent.spec.height_m * rng.uniform(0.0, 1.0));
    const auto found = map.at(xy_m);
    ASSERT_TRUE(found) << xy_m.transpose();
    const Eigen::Vector3d true_m = bent.sheet.at(xy_m.x(), xy_m.y());
    worst_px =
        std::max(worst_px, (project(camera, found->point_m) - project(camera, true_m)).norm());
  }
  EXPECT_LT(worst_px, 0.02) << "seed " << kMapSeed;
  EXPECT_LT(map.leave_one_out_px(camera), 0.1);
}

TEST(TruthMap, InterpolatesTheMovingSheetOfTheDemo) {
  const SheetMotion motion;
  constexpr int kColumns = 15, kRows = 11;
  const Pinhole camera = testing::pinhole(testing::make_camera());
  Rng rng(kMapSeed);
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
    const TruthMap map =
        map_of({make_array<double>(xy_m), make_array<double>(points_m), "grid", ""});
    for (int i = 0; i < 20; ++i) {
      const double x_m = rng.uniform(0.0, motion.width_m), y_m = rng.uniform(0.0, motion.height_m);
      const auto found = map.at({x_m, y_m});
      ASSERT_TRUE(found) << x_m << " " << y_m;
      errors_px.push_back(
          (project(camera, found->point_m) - project(camera, sheet->at(x_m, y_m))).norm());
    }
  }
  std::cout << "seed " << kMapSeed << ": mean " << mean(errors_px) << " px, P95 "
            << percentile(errors_px, 95.0) << " px, worst " << percentile(errors_px, 100.0)
            << " px\n";
  EXPECT_LT(percentile(errors_px, 95.0), 0.03);
  EXPECT_LT(percentile(errors_px, 100.0), 0.12);
}

TEST(TruthMap, ReachesTheBorderOfTheTruth) {
  const Bent bent;
  const TruthMap map = map_of(bent.truth(25, 15));
  const Pinhole camera = testing::pinhole(bent.camera);
  for (int i = 0; i <= 40; ++i) {
    const double x_m = bent.spec.width_m * i / 40.0;
    const auto found = map.at({x_m, 0.0});
    ASSERT_TRUE(found) << i;
    const Eigen::Vector3d true_m = bent.sheet.at(x_m, 0.0);
    EXPECT_LT((project(camera, found->point_m) - project(camera, true_m)).norm(), 0.1) << i;
  }
}

TEST(TruthMap, SaysNothingWhereTruthDoesNotSurroundThePoint) {
  const Bent bent;
  const TruthMap map = map_of(bent.truth(25, 15));
  EXPECT_FALSE(map.at({-0.01, 0.09}));
  EXPECT_FALSE(map.at({0.3, 0.2}));
  EXPECT_TRUE(map.at({0.0, 0.0}));  // a truth point itself
  EXPECT_FALSE(map_of(bent.truth(2, 1)).at({0.1, 0.0}));
  EXPECT_FALSE(map_of(bent.truth(25, 1)).at({0.1, 0.0001}));  // all on a line
  EXPECT_TRUE(
      std::isnan(map_of(GroundTruth{Array<double>({0, 2}, 0.0), Array<double>({0, 3}, 0.0), "", ""})
                     .leave_one_out_px(testing::pinhole(bent.camera))));
}

TEST(MatchLabels, AgreeWithHowTheMatchesWereDrawn) {
  const Bent bent;
  Rng rng(kMapSeed);
  testing::MatchSpec spec;
  spec.count = 500;
  spec.correct_rate = 0.6;
  spec.noise_px = 0.5;
  spec.label_distance_px = 3.0;
  const auto drawn = testing::draw_matches(bent.templ, bent.camera, bent.sheet, spec, rng);
  const auto labels = label_matches(drawn.matches, map_of(bent.truth(25, 15)), bent.templ,
                                    testing::pinhole(bent.camera), spec.label_distance_px);
  int unknown = 0, disagree = 0;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    unknown += labels[n] < 0;
    disagree += labels[n] >= 0 && labels[n] != static_cast<std::int8_t>(drawn.correct[n]);
  }
  EXPECT_LT(unknown, 25) << "seed " << kMapSeed;
  EXPECT_LE(disagree, 1) << "seed " << kMapSeed;
}

/// The cylinder's truth as a surface, on which the points with x > `seen_to_m` are hidden.
GroundTruth surface_of(const Bent& bent, int columns, int rows, double seen_to_m) {
  GroundTruth truth = bent.truth(columns, rows);
  truth.faces = make_array<std::int32_t>(*rectangular_grid_faces(columns, rows));
  truth.visible = Array<std::uint8_t>({truth.count()}, 0);
  for (std::int64_t i = 0; i < truth.count(); ++i) {
    truth.visible(i) = truth.template_xy_m(i, 0) <= seen_to_m ? 1 : 0;
  }
  return truth;
}

TEST(TruthMap, InterpolatesASurfaceOnItsFacesExactly) {
  const Bent bent;
  const GroundTruth truth = surface_of(bent, 7, 5, 1.0);
  const TruthMap map = map_of(truth);
  const Points3 points_m = truth.points_m.matrix<3>();
  const Points2 xy_m = truth.template_xy_m.matrix<2>();
  for (Eigen::Index f = 0; f < truth.faces.rows(); ++f) {
    const Eigen::Vector3d weights(0.2, 0.3, 0.5);
    const auto found =
        map.at(interpolate(xy_m, truth.faces.matrix<3>(), static_cast<int>(f), weights));
    ASSERT_TRUE(found) << f;
    const Eigen::Vector3d true_m =
        interpolate(points_m, truth.faces.matrix<3>(), static_cast<int>(f), weights);
    EXPECT_LT((found->point_m - true_m).norm(), 1e-12) << f;
    EXPECT_FALSE(found->hidden);
  }
  EXPECT_FALSE(map.at({0.5, 0.5}));
  EXPECT_TRUE(std::isnan(map.leave_one_out_px(testing::pinhole(bent.camera))));
}

TEST(TruthMap, CallsAPointHiddenWhereNoCornerOfItsFaceIsSeen) {
  const Bent bent;
  const TruthMap map = map_of(surface_of(bent, 11, 5, 0.5 * bent.spec.width_m + 1e-9));
  const double cell_m = bent.spec.width_m / 10;
  EXPECT_FALSE(map.at({4.5 * cell_m, 0.07})->hidden);
  EXPECT_FALSE(map.at({5.5 * cell_m, 0.07})->hidden);  // one side of its cell is seen
  EXPECT_TRUE(map.at({6.5 * cell_m, 0.07})->hidden);
}

TEST(TruthMap, RefusesFacesThatAreNoMeshOverThePoints) {
  const Bent bent;
  GroundTruth truth = surface_of(bent, 7, 5, 1.0);
  Array<std::int32_t> faces = make_array<std::int32_t>(truth.faces.matrix<3>());
  faces(2, 1) = 35;
  truth.faces = faces;
  const auto map = TruthMap::create(truth);
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, Errc::invalid_data);
  EXPECT_EQ(map.error().message.rfind("the faces of the truth: face 2", 0), 0U)
      << map.error().message;
}

TEST(MatchLabels, CallAMatchOfAHiddenPointAMismatch) {
  const Bent bent;
  const double seen_to_m = 0.5 * bent.spec.width_m;
  Rng rng(kMapSeed);
  const auto drawn = testing::draw_matches(bent.templ, bent.camera, bent.sheet, {400}, rng);
  const auto labels = label_matches(drawn.matches, map_of(surface_of(bent, 61, 37, seen_to_m)),
                                    bent.templ, testing::pinhole(bent.camera), 2.0);
  const double cell_m = bent.spec.width_m / 60;
  int hidden = 0;
  for (std::int64_t n = 0; n < drawn.matches.count(); ++n) {
    const double beyond_m = drawn.matches.template_px(n, 0) * bent.templ.m_per_px(0) - seen_to_m;
    if (std::abs(beyond_m) < 2.0 * cell_m) continue;
    EXPECT_EQ(labels[to_index(n)], beyond_m > 0.0 ? kMismatch : kCorrectMatch) << n;
    hidden += beyond_m > 0.0;
  }
  EXPECT_GT(hidden, 100) << "seed " << kMapSeed;
}

TEST(MatchLabels, FollowTheSourcesOwnTruthForItsOwnMatchesOnly) {
  const Bent bent;
  Rng rng(kMapSeed);
  auto drawn = testing::draw_matches(bent.templ, bent.camera, bent.sheet, {3}, rng);
  GroundTruth truth = bent.truth(25, 15);
  Points2 own_px = drawn.true_px;
  own_px.row(1).array() += 40.0;
  own_px.row(2).setConstant(std::numeric_limits<double>::quiet_NaN());
  truth.match_xy_px = make_array<double>(own_px);
  const auto labels = [&] {
    return label_matches(drawn.matches, map_of(truth), bent.templ, testing::pinhole(bent.camera),
                         2.0);
  };
  EXPECT_EQ(labels(), (std::vector<std::int8_t>{1, 0, -1}));
  drawn.matches.image_keypoint = Array<std::int32_t>({3}, 0);  // a matcher made these
  EXPECT_EQ(labels(), (std::vector<std::int8_t>{1, 1, 1}));
}

TEST(MatchLabels, AreThoseThatTheSourceGaveWhereItKnowsNoTrueImage) {
  const Bent bent;
  Rng rng(kMapSeed);
  auto drawn = testing::draw_matches(bent.templ, bent.camera, bent.sheet, {4}, rng);
  GroundTruth truth{Array<double>({0, 2}, 0.0), Array<double>({0, 3}, 0.0), "labels", ""};
  truth.match_label = Array<std::int8_t>({4}, 0);
  const std::int8_t given[] = {0, 1, -1, 1};
  std::copy_n(given, 4, truth.match_label.data());
  const auto labels = [&] {
    return label_matches(drawn.matches, map_of(truth), bent.templ, testing::pinhole(bent.camera),
                         2.0);
  };
  EXPECT_EQ(labels(), (std::vector<std::int8_t>{0, 1, -1, 1}));
  Points2 true_px = Points2::Constant(4, 2, std::numeric_limits<double>::quiet_NaN());
  true_px.row(0) = drawn.matches.image_px.matrix<2>().row(0);
  truth.match_xy_px = make_array<double>(true_px);
  EXPECT_EQ(labels(), (std::vector<std::int8_t>{1, 1, -1, 1})) << "a true image says more";
  drawn.matches.image_keypoint = Array<std::int32_t>({4}, 0);  // a matcher made these
  EXPECT_EQ(labels(), std::vector<std::int8_t>(4, kUnknownMatch));
}

TEST(MatchLabels, AreUnknownForATemplateWithoutScale) {
  const Bent bent;
  Rng rng(kMapSeed);
  const auto drawn = testing::draw_matches(bent.templ, bent.camera, bent.sheet, {5}, rng);
  Template templ = bent.templ;
  templ.m_per_px = {};
  EXPECT_EQ(label_matches(drawn.matches, map_of(bent.truth(25, 15)), templ,
                          testing::pinhole(bent.camera), 2.0),
            std::vector<std::int8_t>(5, kUnknownMatch));
}

}  // namespace
}  // namespace weft
