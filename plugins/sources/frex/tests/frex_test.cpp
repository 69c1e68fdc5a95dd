// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <set>
#include <stdexcept>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::testing {
namespace {

constexpr int kOpen = 0, kCount = 1, kRead = 2;

/// Small and quick, unless the test asks for more; the print is 842 x 595 px.
std::string params(const std::string& more) {
  return std::string("{texture: ") + WEFT_TEXTURES +
         "sheet_texture.png, columns: 40, rows: 28, image_width_px: 320, image_height_px: 240, "
         "focal_px: 400" +
         (more.empty() ? "" : ", ") + more + "}";
}

/// The source, opened, with one frame's outputs at a time.
class Opened {
 public:
  explicit Opened(const std::string& more = "", std::uint64_t run_seed = 1)
      : plugin_("sources/frex", params(more), run_seed) {
    const Outcome opened = plugin_.process(kOpen, {});
    if (opened.status != WEFT_OK) throw std::runtime_error(opened.message);
    camera = *opened.get<Camera>();
  }

  Outcome read(std::uint64_t frame) {
    Outcome outcome = plugin_.process(kRead, {}, frame);
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    return outcome;
  }
  std::vector<std::uint8_t> pixels(std::uint64_t frame) {
    const Array<std::uint8_t> array = read(frame).get<Image>()->pixels;
    return {array.data(), array.data() + array.size()};
  }
  GroundTruth truth(std::uint64_t frame) { return *read(frame).get<GroundTruth>(); }
  Pinhole pinhole() const { return {camera.fx, camera.fy, camera.cx, camera.cy}; }

  Camera camera;

 private:
  PluginUnderTest plugin_;
};

/// Largest |l / l0 - 1| over the edges of the true mesh, l0 measured on the template.
double worst_strain(const GroundTruth& truth) {
  Points3 flat = Points3::Zero(truth.count(), 3);
  flat.leftCols<2>() = truth.template_xy_m.matrix<2>();
  const auto topology = build_topology(truth.faces.matrix<3>(), truth.count());
  return strain_statistics(*distance_constraints(topology->edges, flat), truth.points_m.matrix<3>())
      .max;
}

/// A value of the map between the centres of four pixels, or NaN.
Eigen::Vector2d between(const Array<float>& uv_m, const Eigen::Vector2d& pixel) {
  const auto x = static_cast<std::int64_t>(std::floor(pixel.x()));
  const auto y = static_cast<std::int64_t>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= uv_m.dim(1) || y + 1 >= uv_m.dim(0)) {
    return Eigen::Vector2d::Constant(NAN);
  }
  const auto at = [&](std::int64_t i, std::int64_t j) {
    return Eigen::Vector2d(uv_m.row(j)[2 * i], uv_m.row(j)[2 * i + 1]);
  };
  const double s = pixel.x() - static_cast<double>(x), t = pixel.y() - static_cast<double>(y);
  return (1.0 - t) * ((1.0 - s) * at(x, y) + s * at(x + 1, y)) +
         t * ((1.0 - s) * at(x, y + 1) + s * at(x + 1, y + 1));
}

struct Agreement {
  double worst_px = 0.0;       ///< distance on the print
  double worst_depth_m = 0.0;  ///< depth map against the vertices
  int visible = 0, compared = 0;
};

/// The maps at the images of the visible vertices against the vertices themselves. A vertex whose
/// four pixels see other parts of the sheet, or something else, cannot be compared.
Agreement compare_maps(const GroundTruth& truth, const Pinhole& camera) {
  constexpr double kPitch_m = 0.297 / 842.0, kSameSurface_px = 12.0;
  Agreement result;
  for (std::int64_t i = 0; i < truth.count(); ++i) {
    if (truth.visible(i) == 0) continue;
    ++result.visible;
    const Eigen::Vector3d point = truth.points_m.matrix<3>().row(i).transpose();
    const Eigen::Vector2d pixel = project(camera, point);
    const Eigen::Vector2d sampled = between(truth.uv_m, pixel);
    const Eigen::Vector2d here(truth.template_xy_m(i, 0), truth.template_xy_m(i, 1));
    const double error_px = (sampled - here).norm() / kPitch_m;
    if (!(error_px < kSameSurface_px)) continue;
    ++result.compared;
    result.worst_px = std::max(result.worst_px, error_px);
    const double depth = truth.depth_m(std::lround(pixel.y()), std::lround(pixel.x()));
    result.worst_depth_m = std::max(result.worst_depth_m, std::abs(depth - point.z()));
  }
  return result;
}

class FrexPatterns : public ::testing::TestWithParam<const char*> {};

TEST_P(FrexPatterns, HaveMapsThatAgreeWithTheirVertices) {
  Opened source("period_s: 1.6, seed: 3, pattern: " + std::string(GetParam()));
  for (const std::uint64_t frame : {0, 12, 24}) {
    const GroundTruth truth = source.truth(frame);
    const Agreement maps = compare_maps(truth, source.pinhole());
    EXPECT_GT(maps.visible, 300);
    EXPECT_GT(maps.compared, 0.85 * maps.visible);
    EXPECT_LT(maps.worst_px, 0.5) << "frame " << frame;
    EXPECT_LT(maps.worst_depth_m, 0.004) << "frame " << frame;
  }
}

TEST_P(FrexPatterns, KeepTheirLengthsUnlessTheyAreElastic) {
  const bool is_elastic = std::string(GetParam()) == "bulge";
  Opened source("period_s: 1.6, seed: 4, dense_truth: false, pattern: " + std::string(GetParam()));
  double bent_m = 0.0;
  for (std::uint64_t frame = 0; frame < 40; frame += 4) {
    const GroundTruth truth = source.truth(frame);
    if (!is_elastic) {
      EXPECT_LT(worst_strain(truth), 0.002) << "frame " << frame;
    }
    EXPECT_LT(truth.diag.value("edge_strain", 1.0), 0.002) << "frame " << frame;
    EXPECT_NEAR(truth.diag.value("stretch_max", -1.0), worst_strain(truth), 1e-12);
    const auto points = truth.points_m.matrix<3>();
    const Points3 centred = points.rowwise() - points.colwise().mean();
    const double thickness = Eigen::JacobiSVD<Points3>(centred).singularValues().minCoeff() /
                             std::sqrt(static_cast<double>(points.rows()));
    bent_m = std::max(bent_m, thickness);
  }
  EXPECT_GT(bent_m, 0.003) << "the sheet stays flat";
}

INSTANTIATE_TEST_SUITE_P(All, FrexPatterns,
                         ::testing::Values("roll", "s_bend", "corner_fold", "wave", "handles",
                                           "bulge"),
                         [](const auto& pattern) { return std::string(pattern.param); });

TEST(Frex, SaysHowFarItIsStretched) {
  Opened source("stretch: 0.15, pattern: roll, period_s: 1.6, dense_truth: false");
  double most = 0.0;
  for (std::uint64_t frame = 0; frame <= 30; frame += 6) {
    const GroundTruth truth = source.truth(frame);
    EXPECT_NEAR(truth.diag.value("stretch_max", 0.0), worst_strain(truth), 1e-12);
    EXPECT_LT(truth.diag.value("edge_strain", 1.0), 0.002);
    most = std::max(most, worst_strain(truth));
  }
  EXPECT_NEAR(most, 0.15, 0.01);
}

TEST(Frex, IsFlatBeforeTheCameraAtFirst) {
  Opened source("pattern: handles");
  const GroundTruth truth = source.truth(0);
  EXPECT_EQ(truth.kind, "frex");
  ASSERT_EQ(truth.count(), 40 * 28);
  EXPECT_EQ(truth.faces.rows(), 2 * 39 * 27);
  const auto points = truth.points_m.matrix<3>();
  EXPECT_NEAR(points.col(2).minCoeff(), 0.6, 1e-12);
  EXPECT_NEAR(points.col(2).maxCoeff(), 0.6, 1e-12);
  EXPECT_NEAR(points.col(0).sum(), 0.0, 1e-9);
  EXPECT_NEAR(truth.template_xy_m(0, 0), -0.5 * 0.297 / 842.0, 1e-15);
  EXPECT_EQ(truth.visible.matrix<1>().cast<int>().sum(), 40 * 28);
}

TEST(Frex, GivesTheSameBytesInAnyOrderWhateverTheSeedOfTheRun) {
  Opened first("occluder: true, background: clutter"),
      second("occluder: true, background: clutter", 2), other("seed: 2");
  const auto early = first.pixels(2), late = first.pixels(9);
  EXPECT_EQ(second.pixels(9), late);
  EXPECT_EQ(second.pixels(2), early);
  EXPECT_EQ(first.pixels(2), early);
  EXPECT_NE(early, late);
  EXPECT_NE(other.pixels(2), early);
  const GroundTruth a = first.truth(9), b = second.truth(9);
  EXPECT_EQ(a.points_m.matrix<3>(), b.points_m.matrix<3>());
  EXPECT_EQ(std::memcmp(a.uv_m.data(), b.uv_m.data(),
                        static_cast<std::size_t>(a.uv_m.size()) * sizeof(float)),
            0);
}

TEST(Frex, ShowsTheBackgroundInGapsAndStillKnowsTheTruth) {
  Opened gap("invisible_frames: [3], noise_grey: 0"), whole("noise_grey: 0");
  EXPECT_NE(gap.pixels(3), whole.pixels(3));
  EXPECT_EQ(gap.pixels(4), whole.pixels(4));
  const GroundTruth hidden = gap.truth(3);
  EXPECT_EQ(hidden.points_m.matrix<3>(), whole.truth(3).points_m.matrix<3>());
  EXPECT_EQ(hidden.visible.matrix<1>().cast<int>().sum(), 0);
  EXPECT_EQ(hidden.depth_m(120, 160), 0.0F);
  EXPECT_TRUE(std::isnan(hidden.uv_m.row(120)[320]));
}

TEST(Frex, MovesSmoothlyButForItsCuts) {
  Opened source("cut_frames: [4], pattern: wave, dense_truth: false");
  Points3 before = source.truth(0).points_m.matrix<3>();
  for (std::uint64_t frame = 1; frame < 8; ++frame) {
    const Points3 now = source.truth(frame).points_m.matrix<3>();
    const double step_m = (now - before).rowwise().norm().maxCoeff();
    if (frame == 4) {
      EXPECT_GT(step_m, 0.02);
    } else {
      EXPECT_LT(step_m, 0.02) << "frame " << frame;
    }
    before = now;
  }
}

TEST(Frex, HidesVerticesBehindTheOccluder) {
  Opened free("pattern: bulge, period_s: 2"), hidden("pattern: bulge, period_s: 2, occluder: true");
  const auto seen = [](const GroundTruth& truth) {
    return truth.visible.matrix<1>().cast<int>().sum();
  };
  int fewest = 40 * 28;
  for (std::uint64_t frame = 0; frame < 30; frame += 6) {
    EXPECT_LE(seen(hidden.truth(frame)), seen(free.truth(frame)));
    fewest = std::min(fewest, seen(hidden.truth(frame)));
  }
  EXPECT_LT(fewest, 0.95 * 40 * 28);
}

TEST(Frex, HasTheNoiseThatIsAsked) {
  Opened clean("noise_grey: 0"), noisy("noise_grey: 3");
  const auto a = clean.pixels(1), b = noisy.pixels(1);
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] < 20 || a[i] > 235) continue;
    const double difference = static_cast<double>(b[i]) - static_cast<double>(a[i]);
    sum += difference;
    squares += difference * difference;
    ++count;
  }
  ASSERT_GT(count, 50000);
  EXPECT_NEAR(std::sqrt(squares / count), std::sqrt(9.0 + 1.0 / 6.0), 0.06);
  EXPECT_NEAR(sum / count, 0.0, 0.06);
}

std::string refusal(const std::string& text) {
  try {
    PluginUnderTest plugin("sources/frex", text);
    const Outcome opened = plugin.process(kOpen, {});
    return opened.status == WEFT_OK ? "" : opened.message;
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(Frex, SaysWhatIsWrongWithItsParameters) {
  const auto expect_named = [](const std::string& text, const char* name) {
    EXPECT_NE(refusal(text).find(name), std::string::npos) << refusal(text);
  };
  expect_named("{texture: /nowhere/sheet.png}", "/nowhere/sheet.png");
  expect_named("{}", "texture");
  expect_named(params("cut_frames: [60]"), "from 0 to 59");
  expect_named(params("invisible_frames: [2.5]"), "whole numbers");
  expect_named(params("background: image"), "background_image");
  expect_named(params(std::string("background_image: ") + WEFT_TEXTURES + "sole_texture.png"),
               "background: image");
  expect_named(params("stretch: 0.3"), "stretch");
  expect_named(params("pattern: rolled"), "rolled");
}

TEST(Frex, RefusesFramesItDoesNotHaveAndToReadBeforeItIsOpen) {
  PluginUnderTest source("sources/frex", params("frames: 3"));
  EXPECT_EQ(source.process(kRead, {}, 0).status, WEFT_ERROR);
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  EXPECT_EQ(source.process(kCount, {}).get<Count>()->frames, 3);
  EXPECT_EQ(source.process(kRead, {}, 2).status, WEFT_OK);
  EXPECT_EQ(source.process(kRead, {}, 3).status, WEFT_ERROR);
}

}  // namespace
}  // namespace weft::testing
