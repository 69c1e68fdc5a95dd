// SPDX-License-Identifier: Apache-2.0
#include "degradation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

#include "small_film.hpp"

namespace weft::testing {
namespace {

using frex::Movement;
using scene::Colour;
using scene::Picture;

constexpr Pinhole kCamera{400.0, 400.0, 159.5, 119.5};
constexpr std::int64_t kHeight_px = 240;

/// Points of a plane 0.5 m in front of the camera, which move by this many px a second.
Movement moving(const Points2& places_px, const Eigen::Vector2d& speed_px) {
  constexpr double kFrame_s = 0.04;
  Movement movement{{}, {}, {}, kFrame_s};
  const auto placed = [&](double t_s) {
    Points3 points_m(places_px.rows(), 3);
    for (Eigen::Index v = 0; v < points_m.rows(); ++v) {
      const Eigen::Vector2d at_px = places_px.row(v).transpose() + t_s * speed_px;
      points_m.row(v) << 0.5 * (at_px.x() - kCamera.cx) / kCamera.fx,
          0.5 * (at_px.y() - kCamera.cy) / kCamera.fy, 0.5;
    }
    return points_m;
  };
  movement.before_m = placed(-kFrame_s);
  movement.now_m = placed(0.0);
  movement.after_m = placed(kFrame_s);
  return movement;
}

Picture grey_picture(int width, int height, float grey) {
  Picture picture{width, height, {}};
  picture.pixels.resize(to_index(width) * to_index(height), Colour::Constant(grey));
  return picture;
}

TEST(Degradation, ARowIsSeenAtTheTimeAtWhichItIsRead) {
  // Down by 500 px a second, read in 20 ms. A point of row v is read when it is in row w with w = v
  // + 500 t and t = 0.02 ((w + 1/2) / 240 - 1/2).
  Points2 places_px(3, 2);
  places_px << 100.0, 20.0, 150.0, 119.5, 200.0, 220.0;
  const Eigen::Vector2d speed_px(300.0, 500.0);
  const Points3 seen_m = frex::as_read(kCamera, kHeight_px, 0.02, moving(places_px, speed_px));
  for (Eigen::Index v = 0; v < 3; ++v) {
    const double row = places_px(v, 1);
    const double read_in =
        (row + 500.0 * 0.02 * (0.5 / 240.0 - 0.5)) / (1.0 - 500.0 * 0.02 / 240.0);
    const double t_s = (read_in - row) / 500.0;
    const Eigen::Vector2d pixel = project(kCamera, seen_m.row(v).transpose());
    EXPECT_NEAR(pixel.y(), read_in, 1e-6);
    EXPECT_NEAR(pixel.x(), places_px(v, 0) + 300.0 * t_s, 1e-6);
  }
  EXPECT_NEAR(project(kCamera, seen_m.row(1).transpose()).y(), 119.5, 1e-6)
      << "the middle row is read at the time of the frame";
}

TEST(Degradation, AnAcceleratedPointIsWhereItsParabolaIs) {
  Movement movement{Points3::Zero(1, 3), Points3::Zero(1, 3), Points3::Zero(1, 3), 0.1};
  const auto place = [](double t_s) { return Eigen::RowVector3d(2.0 * t_s, 5.0 * t_s * t_s, 1.0); };
  movement.before_m.row(0) = place(-0.1);
  movement.now_m.row(0) = place(0.0);
  movement.after_m.row(0) = place(0.1);
  EXPECT_LT((movement.at(0, 0.03).transpose() - place(0.03)).norm(), 1e-12);
}

TEST(Degradation, MotionBlurIsTheMeanAlongTheMovement) {
  Points2 places_px(2, 2);
  places_px << 100.0, 20.0, 150.0, 119.5;
  const Eigen::Vector2d direction = frex::direction_of(kCamera, moving(places_px, {30.0, 40.0}));
  EXPECT_LT((direction - Eigen::Vector2d(0.6, 0.8)).norm(), 1e-9);
  EXPECT_EQ(frex::direction_of(kCamera, moving(places_px, {0.0, 0.0})).norm(), 0.0);

  // An edge between columns 31 and 32 becomes a ramp of 8 px; along it nothing changes.
  Picture edge = grey_picture(64, 32, 0.0F);
  for (int y = 0; y < 32; ++y) {
    for (int x = 32; x < 64; ++x) edge.pixels[to_index(y * 64 + x)] = Colour::Constant(80.0F);
  }
  Picture along = edge;
  frex::blur_along({8.0, 0.0}, edge);
  for (int x = 0; x < 64; ++x) {
    const double covered = std::clamp((x - 31.5 + 4.0) / 8.0, 0.0, 1.0);
    EXPECT_NEAR(edge.at(x, 16)[0], 80.0 * covered, 1.3) << "column " << x;
  }
  const Picture before = along;
  frex::blur_along({0.0, 8.0}, along);
  for (int x = 0; x < 64; ++x) EXPECT_NEAR(along.at(x, 16)[0], before.at(x, 16)[0], 1e-3);
}

TEST(Degradation, TheExposureStepsUpAndDownEveryFiveFrames) {
  for (std::int64_t frame = 0; frame < 40; ++frame) {
    const double step = std::array{1.0, 2.0, 1.0, 0.5}[to_index(frame / 5 % 4)];
    EXPECT_DOUBLE_EQ(frex::exposure_gain(1.0, frame), step) << "frame " << frame;
  }
  EXPECT_DOUBLE_EQ(frex::exposure_gain(0.5, 7), std::sqrt(2.0));
}

TEST(Degradation, AHandCoversItsShareOfTheSheetAndHidesWhatIsUnderIt) {
  SmallFilm free("pattern: roll, noise_grey: 0, blur_px: 0");
  const GroundTruth whole = free.truth(8);
  const auto seen = free.pixels(8);
  for (const double share : {0.1, 0.4, 0.7}) {
    SmallFilm in_hand("pattern: roll, noise_grey: 0, blur_px: 0, hand_share: " +
                      std::to_string(share));
    const GroundTruth truth = in_hand.truth(8);
    EXPECT_EQ(truth.points_m.matrix<3>(), whole.points_m.matrix<3>());
    const auto pixels = in_hand.pixels(8);
    int sheet = 0, covered = 0;
    for (std::int64_t y = 0; y < 240; ++y) {
      for (std::int64_t x = 0; x < 320; ++x) {
        if (std::isnan(whole.uv_m.row(y)[2 * x])) continue;
        ++sheet;
        if (!std::isnan(truth.uv_m.row(y)[2 * x])) continue;
        ++covered;
        EXPECT_EQ(truth.depth_m(y, x), 0.0F);
      }
    }
    EXPECT_NEAR(static_cast<double>(covered) / sheet, share, 0.01);
    int hidden = 0;
    for (std::int64_t v = 0; v < truth.count(); ++v) {
      const Eigen::Vector2d at =
          project(free.pinhole(), truth.points_m.matrix<3>().row(v).transpose());
      const auto x = std::lround(at.x()), y = std::lround(at.y());
      if (x < 1 || y < 1 || x > 318 || y > 238 || whole.visible.data()[v] == 0) continue;
      const bool is_free = !std::isnan(truth.uv_m.row(y)[2 * x]);
      const bool is_sheet = !std::isnan(whole.uv_m.row(y)[2 * x]);
      if (is_sheet) {
        EXPECT_EQ(truth.visible.data()[v] != 0, is_free) << "vertex " << v;
      }
      hidden += truth.visible.data()[v] == 0 ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(hidden) / static_cast<double>(truth.count()), share, 0.08);
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const auto y = static_cast<std::int64_t>(k / 320), x = static_cast<std::int64_t>(k % 320);
      if (!std::isnan(truth.uv_m.row(y)[2 * x])) {
        ASSERT_EQ(pixels[k], seen[k]) << "pixel " << k;
      }
    }
  }
}

TEST(Degradation, AStrongerCompressionChangesMore) {
  SmallFilm film;
  const auto whole = film.pixels(4);
  double last = 0.0;
  for (const int quality : {95, 40, 5}) {
    Array<std::uint8_t> pixels({240, 320});
    std::copy(whole.begin(), whole.end(), pixels.data());
    ASSERT_TRUE(frex::compress(quality, pixels));
    double squares = 0.0;
    for (std::size_t k = 0; k < whole.size(); ++k) {
      squares += std::pow(static_cast<double>(pixels.data()[k]) - whole[k], 2);
    }
    const double sigma = std::sqrt(squares / static_cast<double>(whole.size()));
    EXPECT_GT(sigma, last + 0.5) << "quality " << quality;
    last = sigma;
  }
  Array<std::uint8_t> colour({16, 24, 3}, 90);
  ASSERT_TRUE(frex::compress(50, colour));
  EXPECT_NEAR(colour.data()[100], 90, 2);
}

TEST(Degradation, TheSourceAppliesEachAndLeavesTheTruthAlone) {
  SmallFilm plain("noise_grey: 0");
  const auto sharp = plain.pixels(7);
  const GroundTruth truth = plain.truth(7);
  for (const char* worse :
       {"motion_blur_px: 8", "readout_s: 0.02", "exposure_stops: 1", "jpeg_quality: 10"}) {
    SmallFilm film(std::string("noise_grey: 0, ") + worse);
    EXPECT_NE(film.pixels(7), sharp) << worse;
    EXPECT_EQ(film.truth(7).points_m.matrix<3>(), truth.points_m.matrix<3>()) << worse;
    EXPECT_EQ(film.pixels(7), film.pixels(7)) << worse;
    film.pixels(0);
  }
  SmallFilm bright("noise_grey: 0, exposure_stops: 1");
  const auto twice = bright.pixels(7);
  for (std::size_t k = 0; k < sharp.size(); ++k) {
    ASSERT_NEAR(twice[k], std::min(255, 2 * sharp[k]), 1) << "pixel " << k;
  }
}

}  // namespace
}  // namespace weft::testing
