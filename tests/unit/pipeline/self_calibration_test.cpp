// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/self_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <weft/data/matrix.hpp>

#include "bent_sheets.hpp"

namespace weft {
namespace {

using testing::make_camera;
using testing::PoseSpec;
using testing::SeenSheet;

class SelfCalibrationTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kSeed = 2031;

  SelfCalibrationTest() { std::cout << "seed " << kSeed << "\n"; }

  SelfCalibration calibration() const { return *SelfCalibration::of(templ_); }

  /// The deviation that follows from six bent surfaces that `real_` saw.
  CameraDeviation deviation_from(const Camera& given, double k1 = 0.0) {
    SelfCalibration calibration = this->calibration();
    CameraEvidence sum;
    for (int turn = 0; turn < 6; ++turn) {
      const SeenSheet seen = testing::see_bent_sheet(templ_, real_, given, k1, turn, rng_);
      const auto evidence = calibration.look(given, seen.vertices_m, seen.matches);
      EXPECT_TRUE(evidence) << "turn " << turn;
      if (evidence) sum.add(*evidence);
    }
    return CameraDeviation::of(sum);
  }

  /// `truth` is focal, aspect, lens, centre x and y; the template is exact.
  static void expect_near(const CameraDeviation& found, const std::array<double, 5>& parts) {
    PartVector truth = PartVector::Zero();
    std::copy(parts.begin(), parts.end(), truth.data());
    const PartVector stds = found.stds();
    const double tolerance[] = {0.015, 0.003, 0.02, 0.015, 0.015, 0.005, 0.005, 0.005};
    for (int k = 0; k < kParts; ++k) {
      EXPECT_NEAR(found.mean(k), truth(k), tolerance[k]) << "of part " << k;
      EXPECT_NEAR(found.mean(k), truth(k), 4.0 * stds(k)) << "of part " << k;
      EXPECT_LT(stds(k), 0.05) << "of part " << k;
    }
  }

  Template templ_ = testing::make_template(testing::kBentSpec);
  Camera real_ = make_camera();
  Rng rng_{kSeed};
};

TEST_F(SelfCalibrationTest, ConfirmsACameraThatIsRight) { expect_near(deviation_from(real_), {}); }

TEST_F(SelfCalibrationTest, FindsTheFocalLengthThatSheetsWereSeenWith) {
  for (const double wrong : {0.65, 0.9, 1.2, 1.6}) {
    Camera given = real_;
    given.fx *= wrong;
    given.fy *= wrong;
    SCOPED_TRACE(wrong);
    expect_near(deviation_from(given), {-std::log(wrong)});
  }
}

TEST_F(SelfCalibrationTest, FindsThatWidthsAreStretched) {
  Camera given = real_;
  given.fx *= 1.2;
  const double half = 0.5 * std::log(1.2);
  expect_near(deviation_from(given), {-half, half});
}

TEST_F(SelfCalibrationTest, FindsALensThatBendsLines) {
  expect_near(deviation_from(real_, -0.25), {0.0, 0.0, -0.25});
}

TEST_F(SelfCalibrationTest, FindsThatTheImageWasCropped) {
  Camera given = real_;
  given.cx += 40.0;
  given.cy -= 25.0;
  expect_near(deviation_from(given), {0.0, 0.0, 0.0, -40.0 / given.fx, 25.0 / given.fy});
}

/// The keystone of a badly rectified texture, which a flat surface does not distinguish from
/// perspective.
TEST_F(SelfCalibrationTest, KnowsThatANearlyFlatSheetCannotTellKeystoneFromPerspective) {
  const DevelopableSheet sheet = testing::make_cylinder(
      testing::kBentSpec, 2.0, 0.0, PoseSpec{.distance_m = 0.5, .tilt_x_rad = 0.3});
  const Points3 vertices_m = testing::bent_vertices(templ_, sheet);
  const auto matches =
      testing::draw_matches(templ_, real_, vertices_m, {.count = 300, .noise_px = 0.1}, rng_)
          .matches;
  const auto evidence = calibration().look(real_, vertices_m, matches);
  ASSERT_TRUE(evidence);
  const auto focal_std_knowing = [&](std::initializer_list<Part> parts) {
    CameraEvidence known = *evidence;
    for (const Part part : parts) known.information(part, part) += 1e12;
    return CameraDeviation::of(known).stds()(kFocal);
  };
  const double lens_known = focal_std_knowing({kLens, kCentreX, kCentreY, kBarrel});
  const double all_known =
      focal_std_knowing({kLens, kCentreX, kCentreY, kBarrel, kKeystoneX, kKeystoneY});
  EXPECT_GT(lens_known, 2.0 * all_known);
}

TEST_F(SelfCalibrationTest, KnowsThatAFlatSheetSeenFrontallyTellsNoFocalLength) {
  const Points3 vertices_m = testing::bent_vertices(
      templ_, testing::make_bent_sheet(testing::kBentSpec, {}, PoseSpec{.distance_m = 0.5}));
  const auto matches =
      testing::draw_matches(templ_, real_, vertices_m, {.count = 300, .noise_px = 0.3}, rng_)
          .matches;
  const auto evidence = calibration().look(real_, vertices_m, matches);
  ASSERT_TRUE(evidence);
  const CameraDeviation found = CameraDeviation::of(*evidence);
  EXPECT_GT(found.stds()(kFocal), 0.12) << "a factor below 1.6 is not told";
  EXPECT_LT(found.stds()(kAspect), 0.01) << "but its proportions";
}

TEST_F(SelfCalibrationTest, TakesTheBendAtRestOfACurvedTemplate) {
  const Points3 label_m = testing::bent_vertices(
      templ_, testing::make_cylinder(testing::kBentSpec, 0.12, 0.0, PoseSpec{.distance_m = 0.5}));
  Template label = templ_;
  label.vertices_m = make_array<double>(label_m);
  auto calibration = SelfCalibration::of(label);
  ASSERT_TRUE(calibration) << calibration.error().message;
  const Points3 vertices_m = testing::bent_vertices(
      templ_, testing::make_cylinder(testing::kBentSpec, 0.12, 0.0,
                                     PoseSpec{.distance_m = 0.5, .tilt_x_rad = 0.4}));
  Camera given = real_;
  given.fx *= 1.2;
  given.fy *= 1.2;
  Points3 farther_m = vertices_m;
  farther_m.col(2).array() += 0.1;
  const auto matches =
      testing::draw_matches(label, real_, vertices_m, {.count = 300, .noise_px = 0.3}, rng_)
          .matches;
  const auto evidence = calibration->look(given, farther_m, matches);
  ASSERT_TRUE(evidence);
  EXPECT_NEAR(CameraDeviation::of(*evidence).mean(kFocal), -std::log(1.2), 0.03);
}

TEST_F(SelfCalibrationTest, SaysNothingWithoutEnoughToGoBy) {
  const SeenSheet seen = testing::see_bent_sheet(templ_, real_, real_, 0.0, 1, rng_);
  SelfCalibration calibration = this->calibration();
  ASSERT_TRUE(calibration.look(real_, seen.vertices_m, seen.matches));
  Correspondences few = seen.matches;
  for (std::int64_t i = 29; i < few.count(); ++i) few.kept(i) = 0;
  EXPECT_FALSE(calibration.look(real_, seen.vertices_m, few)) << "29 matches";
  few = seen.matches;
  for (std::int64_t i = 29; i < few.count(); ++i) few.face(i) = -1;
  EXPECT_FALSE(calibration.look(real_, seen.vertices_m, few)) << "29 on the mesh";
  EXPECT_FALSE(calibration.look(real_, -seen.vertices_m, seen.matches)) << "behind the camera";
  Points3 broken = seen.vertices_m;
  broken(5, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(calibration.look(real_, broken, seen.matches)) << "not a number";
}

}  // namespace
}  // namespace weft
