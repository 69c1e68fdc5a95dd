// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/residual_field.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/testing/synthetic.hpp>

#include "pipeline/survey/refitting.hpp"

namespace weft::testing::residuals {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Camera kCamera = make_camera();
constexpr SheetSpec kSheet{
    .columns = 15, .rows = 10, .width_m = 0.15, .height_m = 0.1, .width_px = 600, .height_px = 400};

/// An error of texture coordinates that no pose explains: smooth, 4 px (rms), 0 at the borders.
Eigen::Vector2d wave_px(const Eigen::Vector2d& at) {
  const double u = 2.0 * M_PI * (at.x() + 0.5) / kSheet.width_px;
  const double v = 2.0 * M_PI * (at.y() + 0.5) / kSheet.height_px;
  return 4.0 * std::sqrt(2.0) *
         Eigen::Vector2d(std::sin(u) * std::sin(v), std::sin(2.0 * u) * std::sin(v));
}

Template with_wave(const Template& templ) {
  Template result = templ;
  result.flat_px = Array<double>({templ.flat_px.rows(), 2});
  for (std::int64_t i = 0; i < templ.flat_px.rows(); ++i) {
    const Eigen::Vector2d at(templ.flat_px(i, 0), templ.flat_px(i, 1));
    for (int k = 0; k < 2; ++k) result.flat_px(i, k) = at(k) + wave_px(at)(k);
  }
  return result;
}

RigidAlignment pose_of(double lean_rad) {
  RigidAlignment pose;
  pose.rotation = (Eigen::AngleAxisd(lean_rad, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation << -0.06, -0.05, 0.3;
  return pose;
}

/// Matches with the object at rest, with noise and a share of wrong ones.
Correspondences seen(const Template& templ, double lean_rad, double noise_px, std::uint64_t seed,
                     std::int64_t count = 600) {
  std::cout << "seed " << seed << "\n";
  Rng rng(seed);
  const auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), templ.faces.matrix<3>());
  const RigidAlignment pose = pose_of(lean_rad);
  Correspondences matches;
  matches.template_px = Array<double>({count, 2});
  matches.image_px = Array<double>({count, 2});
  matches.kept = Array<std::uint8_t>({count}, 1);
  for (std::int64_t i = 0; i < count; ++i) {
    const Eigen::Vector2d at(rng.uniform(5.0, 594.0), rng.uniform(5.0, 394.0));
    const FaceLocation on = locator->locate(at);
    Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      place += on.weights(k) * templ.vertices_m.matrix<3>().row(templ.faces(on.face, k));
    }
    const Eigen::Vector2d pixel =
        project({kCamera.fx, kCamera.fy, kCamera.cx, kCamera.cy}, pose(place.transpose()));
    const double wrong_px = i % 20 == 0 ? 15.0 : 0.0;
    for (int k = 0; k < 2; ++k) {
      matches.template_px(i, k) = at(k);
      matches.image_px(i, k) = pixel(k) + (noise_px + wrong_px) * rng.normal();
    }
  }
  return matches;
}

double rms_error_px(const Template& templ, const Template& truth) {
  double squares = 0.0;
  for (std::int64_t i = 0; i < templ.flat_px.rows(); ++i) {
    for (int k = 0; k < 2; ++k) {
      squares += std::pow(templ.flat_px(i, k) - truth.flat_px(i, k), 2);
    }
  }
  return std::sqrt(squares / static_cast<double>(templ.flat_px.rows()));
}

TEST(ResidualField, MeasuresSmoothErrorsOfTextureCoordinatesWithinAPixel) {
  const Template templ = make_template(kSheet);
  const Template wrong = with_wave(templ);
  for (const double lean_rad : {-0.4, 0.0, 0.4}) {
    const auto residuals = residuals_at_rest(wrong, kCamera, seen(templ, lean_rad, 0.4, 11));
    ASSERT_TRUE(residuals);
    const auto field = fit_residual_field(wrong, *residuals);
    ASSERT_TRUE(field);
    EXPECT_NEAR(field->rms_px, rms_error_px(wrong, templ), 1.0) << lean_rad;
    EXPECT_TRUE(field->is_coherent()) << field->rms_px << " " << field->predicted;
    FirstLook look;
    look.field = field;
    EXPECT_THAT(doubts_of(look), ElementsAre(HasSubstr("--refit FOLDER")));
  }
}

TEST(ResidualField, IsNotCoherentForACleanTemplateWhateverTheNoise) {
  const Template templ = make_template(kSheet);
  for (const double noise_px : {0.0, 0.5, 1.5, 3.0}) {
    for (const std::uint64_t seed : {21U, 22U, 23U}) {
      const auto residuals =
          residuals_at_rest(templ, kCamera, seen(templ, 0.3, noise_px, seed, 200));
      ASSERT_TRUE(residuals);
      FirstLook look;
      look.field = fit_residual_field(templ, *residuals);
      ASSERT_TRUE(look.field);
      EXPECT_THAT(doubts_of(look), IsEmpty()) << noise_px << " px";
    }
  }
}

TEST(ResidualField, NeedsManyMatches) {
  const Template templ = make_template(kSheet);
  const auto residuals = residuals_at_rest(templ, kCamera, seen(templ, 0.3, 0.5, 31, 40));
  ASSERT_TRUE(residuals);
  EXPECT_FALSE(fit_residual_field(templ, *residuals));
}

TEST(RefittedTemplate, HasTextureCoordinatesThatAreRightByAFewTenthsOfAPixel) {
  const Template templ = make_template(kSheet);
  const Template wrong = with_wave(templ);
  std::vector<Correspondences> frames;
  for (const double lean_rad : {-0.4, 0.0, 0.4}) frames.push_back(seen(templ, lean_rad, 0.4, 41));
  const auto refitted = refit(wrong, kCamera, frames);
  ASSERT_TRUE(refitted) << refitted.error().message;
  EXPECT_EQ(refitted->frames, 3);
  EXPECT_LT(rms_error_px(refitted->templ, templ), 0.2 * rms_error_px(wrong, templ));
  EXPECT_LT(refitted->after.rms_px, 0.5);
}

TEST(RefittedTemplate, IsNotMadeOfFramesThatDoNotShowTheObjectAtRest) {
  const Template templ = make_template(kSheet);
  Correspondences elsewhere = seen(templ, 0.0, 100.0, 51);
  const auto refused = refit(templ, kCamera, {elsewhere});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::no_result);
}

}  // namespace
}  // namespace weft::testing::residuals
