// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <iostream>
#include <numbers>
#include <weft/data/matrix.hpp>

#include "common/outline/mask_outline.hpp"
#include "common/outline/rim.hpp"
#include "energy.hpp"
#include "mask_scene.hpp"
#include "outline/outline_start.hpp"

namespace weft::gauss_newton {
namespace {

using solvers::ContourPoint;
using solvers::RimFinder;
using solvers::RimPoint;

using testing::PluginUnderTest;

TEST(MaskOutline, IsWhereTheDiscEndsInEveryDirection) {
  const Camera camera = testing::make_camera();
  MaskOutline outline;
  const ObjectMask mask = disc_mask(camera, 300.25, 220.6, 90.0);
  ASSERT_TRUE(outline.read(mask, camera));
  for (int k = 0; k < 36; ++k) {
    const double angle = std::numbers::pi * k / 18.0;
    const Eigen::Vector2d outwards(std::cos(angle), std::sin(angle));
    for (const double off_px : {0.0, 1.0, -1.0, 8.0, -8.0}) {
      const Eigen::Vector2d place = Eigen::Vector2d(300.25, 220.6) + (90.0 + off_px) * outwards;
      const auto crossing = outline.cross(place, outwards, 10.0);
      ASSERT_EQ(crossing.found, MaskOutline::Found::crossing) << k << ", " << off_px;
      EXPECT_NEAR(crossing.distance_px, -off_px, 0.2) << k;
    }
    // Beyond the reach, and where the object begins instead of ending.
    const Eigen::Vector2d far = Eigen::Vector2d(300.25, 220.6) + 105.0 * outwards;
    EXPECT_EQ(outline.cross(far, outwards, 10.0).found, MaskOutline::Found::none);
    const Eigen::Vector2d there = Eigen::Vector2d(300.25, 220.6) + 92.0 * outwards;
    EXPECT_EQ(outline.cross(there, -outwards, 10.0).found, MaskOutline::Found::none);
  }
  EXPECT_NEAR(static_cast<double>(outline.contour().size()), 2.0 * std::numbers::pi * 90.0 / 8.0,
              25.0);
  for (const ContourPoint& point : outline.contour()) {
    const Eigen::Vector2d from = point.place_px - Eigen::Vector2d(300.25, 220.6);
    EXPECT_NEAR(from.norm(), 90.0, 0.6);
    EXPECT_GT(from.normalized().dot(point.outwards), 0.98);
  }
}

TEST(MaskOutline, SaysNothingNextToUnknownPixelsAndOnTheBorderOfTheImage) {
  const Camera camera = testing::make_camera();
  ObjectMask mask = disc_mask(camera, 40.0, 220.0, 90.0);
  for (std::int64_t y = 0; y < 220; ++y) std::fill_n(mask.known.row(y), camera.width_px, 0);
  MaskOutline outline;
  ASSERT_TRUE(outline.read(mask, camera));
  const Eigen::Vector2d up(0.0, -1.0), right(1.0, 0.0), left(-1.0, 0.0);
  EXPECT_EQ(outline.cross({40.0, 133.0}, up, 10.0).found, MaskOutline::Found::unknown);
  EXPECT_EQ(outline.cross({3.0, 240.0}, left, 10.0).found, MaskOutline::Found::unknown);
  EXPECT_EQ(outline.cross({126.0, 240.0}, right, 10.0).found, MaskOutline::Found::crossing);
  for (const ContourPoint& point : outline.contour()) {
    EXPECT_GT(point.place_px.y(), 220.0);
    EXPECT_GT(point.place_px.x(), 1.0);
  }
}

TEST(MaskOutline, OfAnotherSizeThanTheImageIsAnError) {
  const Camera camera = testing::make_camera();
  Camera other = camera;
  other.width_px -= 1;
  MaskOutline outline;
  const ObjectMask mask = disc_mask(camera, 300.0, 200.0, 20.0);
  const auto read = outline.read(mask, other);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, Errc::invalid_data);
  EXPECT_FALSE(outline.present());
}

TEST(RimFinder, FindsTheBorderOfASheetWithNormalsThatLeaveIt) {
  const Scene scene = Scene::flat();
  MeshModel mesh;
  ASSERT_TRUE(mesh.build(scene.templ, 0.0));
  RimFinder finder;
  finder.prepare(mesh.faces, mesh.vertex_count());
  const Pinhole camera = testing::pinhole(scene.camera);
  const auto& rim = finder.find(camera, 640, 480, scene.truth_m, {});
  const double around_px = 2.0 * 817.0 * (0.297 + 0.192) / 0.6;
  EXPECT_NEAR(static_cast<double>(rim.size()), around_px / 4.0, 0.1 * around_px / 4.0);
  const Eigen::Vector2d centre(scene.camera.cx, scene.camera.cy);
  for (const RimPoint& point : rim) {
    EXPECT_GT((point.place_px - centre).dot(point.outwards), 100.0);
    EXPECT_NEAR(std::abs(point.outwards.x()) + std::abs(point.outwards.y()), 1.0, 1e-9);
  }
}

TEST(RimFinder, OmitsBordersBeforeOrBehindTheSheetAndCoveredOnes) {
  Scene scene = Scene::flat();
  MeshModel mesh;
  ASSERT_TRUE(mesh.build(scene.templ, 0.0));
  RimFinder finder;
  finder.prepare(mesh.faces, mesh.vertex_count());
  const Pinhole camera = testing::pinhole(scene.camera);
  // The right third is folded over to the left, a little nearer to the camera.
  const double fold_m = scene.truth_m(6, 0);
  Points3 folded = scene.truth_m;
  for (Eigen::Index v = 0; v < folded.rows(); ++v) {
    if (folded(v, 0) <= fold_m + 1e-9) continue;
    folded(v, 0) = 2.0 * fold_m - folded(v, 0);
    folded(v, 2) -= 0.004;
  }
  const double fold_px = camera.fx * fold_m / 0.6 + camera.cx;
  bool has_fold = false;
  for (const RimPoint& point : finder.find(camera, 640, 480, folded, {})) {
    // The folded border is seen before the surface: no rim. The fold is one.
    const bool is_upright = std::abs(point.outwards.x()) > 0.9;
    if (!is_upright) continue;
    EXPECT_TRUE(point.place_px.x() < 150.0 || point.place_px.x() > fold_px - 3.0)
        << point.place_px.transpose();
    has_fold = has_fold || point.place_px.x() > fold_px - 3.0;
  }
  EXPECT_TRUE(has_fold);
  std::vector<std::uint8_t> covered(60, 0);
  for (Eigen::Index v = 0; v < 60; ++v) covered[to_index(v)] = scene.truth_m(v, 0) < 0.0 ? 1 : 0;
  for (const RimPoint& point : finder.find(camera, 640, 480, scene.truth_m, covered)) {
    EXPECT_GT(point.place_px.x(), 280.0);
  }
}

/// A bent surface, its mask, and a shape near it.
struct Nearby {
  static constexpr std::uint64_t kShapeSeed = 5;
  MaskedSheet sheet{0.25, {0.6, 0.0, 0.0, 0.2, -0.1}};
  MeshModel mesh;
  FrameData frame;
  Expectation expected;
  Scales scales;
  Energy energy;
  Points3 vertices_m = sheet.scene.truth_m;

  Nearby() {
    std::cout << "seed " << kShapeSeed << "\n";
    if (!mesh.build(sheet.scene.templ, 0.0)) throw std::runtime_error("the template is no mesh");
    if (!frame.outline.read(sheet.mask, sheet.scene.camera)) throw std::runtime_error("no mask");
    frame.camera = testing::pinhole(sheet.scene.camera);
    for (const Hinge& hinge : mesh.hinges) expected.bends_rad.push_back(hinge.rest_rad);
    scales.strain = 1e3;
    scales.pair_strain = scales.bend_rad = 0.0;
    energy.prepare(mesh);
  }
  void jitter() {
    Rng rng(kShapeSeed);
    for (Eigen::Index k = 0; k < vertices_m.size(); ++k)
      vertices_m.data()[k] += 1e-3 * rng.normal();
  }
  void meet() {
    energy.follow(vertices_m);
    energy.meet_outline(frame, scales, vertices_m);
  }
  double energy_at(const Points3& at_m) { return energy.value(frame, expected, scales, at_m); }
};

TEST(OutlineTerm, ItsGradientIsThatOfFiniteDifferences) {
  Nearby near;
  near.jitter();
  near.meet();
  ASSERT_GT(near.energy.outline().points().size(), 200U);
  Points3 gradient(60, 3);
  BlockMatrix matrix;
  matrix.diagonal.resize(60);
  matrix.coupling.resize(near.mesh.couplings.size());
  const double here = near.energy.linearise(near.frame, near.expected, near.scales, near.vertices_m,
                                            gradient, matrix);
  EXPECT_DOUBLE_EQ(here, near.energy_at(near.vertices_m));
  constexpr double kStep_m = 1e-6;
  for (Eigen::Index k = 0; k < gradient.size(); ++k) {
    const auto at = [&](double steps) {
      Points3 moved = near.vertices_m;
      moved.data()[k] += steps * kStep_m;
      return near.energy_at(moved);
    };
    // Half of the difference of fourth order.
    const double half =
        0.5 * (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * kStep_m);
    EXPECT_NEAR(gradient.data()[k], half, 1e-6 * gradient.cwiseAbs().maxCoeff()) << k;
  }
}

TEST(OutlineTerm, CostsNearlyNothingAtTheTruthAndOneSquarePerDeviationBesideIt) {
  Nearby near;
  near.meet();
  const auto& points = near.energy.outline().points();
  double weights = 0.0;
  for (const OutlinePoint& point : points) weights += point.share;
  EXPECT_LT(near.energy_at(near.vertices_m), 0.05 * weights);
  EXPECT_GT(near.energy.outline().met_share(), 0.97);
  // All points one pixel outwards: residuals of 1 / noise_px.
  near.scales.outline.outlier_px = 1e4;
  near.meet();
  double squares = 0.0;
  for (const OutlinePoint& point : near.energy.outline().points()) {
    const Eigen::Vector2d shown = project(
        near.frame.camera, near.energy.surface_point_m(near.vertices_m, point.face, point.weights));
    const double off_px = point.normal.dot(shown + point.normal) - point.offset_px;
    squares += point.share * std::pow(off_px / near.scales.outline.noise_px, 2);
  }
  EXPECT_NEAR(squares, weights / std::pow(near.scales.outline.noise_px, 2), 0.2 * squares);
}

TEST(OutlineTerm, PullsARimOutwardsThatLiesWithinTheMask) {
  Nearby near;
  near.vertices_m *= 1.02;  // further away, hence smaller
  near.meet();
  const double further = near.energy_at(near.vertices_m);
  EXPECT_LT(near.energy_at(near.vertices_m / 1.01), further);
}

TEST(OutlineTerm, IsLighterThanTheMatches) {
  Nearby near;
  for (Eigen::Index f = 0; f < near.mesh.faces.rows(); ++f) {
    Observation seen;
    seen.weights = {0.3, 0.3, 0.4};
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) {
      point += seen.weights[to_index(k)] * near.vertices_m.row(near.mesh.faces(f, k)).transpose();
    }
    const Eigen::Vector2d pixel = project(near.frame.camera, point);
    seen.seen_px = {pixel.x(), pixel.y()};
    seen.white = Whitening::of_deviation(4.0);
    near.frame.faces.push_back({static_cast<std::int32_t>(f), near.frame.observations.size(),
                                near.frame.observations.size() + 1});
    near.frame.observations.push_back(seen);
  }
  near.meet();
  const auto trace_of = [&](bool of_outline) {
    BlockMatrix matrix;
    matrix.diagonal.assign(60, Eigen::Matrix3d::Zero());
    matrix.coupling.assign(near.mesh.couplings.size(), Eigen::Matrix3d::Zero());
    if (of_outline) {
      near.energy.add_outline(near.frame, near.scales, near.vertices_m, matrix);
    } else {
      near.energy.add_observations(near.frame, near.scales, near.vertices_m, matrix);
    }
    double trace = 0.0;
    for (const Eigen::Matrix3d& block : matrix.diagonal) trace += block.trace();
    return trace;
  };
  EXPECT_LT(near.energy.outline().share, 1.0);
  EXPECT_NEAR(trace_of(true), 0.5 * trace_of(false), 1e-6 * trace_of(false));
}

TEST(OutlineStart, LaysTheTemplateIntoTheMask) {
  const MaskedSheet sheet(1e9, {0.6, 0.02, -0.03, 0.0, 0.0, 0.3});
  MeshModel mesh;
  ASSERT_TRUE(mesh.build(sheet.scene.templ, 0.0));
  const auto start = outline_start(sheet.mask, testing::pinhole(sheet.scene.camera), mesh);
  ASSERT_TRUE(start);
  EXPECT_LT(sheet.scene.mean_error_m(*start), 0.002);
}

TEST(OutlinePose, IsTheTemplateLaidIntoTheMask) {
  const MaskedSheet sheet(1e9, {0.6, 0.02, -0.03, 0.0, 0.0, 0.3});
  PluginUnderTest solver("solvers/outline_pose");
  const auto out = solver.process(
      0, {testing::input("template", sheet.scene.templ),
          testing::input("camera", sheet.scene.camera), testing::input("object_mask", sheet.mask)});
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const Shape shape = *out.get<Shape>();
  EXPECT_LT(sheet.scene.mean_error_m(shape), 0.002);
  EXPECT_EQ(shape.shape_state(), ShapeState::weak);
}

/// The solver, given a mask.
struct Masked {
  PluginUnderTest plugin;
  explicit Masked(const std::string& params) : plugin(kId, params) {}

  testing::PluginAnswer run(const Scene& scene, const ObjectMask* mask,
                            const Correspondences* matches, const Shape* previous = nullptr) {
    std::vector<testing::Input> inputs{testing::input("template", scene.templ),
                                       testing::input("camera", scene.camera)};
    if (matches != nullptr) inputs.push_back(testing::input("correspondences", *matches));
    if (mask != nullptr) inputs.push_back(testing::input("object_mask", *mask));
    if (previous != nullptr) inputs.push_back(testing::input("previous.shape", *previous));
    return plugin.process(0, inputs);
  }
};

/// Matches on the left third of the surface.
Correspondences matches_on_the_left(const Scene& scene, const DevelopableSheet& sheet,
                                    std::uint64_t seed) {
  std::cout << "seed " << seed << "\n";
  Rng rng(seed);
  Correspondences all =
      testing::draw_matches(scene.templ, scene.camera, sheet, {.count = 400, .noise_px = 0.3}, rng)
          .matches;
  for (std::int64_t i = 0; i < all.count(); ++i) {
    if (all.template_px(i, 0) > 320.0) all.kept(i) = 0;
  }
  return all;
}

TEST(GaussNewtonOutline, OfWeightZeroChangesNoBit) {
  const MaskedSheet sheet(0.25);
  const auto smooth = testing::make_cylinder(reference_sheet(), 0.25, 0.3, {0.6});
  const Correspondences matches = matches_on_the_left(sheet.scene, smooth, 3);
  Masked without("{}"), with("{outline_weight: 0}");
  const Shape a = *without.run(sheet.scene, nullptr, &matches).get<Shape>();
  const Shape b = *with.run(sheet.scene, &sheet.mask, &matches).get<Shape>();
  ASSERT_EQ(a.vertices_m.size(), b.vertices_m.size());
  EXPECT_EQ(std::memcmp(a.vertices_m.data(), b.vertices_m.data(),
                        to_index(a.vertices_m.size()) * sizeof(double)),
            0);
}

TEST(GaussNewtonOutline, FindsThePartWithoutMatches) {
  for (const double radius_m : {0.25, -0.25, 0.4}) {
    const testing::PoseSpec pose{0.6, 0.0, 0.0, 0.2, 0.1};
    const MaskedSheet sheet(radius_m, pose);
    const auto smooth = testing::make_cylinder(reference_sheet(), radius_m, 0.3, pose);
    const Correspondences matches = matches_on_the_left(sheet.scene, smooth, 3);
    Masked solver("{}");
    const double without =
        sheet.scene.mean_error_m(*solver.run(sheet.scene, nullptr, &matches).get<Shape>());
    const double with =
        sheet.scene.mean_error_m(*solver.run(sheet.scene, &sheet.mask, &matches).get<Shape>());
    std::cout << "radius " << radius_m << " m: " << 1e3 * without << " mm without, " << 1e3 * with
              << " mm with\n";
    EXPECT_LT(with, 0.6 * without);
  }
}

TEST(GaussNewtonOutline, AloneGivesAShapeThatIsWeak) {
  const MaskedSheet sheet(0.4, {0.6, 0.0, 0.0, 0.1, 0.1});
  Masked refuses("{}"), solver("{outline_alone: true}");
  Correspondences none = matches_on_the_left(
      sheet.scene, testing::make_cylinder(reference_sheet(), 0.4, 0.3, {0.6}), 3);
  std::fill_n(none.kept.data(), none.count(), std::uint8_t{0});
  EXPECT_EQ(refuses.run(sheet.scene, &sheet.mask, &none).status, WEFT_NO_RESULT);
  const Shape near = shape_of(Scene::flat({0.58}).truth_m);
  const auto out = solver.run(sheet.scene, &sheet.mask, &none, &near);
  ASSERT_EQ(out.status, WEFT_OK) << out.message;
  const Shape shape = *out.get<Shape>();
  std::cout << 1e3 * sheet.scene.mean_error_m(shape) << " mm\n";
  EXPECT_LT(sheet.scene.mean_error_m(shape), 0.010);
  EXPECT_EQ(shape.shape_state(), ShapeState::weak);
  EXPECT_TRUE(shape.covariance_m2.present());
}

TEST(GaussNewtonOutline, IgnoresUnknownPixels) {
  const testing::PoseSpec pose{0.6, 0.0, 0.0, 0.2, 0.1};
  MaskedSheet sheet(0.25, pose);
  const auto smooth = testing::make_cylinder(reference_sheet(), 0.25, 0.3, pose);
  const Correspondences matches = matches_on_the_left(sheet.scene, smooth, 3);
  Masked solver("{}");
  const double with =
      sheet.scene.mean_error_m(*solver.run(sheet.scene, &sheet.mask, &matches).get<Shape>());
  // An occluder hides the lower third of the surface.
  for (std::int64_t y = 300; y < 480; ++y) {
    for (std::int64_t x = 0; x < 640; ++x) {
      if (y >= 310) sheet.mask.foreground(y, x) = 0;
      sheet.mask.known(y, x) = 0;
    }
  }
  const double part =
      sheet.scene.mean_error_m(*solver.run(sheet.scene, &sheet.mask, &matches).get<Shape>());
  const double without =
      sheet.scene.mean_error_m(*solver.run(sheet.scene, nullptr, &matches).get<Shape>());
  std::cout << 1e3 * with << " mm whole, " << 1e3 * part << " mm in part, " << 1e3 * without
            << " mm without\n";
  EXPECT_LT(part, without);
}

}  // namespace
}  // namespace weft::gauss_newton
