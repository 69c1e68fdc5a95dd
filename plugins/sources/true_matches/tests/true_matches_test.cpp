// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/types.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::testing {
namespace {

constexpr int kOpen = 0, kRead = 2;
constexpr double kFocal_px = 150.0, kDistance_m = 0.5;

/// A small film of a surface, which is flat and faces the camera in frame 0, with matches.
class Film {
 public:
  explicit Film(const std::string& params, const std::string& source = "sources/frex",
                const std::string& more = "")
      : plugin_("sources/true_matches",
                "{frames: {use: " + source +
                    ", params: {texture: " WEFT_TEXTURES
                    "sheet_texture.png, image_width_px: 120, image_height_px: 90, focal_px: 150, "
                    "distance_m: 0.5, frames: 4, fps: 5" +
                    more + "}}, " + params + "}") {
    const PluginAnswer opened = plugin_.process(kOpen, {});
    if (opened.status != WEFT_OK) throw std::runtime_error(opened.message);
    camera_ = opened.get<Camera>().value();
  }

  const Camera& camera() const { return camera_; }
  PluginAnswer read(std::uint64_t frame) { return plugin_.process(kRead, {}, frame); }

  Correspondences matches(std::uint64_t frame) {
    return read(frame).get<Correspondences>().value();
  }

  /// Image points less true ones, [N,2] px.
  Points2 errors_px(std::uint64_t frame) {
    const PluginAnswer answer = read(frame);
    return answer.get<Correspondences>()->image_px.matrix<2>() -
           answer.get<GroundTruth>()->match_xy_px.matrix<2>();
  }

 private:
  PluginUnderTest plugin_;
  Camera camera_{};
};

/// The image points of template points [N,2] m on the flat surface, px.
Points2 flat_image_px(const Points2& xy_m, const GroundTruth& truth) {
  const auto flat_m = truth.template_xy_m.matrix<2>();
  const Eigen::RowVector2d middle_m =
      0.5 * (flat_m.colwise().minCoeff() + flat_m.colwise().maxCoeff());
  const Points2 from_middle_px = kFocal_px / kDistance_m * (xy_m.rowwise() - middle_m);
  return from_middle_px.rowwise() + Eigen::RowVector2d(59.5, 44.5);
}

TEST(TrueMatches, LieWhereAFlatSheetShowsTheirTemplatePoints) {
  for (const std::string source : {"sources/frex", "sources/synthetic"}) {
    Film film("matches: 200", source);
    const PluginAnswer frame = film.read(0);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    EXPECT_TRUE(frame.get<Image>() && frame.get<Time>());
    const auto matches = frame.get<Correspondences>().value();
    ASSERT_EQ(matches.count(), 200);
    const Points2 expected =
        flat_image_px(matches.template_xy_m.matrix<2>(), frame.get<GroundTruth>().value());
    EXPECT_LT((matches.image_px.matrix<2>() - expected).cwiseAbs().maxCoeff(), 0.02) << source;
    EXPECT_LT(film.errors_px(0).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(TrueMatches, LieAtTheTruePointsWhereTheyAreAskedFor) {
  Film film("places: true_points");
  const PluginAnswer answer = film.read(2);
  const auto matches = answer.get<Correspondences>().value();
  const auto truth = answer.get<GroundTruth>().value();
  ASSERT_GT(matches.count(), 0);
  std::int64_t found = 0;
  for (std::int64_t t = 0; t < truth.count() && found < matches.count(); ++t) {
    if (truth.template_xy_m.matrix<2>().row(t) != matches.template_xy_m.matrix<2>().row(found)) {
      continue;
    }
    const Eigen::Vector3d point_m = truth.points_m.matrix<3>().row(t).transpose();
    const Camera& camera = film.camera();
    EXPECT_NEAR(matches.image_px(found, 0), camera.fx * point_m.x() / point_m.z() + camera.cx,
                1e-9);
    EXPECT_NEAR(matches.image_px(found, 1), camera.fy * point_m.y() / point_m.z() + camera.cy,
                1e-9);
    ++found;
  }
  EXPECT_EQ(found, matches.count()) << "each match is at a true point, in their order";
}

TEST(TrueMatches, FewAreTheFirstOfManyWhateverTheNoise) {
  Film few("matches: 20, noise_px: 1, seed: 3"), many("matches: 90, noise_px: 2, seed: 3");
  Film other("matches: 20, noise_px: 1, seed: 4");
  const auto first = few.matches(2), all = many.matches(2);
  ASSERT_EQ(all.count(), 90);
  EXPECT_EQ(Points2(first.template_xy_m.matrix<2>()),
            Points2(all.template_xy_m.matrix<2>().topRows(20)));
  EXPECT_LT((2.0 * few.errors_px(2) - many.errors_px(2).topRows(20)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NE(Points2(first.template_xy_m.matrix<2>()),
            Points2(other.matches(2).template_xy_m.matrix<2>()));
  EXPECT_EQ(few.errors_px(2), few.errors_px(2));
}

TEST(TrueMatches, HaveNoiseOfTheStatedSize) {
  std::cout << "seed 7\n";
  Film film("matches: 500, noise_px: 3, seed: 7");
  double sum2 = 0.0;
  for (std::uint64_t frame = 0; frame < 4; ++frame) sum2 += film.errors_px(frame).squaredNorm();
  EXPECT_NEAR(std::sqrt(sum2 / 4000.0), 3.0, 0.14);  // four standard errors
}

/// Share of the matches whose nearest true point is not visible.
double share_on_hidden(const Correspondences& matches, const GroundTruth& truth) {
  double hidden = 0.0;
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    const Eigen::RowVector2d xy_m = matches.template_xy_m.matrix<2>().row(n);
    Eigen::Index nearest = 0;
    (truth.template_xy_m.matrix<2>().rowwise() - xy_m).rowwise().norm().minCoeff(&nearest);
    hidden += truth.visible(nearest) == 0 ? 1.0 : 0.0;
  }
  return hidden / static_cast<double>(matches.count());
}

TEST(TrueMatches, ACoverHidesItsShareOfThePointsAndAllMatchesThere) {
  Film film("matches: 150, covered: 0.4"), open("matches: 150");
  const auto truth = film.read(0).get<GroundTruth>().value();
  double seen = 0.0;
  for (std::int64_t t = 0; t < truth.count(); ++t) seen += truth.visible(t);
  EXPECT_NEAR(seen / static_cast<double>(truth.count()), 0.6, 0.03);
  ASSERT_EQ(film.matches(0).count(), 150);
  EXPECT_LT(share_on_hidden(film.matches(0), truth), 0.05);  // only along the border of the cover
  EXPECT_GT(share_on_hidden(open.matches(0), truth), 0.25);
}

TEST(TrueMatches, ACoverIsGreyInTheImageAndTheBackgroundStays) {
  Film film("matches: 10, covered: 0.4"), open("matches: 10");
  const PluginAnswer frame = film.read(1);
  const auto truth = frame.get<GroundTruth>().value();
  const auto image = frame.get<Image>().value(), before = open.read(1).get<Image>().value();
  double sheet = 0.0, changed = 0.0;
  const std::int64_t channels = image.pixels.dim(2);
  for (std::int64_t v = 0; v < image.pixels.dim(0); ++v) {
    for (std::int64_t u = 0; u < image.pixels.dim(1); ++u) {
      const int now = image.pixels(v, channels * u);
      const bool differs = now != before.pixels(v, channels * u);
      const bool on_sheet = !std::isnan(truth.uv_m.row(v)[2 * u]);
      EXPECT_TRUE(!differs || (on_sheet && now == 110)) << u << ' ' << v;
      sheet += on_sheet ? 1.0 : 0.0;
      changed += differs ? 1.0 : 0.0;
    }
  }
  EXPECT_NEAR(changed / sheet, 0.4, 0.08);
}

TEST(TrueMatches, AWrongCameraIsStatedAndChangesNothingElse) {
  Film wrong("matches: 30, focal_error: 0.1, center_error_px: -4"), right("matches: 30");
  EXPECT_NEAR(wrong.camera().fx, 165.0, 1e-9);
  EXPECT_NEAR(wrong.camera().fy, 165.0, 1e-9);
  EXPECT_NEAR(wrong.camera().cx, 55.5, 1e-9);
  EXPECT_NEAR(wrong.camera().cy, 40.5, 1e-9);
  EXPECT_EQ(right.camera().fx, 150.0);
  EXPECT_EQ(Points2(wrong.matches(3).image_px.matrix<2>()),
            Points2(right.matches(3).image_px.matrix<2>()));
  const PluginAnswer one = wrong.read(3), two = right.read(3);
  EXPECT_EQ(Points3(one.get<GroundTruth>()->points_m.matrix<3>()),
            Points3(two.get<GroundTruth>()->points_m.matrix<3>()));
}

TEST(TrueMatches, WhatIsNotInSightHasNone) {
  EXPECT_EQ(Film("matches: 0").matches(0).count(), 0);
  EXPECT_EQ(Film("matches: 10, covered: 1").matches(0).count(), 0);
  // At this distance the image shows only a part of the surface.
  Film near("matches: 40", "sources/synthetic", ", width_m: 1.0");
  const Points2 image_px = near.matches(0).image_px.matrix<2>();
  ASSERT_EQ(image_px.rows(), 40);
  EXPECT_GE(image_px.minCoeff(), -0.5);
  EXPECT_LE(image_px.col(0).maxCoeff(), 119.5);
  EXPECT_LE(image_px.col(1).maxCoeff(), 89.5);
  EXPECT_EQ(near.read(1000).status, WEFT_ERROR);
}

}  // namespace
}  // namespace weft::testing
