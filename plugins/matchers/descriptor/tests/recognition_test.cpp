// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/image.hpp>
#include <weft/data/keypoints.hpp>
#include <weft/testing/plugin_under_test.hpp>

/// The matcher together with detectors/sift on a texture of known motion.
namespace weft::descriptor {
namespace {

using testing::input;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr int kWidth = 300, kHeight = 240;
constexpr int kCanvasWidth = 700, kCanvasHeight = 580;

/// Noise blurred by several sigmas, drawn from a fixed seed.
cv::Mat make_texture() {
  std::printf("texture seed 21\n");
  Rng rng(21);
  cv::Mat texture(kHeight, kWidth, CV_32F, cv::Scalar(128));
  for (const double sigma_px : {1.5, 3.0, 6.0, 12.0}) {
    cv::Mat noise(kHeight, kWidth, CV_32F);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) noise.at<float>(y, x) = static_cast<float>(rng.normal());
    }
    cv::GaussianBlur(noise, noise, {}, sigma_px);
    texture += 70.0 * sigma_px * noise;
  }
  texture.convertTo(texture, CV_8U);
  return texture;
}

Image as_image(const cv::Mat& grey) {
  Image image;
  image.pixels = Array<std::uint8_t>({grey.rows, grey.cols}, 0);
  for (int y = 0; y < grey.rows; ++y) std::copy_n(grey.ptr(y), grey.cols, image.pixels.row(y));
  return image;
}

/// The texture's centre goes to that of the canvas; turned clockwise, scaled, and foreshortened so
/// that the scale changes by `tilt` across the texture.
Eigen::Matrix3d homography(double turn_rad, double scale, double tilt) {
  Eigen::Matrix3d centre = Eigen::Matrix3d::Identity(), motion = centre, canvas = centre;
  centre.topRightCorner<2, 1>() << -0.5 * kWidth, -0.5 * kHeight;
  canvas.topRightCorner<2, 1>() << 0.5 * kCanvasWidth, 0.5 * kCanvasHeight;
  motion.topLeftCorner<2, 2>() = scale * Eigen::Rotation2Dd(turn_rad).toRotationMatrix();
  motion(2, 0) = tilt / kWidth;
  return canvas * motion * centre;
}

cv::Mat warped(const cv::Mat& texture, const Eigen::Matrix3d& image_from_texture, double scale) {
  cv::Mat source = texture, target;
  // A smaller image is blurred first, as a camera would: 0.5 px in the image.
  if (scale < 1.0) {
    cv::GaussianBlur(source, source, {}, 0.5 * std::sqrt(1.0 / (scale * scale) - 1.0));
  }
  cv::Matx33d matrix;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) matrix(r, c) = image_from_texture(r, c);
  }
  cv::warpPerspective(source, target, matrix, {kCanvasWidth, kCanvasHeight}, cv::INTER_CUBIC,
                      cv::BORDER_CONSTANT, cv::Scalar(128));
  return target;
}

Eigen::Vector2d mapped(const Eigen::Matrix3d& h, double x, double y) {
  return (h * Eigen::Vector3d(x, y, 1.0)).hnormalized();
}

/// The share of the keypoints of the smaller set that lie within 1.5 px of one of the other image
/// and have its scale within a factor of 1.4. Keypoints near the texture's border, and those too
/// fine or too coarse for the other image, are omitted.
double repeatability(const Keypoints& texture, const Keypoints& image, const Eigen::Matrix3d& h,
                     double scale) {
  const Eigen::Matrix3d back = h.inverse();
  const auto usable = [](double x, double y, double sigma_px, double other_sigma_px) {
    return x > 20 && y > 20 && x < kWidth - 20 && y < kHeight - 20 && sigma_px > 1.3 &&
           other_sigma_px > 1.3;
  };
  int in_image = 0, in_texture = 0, repeated = 0;
  for (std::int64_t j = 0; j < image.count(); ++j) {
    const Eigen::Vector2d at = mapped(back, image.xy_px(j, 0), image.xy_px(j, 1));
    in_image += usable(at.x(), at.y(), image.scale_px(j), image.scale_px(j) / scale) ? 1 : 0;
  }
  for (std::int64_t i = 0; i < texture.count(); ++i) {
    if (!usable(texture.xy_px(i, 0), texture.xy_px(i, 1), texture.scale_px(i),
                scale * texture.scale_px(i))) {
      continue;
    }
    ++in_texture;
    const Eigen::Vector2d at = mapped(h, texture.xy_px(i, 0), texture.xy_px(i, 1));
    for (std::int64_t j = 0; j < image.count(); ++j) {
      const double factor = image.scale_px(j) / (scale * texture.scale_px(i));
      if (std::hypot(image.xy_px(j, 0) - at.x(), image.xy_px(j, 1) - at.y()) < 1.5 &&
          factor < 1.4 && factor > 1.0 / 1.4) {
        ++repeated;
        break;
      }
    }
  }
  return static_cast<double>(repeated) / std::min(in_image, in_texture);
}

struct Motion {
  const char* name;
  double turn_rad, scale, tilt;
};

class Recognition : public ::testing::TestWithParam<Motion> {};

TEST_P(Recognition, FindsMostKeypointsAgainAndMatchesThemRight) {
  const auto [name, turn_rad, scale, tilt] = GetParam();
  const Eigen::Matrix3d h = homography(turn_rad, scale, tilt);
  const cv::Mat texture = make_texture();
  PluginUnderTest sift("detectors/sift"), matcher("matchers/descriptor");
  const PluginAnswer of_texture = sift.process(0, {input("image", as_image(texture))});
  const PluginAnswer of_image =
      sift.process(0, {input("image", as_image(warped(texture, h, scale)))});
  const Keypoints templ = of_texture.get<Keypoints>().value();
  const Keypoints image = of_image.get<Keypoints>().value();
  const PluginAnswer out =
      matcher.process(0, {input("keypoints", image), input("template_keypoints", templ)});
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const Correspondences matches = out.get<Correspondences>().value();

  int correct = 0;
  std::vector<double> turns, scales;
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    const Eigen::Vector2d at = mapped(h, matches.template_px(n, 0), matches.template_px(n, 1));
    const double error =
        std::hypot(matches.image_px(n, 0) - at.x(), matches.image_px(n, 1) - at.y());
    correct += error < 3.0 ? 1 : 0;
    turns.push_back(matches.angle_difference_rad(n));
    scales.push_back(matches.scale_ratio(n));
  }
  const double precision = static_cast<double>(correct) / static_cast<double>(matches.count());
  const double repeated = repeatability(templ, image, h, scale);
  std::printf("%-12s %5lld x %5lld keypoints, %5lld matches, repeatability %.3f, precision %.3f\n",
              name, static_cast<long long>(templ.count()), static_cast<long long>(image.count()),
              static_cast<long long>(matches.count()), repeated, precision);
  EXPECT_GT(repeated, 0.6);
  EXPECT_GT(precision, 0.8);
  EXPECT_GT(matches.count(), 100);
  EXPECT_NEAR(median(turns), turn_rad, 0.03);
  EXPECT_NEAR(median(scales), scale, 0.04 * scale);
}

constexpr double kTurn = std::numbers::pi / 6.0;
INSTANTIATE_TEST_SUITE_P(
    Motions, Recognition,
    ::testing::Values(Motion{"turned_30", kTurn, 1.0, 0.0}, Motion{"turned_m30", -kTurn, 1.0, 0.0},
                      Motion{"half", 0.1, 0.5, 0.0}, Motion{"larger", -0.2, 1.4, 0.0},
                      Motion{"double", 0.2, 2.0, 0.0}, Motion{"tilted", 0.3, 1.0, 0.25}),
    [](const auto& instance) { return instance.param.name; });

TEST(SelfRecognition, ATextureMatchesItselfPointByPoint) {
  PluginUnderTest sift("detectors/sift");
  PluginUnderTest matcher("matchers/descriptor", "{one_to_one: false, duplicate_radius_px: 0}");
  const PluginAnswer detected = sift.process(0, {input("image", as_image(make_texture()))});
  const Keypoints keypoints = detected.get<Keypoints>().value();
  const PluginAnswer out =
      matcher.process(0, {input("keypoints", keypoints), input("template_keypoints", keypoints)});
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const Correspondences matches = out.get<Correspondences>().value();
  EXPECT_GT(matches.count(), 0.95 * static_cast<double>(keypoints.count()));
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    EXPECT_EQ(matches.template_keypoint(n), matches.image_keypoint(n));
    EXPECT_EQ(matches.distance(n), 0.0);
  }
}

}  // namespace
}  // namespace weft::descriptor
