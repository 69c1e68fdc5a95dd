// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/calibrate.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "board_views.hpp"
#include "lab/calibration/camera_text.hpp"
#include "lab/calibration/refusal.hpp"
#include "lab/calibration/residual_picture.hpp"

namespace weft::calibration {
namespace {

using ::testing::AllOf;
using testing::board_pose;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Lens;

/// Views in which the board is turned by `tilt_rad`, all over the image.
std::vector<View> views_turned(const Lens& lens, const Eigen::Vector2d& tilt_rad, Rng& rng) {
  std::vector<View> views;
  for (int i = 0; i < 18; ++i) {
    const Eigen::Vector2d place(0.2 + 0.3 * (i % 3), 0.2 + 0.3 * (i / 3 % 3));
    views.push_back(
        view_at(lens, board_pose(lens, middle_m(), place, 0.35, tilt_rad, 0.02 * i), 0.05, rng));
  }
  return views;
}

std::string reason(const std::vector<View>& views, const Lens& lens, int coefficients = 4) {
  const auto calibration = calibrate(views, size_of(lens), coefficients);
  if (calibration) return "";
  EXPECT_EQ(calibration.error().code, Errc::no_result);
  return calibration.error().message;
}

TEST(Calibrate, FindsTheCameraOfExactCorners) {
  const std::uint64_t seed = 11;
  RecordProperty("seed", static_cast<int>(seed));
  Rng rng(seed);
  const Lens lens = usual_lens();
  const auto calibration = calibrate(good_views(lens, 18, 0.0, rng), size_of(lens), 4);
  ASSERT_TRUE(calibration) << calibration.error().message;
  const Solution& solution = calibration->solution;
  EXPECT_NEAR(solution.fx, lens.fx, 1e-2);
  EXPECT_NEAR(solution.fy, lens.fy, 1e-2);
  EXPECT_NEAR(solution.cx, lens.cx, 1e-2);
  EXPECT_NEAR(solution.cy, lens.cy, 1e-2);
  const double truth[] = {lens.k1, lens.k2, lens.p1, lens.p2};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(solution.distortion.at(i), truth[i], 1e-4) << i;
  EXPECT_LT(solution.rms_px, 1e-3);
  EXPECT_THAT(calibration->coverage.missing(), ElementsAre());
}

// Errors divided by their standard deviations have the variance 1, whatever the seed.
TEST(Calibrate, ErrorsAreAsLargeAsTheStandardDeviationsSay) {
  const Lens lens = usual_lens();
  const double truth[] = {lens.fx, lens.fy, lens.cx, lens.cy, lens.k1, lens.k2, lens.p1, lens.p2};
  double sum = 0.0;
  constexpr int kSeeds = 25;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Rng rng(seed);
    const auto solution = solve(good_views(lens, 12, 0.2, rng), size_of(lens), 4);
    ASSERT_TRUE(solution) << seed;
    for (int i = 0; i < 8; ++i) {
      const double found[] = {solution->fx, solution->fy, solution->cx, solution->cy};
      const double value =
          i < 4 ? found[i] : solution->distortion.at(static_cast<std::size_t>(i - 4));
      const double off = (value - truth[i]) / solution->deviation[i];
      EXPECT_LT(std::abs(off), 5.0) << "parameter " << i << ", seed " << seed;
      sum += off * off / (8 * kSeeds);
    }
  }
  EXPECT_GT(sum, 0.6);
  EXPECT_LT(sum, 1.5);
}

TEST(Calibrate, StandardDeviationsAreThoseOfOpenCv) {
  Rng rng(3);
  const Lens lens = usual_lens();
  const auto views = good_views(lens, 12, 0.3, rng);
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> image;
  for (const View& view : views) {
    auto& points = board.emplace_back();
    auto& places = image.emplace_back();
    for (Eigen::Index i = 0; i < view.board_m.rows(); ++i) {
      points.emplace_back(static_cast<float>(view.board_m(i, 0)),
                          static_cast<float>(view.board_m(i, 1)), 0.0F);
      places.emplace_back(static_cast<float>(view.image_px(i, 0)),
                          static_cast<float>(view.image_px(i, 1)));
    }
  }
  for (const int coefficients : {4, 5}) {
    const auto solution = solve(views, size_of(lens), coefficients);
    ASSERT_TRUE(solution);
    cv::Mat matrix, distortion, rotations, translations, deviation, of_poses, errors;
    cv::calibrateCamera(board, image, {640, 480}, matrix, distortion, rotations, translations,
                        deviation, of_poses, errors, coefficients == 4 ? cv::CALIB_FIX_K3 : 0);
    // OpenCV 4.6 takes a corner as one observation, not as two: its deviations are too large.
    const double unknowns = 4 + coefficients + 6.0 * static_cast<double>(views.size());
    double corners = 0.0;
    for (const auto& points : board) corners += static_cast<double>(points.size());
    const double less = std::sqrt((corners - unknowns) / (2.0 * corners - unknowns));
    for (int i = 0; i < 4 + coefficients; ++i) {
      const double theirs = deviation.at<double>(i) * less;
      EXPECT_NEAR(solution->deviation[i], theirs, 0.05 * theirs) << i << " of " << coefficients;
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
      EXPECT_NEAR(solution->errors[v].rms_px, errors.at<double>(static_cast<int>(v)), 1e-3);
    }
  }
}

TEST(Calibrate, FindsTheCameraWithAsManyNumbersOfTheLensAsAreAskedFor) {
  Rng rng(4);
  Lens lens = usual_lens();
  for (const int coefficients : {5, 8, 0}) {
    if (coefficients == 0) lens.k1 = lens.k2 = lens.p1 = lens.p2 = 0.0;
    const auto solution = solve(good_views(lens, 18, 0.02, rng), size_of(lens), coefficients);
    ASSERT_TRUE(solution) << coefficients;
    EXPECT_EQ(solution->distortion.size(), static_cast<std::size_t>(coefficients));
    EXPECT_EQ(solution->deviation.size(), 4 + coefficients);
    EXPECT_NEAR(solution->fx, lens.fx, 0.002 * lens.fx) << coefficients;
    EXPECT_NEAR(solution->cx, lens.cx, 0.5) << coefficients;
  }
}

TEST(Calibrate, RefusesTooFewViews) {
  Rng rng(5);
  const Lens lens = usual_lens();
  EXPECT_THAT(reason({}, lens), HasSubstr("0 images show the board, and at least 8"));
  EXPECT_THAT(reason(good_views(lens, 1, 0.1, rng), lens), HasSubstr("1 image shows the board"));
  EXPECT_THAT(reason(good_views(lens, 7, 0.1, rng), lens), HasSubstr("7 images show"));
}

TEST(Calibrate, RefusesABoardThatIsAlwaysParallelToTheImage) {
  Rng rng(6);
  const Lens lens = usual_lens();
  EXPECT_THAT(reason(views_turned(lens, {0.02, -0.03}, rng), lens),
              AllOf(HasSubstr("nearly parallel to the image"), HasSubstr("turn the board by 20")));
}

TEST(Calibrate, RefusesABoardThatIsAlwaysTurnedTheSameWay) {
  Rng rng(7);
  const Lens lens = usual_lens();
  EXPECT_THAT(reason(views_turned(lens, {0.5, 0.0}, rng), lens),
              HasSubstr("the board is turned the same way"));
}

TEST(Calibrate, RefusesCornersInASmallPartOfTheImage) {
  Rng rng(8);
  const Lens lens = usual_lens();
  std::vector<View> views;
  for (int i = 0; i < 12; ++i) {
    const double tilt = i % 2 == 0 ? 0.5 : -0.5;
    views.push_back(view_at(
        lens,
        board_pose(lens, middle_m(), {0.5, 0.5}, 0.6, {i % 4 < 2 ? tilt : 0.0, 0.4 * tilt}, 0.0),
        0.05, rng));
  }
  EXPECT_THAT(reason(views, lens), AllOf(HasSubstr("% of the image, and at least 40 %"),
                                         HasSubstr("to the borders of the image")));
}

// Turned by little, with much noise.
TEST(Calibrate, RefusesWhatLeavesTheCameraUncertain) {
  Rng rng(9);
  const Lens lens = usual_lens();
  std::vector<View> views;
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector2d place(0.25 + 0.25 * (i % 3), 0.25 + 0.25 * (i / 3));
    const Eigen::Vector2d tilt_rad(i % 2 == 0 ? 0.25 : -0.25, 0.0);
    views.push_back(
        view_at(lens, board_pose(lens, middle_m(), place, 0.5, tilt_rad, 0.0), 0.6, rng));
  }
  EXPECT_THAT(reason(views, lens, 8), HasSubstr("the views determine the camera badly"));
}

TEST(Calibrate, RefusesALargeError) {
  Rng rng(10);
  const Lens lens = usual_lens();
  auto views = good_views(lens, 14, 0.1, rng);
  // The corners of another board.
  for (View& view : views) {
    for (Eigen::Index i = 0; i < view.board_m.rows(); ++i) {
      view.board_m(i, 0) += i % 2 == 0 ? 0.004 : 0.0;
    }
  }
  EXPECT_THAT(reason(views, lens), AllOf(HasSubstr("px at the corners"), HasSubstr("--squares")));
}

TEST(Calibrate, LeavesOutAViewThatDoesNotFitTheOthers) {
  Rng rng(12);
  const Lens lens = usual_lens();
  auto views = good_views(lens, 14, 0.1, rng);
  views[4].name = "bent";
  for (Eigen::Index i = 0; i < views[4].image_px.rows(); ++i) {
    views[4].image_px(i, 1) += 2.0 * std::sin(40.0 * views[4].board_m(i, 0));
  }
  const auto calibration = calibrate(views, size_of(lens), 4);
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_THAT(calibration->odd, ElementsAre("bent"));
  EXPECT_EQ(calibration->views.size(), 13U);
  EXPECT_NEAR(calibration->solution.fx, lens.fx, 0.005 * lens.fx);
}

TEST(Calibrate, ChoosesViewsThatDiffer) {
  Rng rng(13);
  const Lens lens = usual_lens();
  auto views = good_views(lens, 9, 0.05, rng);
  // A film in which the board stands still for long.
  for (int i = 0; i < 100; ++i) views.insert(views.begin() + 4, views[4]);
  const auto chosen = choose_views(views, size_of(lens), 9);
  int still = 0;
  for (const std::size_t i : chosen) still += i >= 4 && i <= 104 ? 1 : 0;
  EXPECT_EQ(chosen.size(), 9U);
  EXPECT_EQ(still, 1);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
}

TEST(Calibrate, WritesACameraFileWithErrorsAndDeviations) {
  Rng rng(14);
  const Lens lens = usual_lens();
  auto views = good_views(lens, 9, 0.1, rng);
  views[0].name = "a \"b\": c.png";
  const auto calibration = calibrate(views, size_of(lens), 4);
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_THAT(camera_text(*calibration),
              AllOf(HasSubstr("\nfx: 6"), HasSubstr("width: 640\nheight: 480\n"),
                    HasSubstr("standard_deviations: {fx: "),
                    HasSubstr(R"(- {name: "a \"b\": c.png", corners: )")));
  const auto picture = residual_picture(*calibration);
  ASSERT_TRUE(picture);
  EXPECT_TRUE(picture->starts_with("\x89PNG"));
}

}  // namespace
}  // namespace weft::calibration
