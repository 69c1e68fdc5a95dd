// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/data/known_points.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/types.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::testing {
namespace {

constexpr int kOpen = 0, kRead = 2;

/// A film of a tiny surface, held by grippers.
class GrippedSheet {
 public:
  explicit GrippedSheet(const std::string& params)
      : plugin_("sources/grippers",
                "{frames: {use: sources/synthetic, params: {texture: " WEFT_TEXTURES
                "sheet_texture.png, image_width_px: 64, image_height_px: 48, focal_px: 80}}, " +
                    params + "}") {
    const PluginAnswer opened = plugin_.process(kOpen, {});
    if (opened.status != WEFT_OK) throw std::runtime_error(opened.message);
  }

  PluginAnswer read(std::uint64_t frame) { return plugin_.process(kRead, {}, frame); }

 private:
  PluginUnderTest plugin_;
};

/// The difference of each gripper from the ground truth [P,3], mm; it must have a true point of the
/// template.
Points3 errors_mm(const PluginAnswer& frame) {
  const KnownPoints known = frame.get<KnownPoints>().value();
  const GroundTruth truth = frame.get<GroundTruth>().value();
  Points3 errors(known.count(), 3);
  for (std::int64_t p = 0; p < known.count(); ++p) {
    const Eigen::VectorXd distance_m =
        (truth.template_xy_m.matrix<2>().rowwise() - known.template_xy_m.matrix<2>().row(p))
            .rowwise()
            .norm();
    Eigen::Index nearest = 0;
    EXPECT_EQ(distance_m.minCoeff(&nearest), 0.0);
    EXPECT_EQ(known.vertex(p), -1);
    errors.row(p) =
        1e3 * (known.points_m.matrix<3>().row(p) - truth.points_m.matrix<3>().row(nearest));
  }
  return errors;
}

TEST(Grippers, HoldThePlacesThatTheyAreNamedFor) {
  GrippedSheet gripped("count: 8, radius_mm: 3");
  const PluginAnswer frame = gripped.read(20);
  ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
  EXPECT_TRUE(frame.get<Image>() && frame.get<Time>());
  EXPECT_EQ(errors_mm(frame).cwiseAbs().maxCoeff(), 0.0);
  const auto known = frame.get<KnownPoints>().value();
  const auto xy_m = known.template_xy_m.matrix<2>();
  EXPECT_NEAR(xy_m(1, 0) - xy_m(0, 0), 0.297, 1e-9);
  EXPECT_EQ(xy_m(1, 1), xy_m(0, 1));
  EXPECT_EQ(xy_m(2, 0), xy_m(3, 0));
  EXPECT_EQ(xy_m(4, 0), xy_m(0, 0));
  EXPECT_EQ(xy_m(4, 1), xy_m(2, 1));
  EXPECT_NEAR(known.radius_m(7), 0.003, 1e-15);
}

TEST(Grippers, AnOffsetIsOneForAllAndNoiseIsNot) {
  GrippedSheet gripped("count: 4, offset_mm: 5, seed: 7"), other("count: 4, offset_mm: 5, seed: 8");
  const Points3 first = errors_mm(gripped.read(0)), later = errors_mm(gripped.read(33));
  EXPECT_NEAR(first.row(0).norm(), 5.0, 1e-9);
  EXPECT_LT((first.rowwise() - first.row(0)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((later - first).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT((errors_mm(other.read(0)) - first).cwiseAbs().maxCoeff(), 0.1);

  GrippedSheet noisy("count: 8, noise_mm: 2, seed: 7");
  std::cout << "seed 7\n";
  double sum2 = 0.0;
  for (const std::uint64_t frame : {0U, 5U, 9U, 30U}) {
    const Points3 errors = errors_mm(noisy.read(frame));
    EXPECT_EQ(errors, errors_mm(noisy.read(frame)));
    sum2 += errors.squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(sum2 / 96.0), 2.0, 0.6);  // four standard errors
}

TEST(Grippers, NoneMakesNoPointsAndFramesThatFailFailHere) {
  GrippedSheet gripped("count: 0");
  EXPECT_FALSE(gripped.read(0).get<KnownPoints>());
  EXPECT_TRUE(gripped.read(0).get<GroundTruth>());
  EXPECT_EQ(gripped.read(1000).status, WEFT_ERROR);
}

}  // namespace
}  // namespace weft::testing
