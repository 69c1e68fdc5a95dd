// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <iostream>
#include <limits>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

#include "common/view/tests/printed_scene.hpp"

namespace weft::dense_flow {
namespace {

using ::testing::HasSubstr;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kSeed = 33;
constexpr testing::PoseSpec kBefore{.distance_m = 0.55, .tilt_y_rad = 0.1};

double share_below(const std::vector<double>& values, double limit) {
  const auto below =
      std::count_if(values.begin(), values.end(), [&](double v) { return v < limit; });
  return static_cast<double>(below) / static_cast<double>(values.size());
}

class DenseFlow : public ::testing::Test {
 protected:
  DenseFlow() { std::cout << "seed " << kSeed << "\n"; }

  std::vector<testing::Input> inputs(const Image& image, const Shape& shape) const {
    return {testing::input("image", image), testing::input("template", scene_.templ),
            testing::input("camera", scene_.camera), testing::input("shape", shape)};
  }

  PluginAnswer find(const Image& image, const Shape& shape, const std::string& params = "{}") {
    PluginUnderTest plugin("matchers/dense_flow", params);
    return plugin.process(0, inputs(image, shape));
  }

  /// The result for a surface that is expected at `before_` and is at `now`.
  PluginAnswer find(const DevelopableSheet& now, const std::string& params = "{}") {
    return find(scene_.image_of(now, rng_), scene_.shape_of(before_), params);
  }

  std::vector<double> errors_px(const PluginAnswer& outcome, const DevelopableSheet& truth) const {
    return scene_.errors_px(*outcome.get<Correspondences>(), truth);
  }

  view::PrintedScene scene_;
  Rng rng_{kSeed};
  DevelopableSheet before_ = scene_.bent(0.35, kBefore);
};

TEST_F(DenseFlow, FindsThousandsOfMatchesToATenthOfAPixelOnASheetThatBentTurnedAndMoved) {
  const DevelopableSheet now =
      scene_.bent(0.32, {.distance_m = 0.552, .x_m = 0.003, .tilt_y_rad = 0.12, .roll_rad = 0.02});
  const PluginAnswer outcome = find(now);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const std::vector<double> errors = errors_px(outcome, now);
  EXPECT_GT(errors.size(), 2000U);
  EXPECT_LT(median(errors), 0.1);
  EXPECT_GT(share_below(errors, 0.5), 0.99);
  const auto matches = *outcome.get<Correspondences>();
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    EXPECT_GE(matches.barycentrics.matrix<3>().row(i).minCoeff(), -1e-6);
  }
  EXPECT_GT(matches.diag.value("correlation", 0.0), matches.diag.value("correlation_before", 1.0));
}

TEST_F(DenseFlow, FindsASurfaceThatIsOutOfFocusOnceTheRenderingIsToo) {
  const DevelopableSheet now =
      scene_.bent(0.34, {.distance_m = 0.551, .x_m = 0.002, .tilt_y_rad = 0.11});
  const Image image =
      view::blurred(scene_.image_of(now, rng_), 6.0, [](double v) { return 0.8 * v + 20.0; });
  const Shape shape = scene_.shape_of(before_);
  EXPECT_EQ(find(image, shape, "{halvings: 1}").status, WEFT_NO_RESULT);
  const PluginAnswer outcome = find(image, shape, "{halvings: 1, max_blur_px: 12}");
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto matches = *outcome.get<Correspondences>();
  EXPECT_NEAR(matches.diag.value("blur_px", 0.0), 6.0, 0.8);
  const std::vector<double> errors = errors_px(outcome, now);
  EXPECT_GT(errors.size(), 500U);
  EXPECT_LT(median(errors), 0.5);
}

TEST_F(DenseFlow, AnswersTheSameBytesOnSharpImagesWhetherOrNotItMayBlur) {
  const Image image = scene_.image_of(before_, rng_);
  const Shape shape = scene_.shape_of(before_);
  const PluginAnswer one = find(image, shape), other = find(image, shape, "{max_blur_px: 12}");
  const auto sharp = *one.get<Correspondences>(), may_blur = *other.get<Correspondences>();
  ASSERT_EQ(sharp.count(), may_blur.count());
  EXPECT_EQ(sharp.image_px.matrix<2>(), may_blur.image_px.matrix<2>());
}

TEST_F(DenseFlow, FindsMotionsFromAThirdOfAPixelToEightToATenthOfAPixel) {
  const double m_per_px = 0.55 / scene_.camera.fx;
  for (const double motion_px : {0.0, 0.3, 1.0, 3.0, 8.0}) {
    testing::PoseSpec pose = kBefore;
    pose.x_m += 0.8 * motion_px * m_per_px;
    pose.y_m += 0.6 * motion_px * m_per_px;
    const DevelopableSheet now = scene_.bent(0.35, pose);
    const PluginAnswer outcome = find(now);
    ASSERT_EQ(outcome.status, WEFT_OK) << motion_px << ": " << outcome.message;
    const std::vector<double> errors = errors_px(outcome, now);
    EXPECT_GT(errors.size(), 2000U) << motion_px;
    EXPECT_LT(median(errors), 0.1) << motion_px;
  }
}

TEST_F(DenseFlow, IsNotPulledByLight) {
  const DevelopableSheet now = scene_.bent(0.34, {.distance_m = 0.55, .tilt_y_rad = 0.11});
  const Image image = scene_.image_of(now, rng_);
  for (const double gain : {0.5, 1.4}) {
    const Image lit = view::PrintedScene::unevenly_lit(image, gain);
    const PluginAnswer outcome = find(lit, scene_.shape_of(before_));
    ASSERT_EQ(outcome.status, WEFT_OK) << gain << ": " << outcome.message;
    EXPECT_LT(median(errors_px(outcome, now)), 0.1) << gain;
  }
}

TEST_F(DenseFlow, LeavesOutWhatAnArmHides) {
  const DevelopableSheet now = scene_.bent(0.34, {.distance_m = 0.55, .tilt_y_rad = 0.11});
  Image image = scene_.image_of(now, rng_);
  Array<std::uint8_t> covered({image.pixels.dim(0), image.pixels.dim(1)});
  const auto is_arm = [](std::int64_t x, std::int64_t y) { return std::abs(x - 300 + y / 4) < 35; };
  for (std::int64_t y = 0; y < covered.dim(0); ++y) {
    for (std::int64_t x = 0; x < covered.dim(1); ++x) {
      const double skin = 150.0 + 30.0 * std::sin(0.07 * static_cast<double>(x + 2 * y));
      covered(y, x) =
          is_arm(x, y) ? static_cast<std::uint8_t>(std::lround(skin)) : image.pixels(y, x);
    }
  }
  image.pixels = covered;
  const PluginAnswer outcome = find(image, scene_.shape_of(before_));
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const std::vector<double> errors = errors_px(outcome, now);
  EXPECT_GT(errors.size(), 1500U);
  EXPECT_GT(share_below(errors, 0.5), 0.99);
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 3.0);
}

TEST_F(DenseFlow, DoubtsAShapeOfWhichTheImageShowsAPartOnly) {
  const DevelopableSheet now = scene_.bent(0.34, {.distance_m = 0.55, .tilt_y_rad = 0.11});
  Image image = scene_.image_of(now, rng_);
  const auto confidence = [&](double unlike_at_least, double unlike_at_most) {
    const PluginAnswer outcome = find(image, scene_.shape_of(now));
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    const auto matches = *outcome.get<Correspondences>();
    EXPECT_GE(matches.diag.value("unlike_contrast", -1.0), unlike_at_least);
    EXPECT_LE(matches.diag.value("unlike_contrast", 2.0), unlike_at_most);
    return *matches.confidence.data();
  };
  EXPECT_GT(confidence(0.0, 0.01), 0.99);
  image = view::PrintedScene::unevenly_lit(image, 0.5);
  EXPECT_GT(confidence(0.0, 0.01), 0.99) << "light does not matter";
  // A seventh of the image shows the texture of another place, or grey.
  const auto with_band = [&](auto&& level) {
    Image other = image;
    other.pixels = Array<std::uint8_t>({image.pixels.dim(0), image.pixels.dim(1)});
    for (std::int64_t y = 0; y < other.pixels.dim(0); ++y) {
      for (std::int64_t x = 0; x < other.pixels.dim(1); ++x) {
        const bool is_inside = std::abs(x - 300) < 45;
        other.pixels(y, x) = is_inside ? level(x, y) : image.pixels(y, x);
      }
    }
    return other;
  };
  const Image whole = image;
  image = with_band([&](std::int64_t x, std::int64_t y) { return whole.pixels(y, x + 60); });
  EXPECT_LT(confidence(0.12, 0.5), 0.3);
  image = whole;
  image = with_band([](std::int64_t, std::int64_t) { return std::uint8_t{120}; });
  // Cells on its two edges have contrast, and are unlike.
  EXPECT_GT(confidence(0.01, 0.09), 0.5) << "what a hand covers is hidden, and not wrong";
}

TEST_F(DenseFlow, DoesNotTakeTheTextureItselfForAView) {
  const std::int64_t width = scene_.templ.texture.dim(1), height = scene_.templ.texture.dim(0);
  Camera camera = scene_.camera;
  camera.width_px = width;
  camera.height_px = height;
  camera.cx = 0.5 * static_cast<double>(width - 1);
  camera.cy = 0.5 * static_cast<double>(height - 1);
  Shape shape = scene_.shape_of(before_);
  for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
    shape.vertices_m(v, 0) = (scene_.templ.flat_px(v, 0) - camera.cx) * scene_.templ.m_per_px(0);
    shape.vertices_m(v, 1) = (scene_.templ.flat_px(v, 1) - camera.cy) * scene_.templ.m_per_px(1);
    shape.vertices_m(v, 2) = camera.fx * scene_.templ.m_per_px(0);
  }
  Image image;
  image.pixels = scene_.templ.texture;
  PluginUnderTest plugin("matchers/dense_flow");
  const PluginAnswer outcome =
      plugin.process(0, {testing::input("image", image), testing::input("template", scene_.templ),
                         testing::input("camera", camera), testing::input("shape", shape)});
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto matches = *outcome.get<Correspondences>();
  EXPECT_EQ(matches.diag.value("is_texture", -1.0), 1.0);
  EXPECT_EQ(*matches.confidence.data(), 0.0);
}

TEST_F(DenseFlow, SaysHowExactAMatchIs) {
  const DevelopableSheet now = scene_.bent(0.33, {.distance_m = 0.55, .tilt_y_rad = 0.11});
  const PluginAnswer outcome = find(now, "{spacing_px: 12}");
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const auto matches = *outcome.get<Correspondences>();
  std::vector<double> squares;  // in units of the reported deviation
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const Eigen::Vector2d texel = matches.template_px.matrix<2>().row(i);
    const Eigen::Vector2d seen_px = matches.image_px.matrix<2>().row(i);
    const Eigen::Vector2d off_px = seen_px - scene_.place_of(texel, now);
    const Eigen::Map<const Eigen::Matrix2d> covariance(matches.covariance_px2.row(i));
    squares.push_back(off_px.dot(covariance.inverse() * off_px));
  }
  // Half of a chi square of two degrees of freedom lies below 1.39. The difference between patch
  // and image is not only noise, so that the place of a patch is somewhat more accurate than
  // reported.
  EXPECT_GT(median(squares), 0.1);
  EXPECT_LT(median(squares), 3.0);
}

TEST_F(DenseFlow, RefusesAShapeThatIsTooFarOffAndAnotherPrint) {
  const DevelopableSheet away =
      scene_.bent(0.35, {.distance_m = 0.55, .x_m = 0.06, .tilt_y_rad = 0.1});
  const PluginAnswer outcome = find(away);
  EXPECT_EQ(outcome.status, WEFT_NO_RESULT);
  EXPECT_THAT(outcome.message,
              ::testing::AnyOf(HasSubstr("too far from the shape"), HasSubstr("places are found")));
  view::PrintedScene other;
  other.templ = other.printed(99);
  EXPECT_EQ(find(other.image_of(before_, rng_), scene_.shape_of(before_)).status, WEFT_NO_RESULT);
}

/// Initial places are off by anything from nothing to a tenth of the image and a third of a turn.
TEST_F(DenseFlow, IsRightWhereverItAnswers) {
  constexpr int kStarts = 40, kFewestAnswers = 25;
  PluginUnderTest plugin("matchers/dense_flow");
  int answers = 0;
  for (int start = 0; start < kStarts; ++start) {
    const double off = static_cast<double>(start) / kStarts;
    testing::PoseSpec pose = kBefore;
    pose.x_m += 0.05 * off * rng_.uniform(-1.0, 1.0);
    pose.y_m += 0.05 * off * rng_.uniform(-1.0, 1.0);
    pose.distance_m *= 1.0 + 0.2 * off * rng_.uniform(-1.0, 1.0);
    pose.tilt_y_rad += 0.8 * off * rng_.uniform(-1.0, 1.0);
    pose.roll_rad += 0.4 * off * rng_.uniform(-1.0, 1.0);
    const double radius_m = 0.35 * std::exp(off * rng_.uniform(-1.2, 1.2));
    const DevelopableSheet now = scene_.bent(radius_m, pose);
    const PluginAnswer outcome =
        plugin.process(0, inputs(scene_.image_of(now, rng_), scene_.shape_of(before_)));
    if (outcome.status == WEFT_NO_RESULT) continue;
    ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
    ++answers;
    EXPECT_GT(share_below(errors_px(outcome, now), 2.0), 0.9) << "start " << start;
  }
  EXPECT_GE(answers, kFewestAnswers);
}

TEST_F(DenseFlow, BelievesOtherMatchesMoreThanItself) {
  const DevelopableSheet now = scene_.bent(0.34, kBefore);
  const Image image = scene_.image_of(now, rng_);
  PluginUnderTest plugin("matchers/dense_flow");
  const PluginAnswer sparse = find(image, scene_.shape_of(before_), "{spacing_px: 12}");
  ASSERT_EQ(sparse.status, WEFT_OK) << sparse.message;
  const auto matches = *sparse.get<Correspondences>();
  const auto answer = [&](double off_px) {
    Correspondences moved = matches;
    moved.image_px = Array<double>({matches.count(), 2});
    moved.image_px.matrix<2>() = matches.image_px.matrix<2>();
    moved.image_px.matrix<2>().col(0).array() += off_px;
    std::vector<testing::Input> all = inputs(image, scene_.shape_of(before_));
    all.push_back(testing::input("correspondences", moved));
    return plugin.process(0, all);
  };
  EXPECT_EQ(answer(1.0).status, WEFT_OK);
  EXPECT_NEAR(answer(1.0).get<Correspondences>()->diag.value("disagreement_px", 0.0), 1.0, 0.2);
  const PluginAnswer refused = answer(9.0);
  EXPECT_EQ(refused.status, WEFT_NO_RESULT);
  EXPECT_THAT(refused.message, HasSubstr("the other matches are 9."));
}

TEST_F(DenseFlow, GivesNoResultWithoutAShapeInSight) {
  const Image image = scene_.image_of(before_, rng_);
  PluginUnderTest plugin("matchers/dense_flow");
  EXPECT_EQ(
      plugin
          .process(0, {testing::input("image", image), testing::input("template", scene_.templ),
                       testing::input("camera", scene_.camera)})
          .status,
      WEFT_NO_RESULT);
  Shape lost = scene_.shape_of(before_);
  lost.state = static_cast<std::int32_t>(ShapeState::lost);
  EXPECT_EQ(find(image, lost).status, WEFT_NO_RESULT);
  for (const double depth_m : {-0.5, std::numeric_limits<double>::quiet_NaN()}) {
    Shape shape = scene_.shape_of(before_);
    shape.vertices_m.matrix<3>().col(2).setConstant(depth_m);
    EXPECT_EQ(find(image, shape).status, WEFT_NO_RESULT) << depth_m;
  }
  Shape outside = scene_.shape_of(before_);
  outside.vertices_m.matrix<3>().col(0).array() += 2.0;
  EXPECT_EQ(find(image, outside).status, WEFT_NO_RESULT);
}

TEST_F(DenseFlow, GivesNoResultOnASheetWithoutTexture) {
  const Image image = scene_.image_of(before_, rng_);
  std::fill_n(scene_.templ.texture.data(), scene_.templ.texture.size(), std::uint8_t{128});
  EXPECT_EQ(find(image, scene_.shape_of(before_)).status, WEFT_NO_RESULT);
}

TEST_F(DenseFlow, RefusesAnImageThatIsNotTheCameras) {
  Image small;
  small.pixels = Array<std::uint8_t>({1, 1}, 0);
  const PluginAnswer outcome = find(small, scene_.shape_of(before_));
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.message, HasSubstr("the size of the camera"));
}

TEST_F(DenseFlow, TakesAQuarterOfTheMatchesFromTheHalvedImage) {
  const DevelopableSheet now = scene_.bent(0.33, {.distance_m = 0.55, .tilt_y_rad = 0.11});
  const PluginAnswer outcome = find(now, "{halvings: 1}");
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.message;
  const std::vector<double> errors = errors_px(outcome, now);
  EXPECT_GT(errors.size(), 400U);
  EXPECT_LT(median(errors), 0.25);
}

}  // namespace
}  // namespace weft::dense_flow
