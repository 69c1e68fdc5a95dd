// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/testing/plugin_under_test.hpp>

#include "solid_scene.hpp"

namespace weft::volume {
namespace {

constexpr double kBend_rad = M_PI / 3.0;

Eigen::Vector3d bent_block(const Eigen::Vector3d& at_m) {
  return bent(at_m, 0.15, 0.04, kBend_rad);
}

Eigen::Vector3d at_rest(const Eigen::Vector3d& at_m) { return at_m; }

/// Mean distances from the truth in mm.
struct Errors {
  double visible_mm = 0.0, hidden_mm = 0.0;

  Errors(const SolidScene& scene, const Shape& shape) {
    double seen = 0.0, hidden = 0.0;
    const auto vertices_m = shape.vertices_m.matrix<3>();
    for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
      const double off_mm = 1e3 * (vertices_m.row(v) - scene.truth_m.row(v)).norm();
      const bool is_front = scene.is_front[static_cast<std::size_t>(v)] != 0;
      (is_front ? visible_mm : hidden_mm) += off_mm;
      (is_front ? seen : hidden) += 1.0;
    }
    visible_mm /= seen;
    hidden_mm /= hidden;
  }
};

constexpr const char* kId = "solvers/volume";
constexpr std::uint64_t kSeed = 20261130;

testing::PluginAnswer run(testing::PluginUnderTest& plugin, const SolidScene& scene,
                          const Correspondences& matches, const Shape* previous = nullptr,
                          const KnownPoints* known = nullptr) {
  std::vector<testing::Input> inputs{testing::input("template", scene.block.templ()),
                                     testing::input("camera", scene.camera),
                                     testing::input("correspondences", matches)};
  if (previous != nullptr) inputs.push_back(testing::input("previous.shape", *previous));
  if (known != nullptr) inputs.push_back(testing::input("known_points", *known));
  return plugin.process(0, inputs);
}

Shape shape_in(const testing::PluginAnswer& answer) {
  EXPECT_EQ(answer.status, WEFT_OK) << answer.message;
  const auto shape = answer.get<Shape>();
  if (!shape) throw std::runtime_error("no shape: " + answer.message);
  return *shape;
}

TEST(Volume, FindsARigidBlockFromExactMatches) {
  const SolidScene scene(at_rest);
  testing::PluginUnderTest plugin(kId);
  const Shape shape = shape_in(run(plugin, scene, scene.matches(200, 0.0, 0.0, kSeed, at_rest)));
  const Errors errors(scene, shape);
  EXPECT_LT(errors.visible_mm, 0.05);
  EXPECT_LT(errors.hidden_mm, 0.05);
  EXPECT_EQ(shape.shape_state(), ShapeState::estimated);
  ASSERT_EQ(shape.nodes_m.rows(), scene.block.nodes_m.rows());
}

TEST(Volume, FindsABentBlockBehindNoiseAndMismatches) {
  constexpr int kScenes = 3;
  std::cout << "seeds from " << kSeed << "\n";
  const SolidScene scene(bent_block);
  testing::PluginUnderTest plugin(kId);
  double visible_mm = 0.0, hidden_mm = 0.0;
  for (std::uint64_t k = 0; k < kScenes; ++k) {
    const auto matches = scene.matches(200, 0.5, 0.15, kSeed + k, bent_block);
    const Errors errors(scene, shape_in(run(plugin, scene, matches)));
    visible_mm += errors.visible_mm / kScenes;
    hidden_mm += errors.hidden_mm / kScenes;
  }
  std::cout << "visible " << visible_mm << " mm, hidden " << hidden_mm << " mm\n";
  EXPECT_LT(visible_mm, 2.0);
  EXPECT_LT(hidden_mm, 3.0);  // 2 % of the diagonal
}

TEST(Volume, KeepsTheVolumeOfAnIncompressibleBody) {
  const SolidScene scene(bent_block);
  testing::PluginUnderTest plugin(kId, "{poisson_ratio: 0.49}");
  const Shape shape = shape_in(run(plugin, scene, scene.matches(200, 0.5, 0.0, kSeed, bent_block)));
  const auto volume_m3 = [&](const Points3& nodes_m) {
    double sum = 0.0;
    for (const auto& corners : scene.block.tetrahedra) {
      Eigen::Matrix3d sides;
      for (int k = 0; k < 3; ++k) {
        sides.col(k) =
            (nodes_m.row(corners[static_cast<std::size_t>(k) + 1]) - nodes_m.row(corners[0]))
                .transpose();
      }
      sum += sides.determinant() / 6.0;
    }
    return sum;
  };
  const double at_rest_m3 = volume_m3(scene.block.nodes_m);
  EXPECT_NEAR(volume_m3(shape.nodes_m.matrix<3>()) / at_rest_m3, 1.0, 0.01);
}

TEST(Volume, FollowsFromThePreviousNodes) {
  const SolidScene scene(bent_block);
  testing::PluginUnderTest plugin(kId);
  const Shape first = shape_in(run(plugin, scene, scene.matches(200, 0.5, 0.0, kSeed, bent_block)));
  const Shape second =
      shape_in(run(plugin, scene, scene.matches(200, 0.5, 0.0, kSeed + 1, bent_block), &first));
  EXPECT_EQ(second.diag.value("start", -1.0), 0.0);
  EXPECT_EQ(second.diag.value("starts_tried", -1.0), 1.0);
  EXPECT_LT(Errors(scene, second).visible_mm, 2.0);
}

TEST(Volume, IsDrawnToKnownPointsOnTheHiddenSide) {
  const SolidScene scene(bent_block);
  const auto matches = scene.matches(200, 1.0, 0.0, kSeed, bent_block);
  KnownPoints known;
  std::vector<std::int32_t> hidden;
  for (std::size_t v = 0; v < scene.is_front.size(); v += 12) {
    if (scene.is_front[v] == 0) hidden.push_back(static_cast<std::int32_t>(v));
  }
  const auto count = static_cast<std::int64_t>(hidden.size());
  known.vertex = Array<std::int32_t>({count});
  known.points_m = Array<double>({count, 3});
  known.radius_m = Array<double>({count}, 0.001);
  for (std::int64_t p = 0; p < count; ++p) {
    known.vertex(p) = hidden[static_cast<std::size_t>(p)];
    known.points_m.matrix<3>().row(p) = scene.truth_m.row(known.vertex(p));
  }
  testing::PluginUnderTest plugin(kId);
  const Errors alone(scene, shape_in(run(plugin, scene, matches)));
  const Errors held(scene, shape_in(run(plugin, scene, matches, nullptr, &known)));
  EXPECT_LT(held.hidden_mm, 0.5 * alone.hidden_mm);
}

TEST(Volume, StatesIntervalsThatHold) {
  const SolidScene scene(bent_block);
  testing::PluginUnderTest plugin(kId);
  constexpr double kChi2 = 7.815;  // 95 % of three degrees of freedom
  double within = 0.0, all = 0.0;
  for (std::uint64_t seed = kSeed; seed < kSeed + 5; ++seed) {
    const Shape shape =
        shape_in(run(plugin, scene, scene.matches(200, 1.0, 0.1, seed, bent_block)));
    ASSERT_TRUE(shape.covariance_m2.present());
    for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
      const Eigen::Vector3d off_m =
          (shape.vertices_m.matrix<3>().row(v) - scene.truth_m.row(v)).transpose();
      const Eigen::Map<const Eigen::Matrix3d> covariance(shape.covariance_m2.row(v));
      within += off_m.dot(covariance.inverse() * off_m) < kChi2 ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  std::cout << 100.0 * within / all << " % within the interval of 95 %\n";
  EXPECT_GT(within / all, 0.9);
}

TEST(Volume, FindsABlockAtRestByPositionBasedDynamics) {
  const SolidScene scene(at_rest);
  testing::PluginUnderTest plugin(kId, "{method: position_based}");
  const Errors errors(scene,
                      shape_in(run(plugin, scene, scene.matches(200, 0.5, 0.1, kSeed, at_rest))));
  std::cout << "visible " << errors.visible_mm << " mm, hidden " << errors.hidden_mm << " mm\n";
  EXPECT_LT(errors.visible_mm, 1.0);
  EXPECT_LT(errors.hidden_mm, 1.0);
}

TEST(Volume, GivesTheSameBytesForTheSameInput) {
  const SolidScene scene(bent_block);
  const auto matches = scene.matches(150, 1.0, 0.1, kSeed, bent_block);
  testing::PluginUnderTest first(kId), second(kId);
  const Shape a = shape_in(run(first, scene, matches)), b = shape_in(run(second, scene, matches));
  EXPECT_EQ(Points3(a.vertices_m.matrix<3>()), Points3(b.vertices_m.matrix<3>()));
}

class VolumeDegenerate : public ::testing::Test {
 protected:
  SolidScene scene_{at_rest};
  testing::PluginUnderTest plugin_{kId};
};

TEST_F(VolumeDegenerate, TooFewMatchesAreNoResult) {
  for (const int count : {0, 1, 11}) {
    const auto answer = run(plugin_, scene_, scene_.matches(count, 0.0, 0.0, kSeed, at_rest));
    EXPECT_EQ(answer.status, WEFT_NO_RESULT);
    EXPECT_THAT(answer.message, ::testing::HasSubstr("too few matches: " + std::to_string(count)));
  }
}

TEST_F(VolumeDegenerate, MatchesInOnePlaceAreNoResult) {
  auto matches = scene_.matches(60, 0.0, 0.0, kSeed, at_rest);
  matches.image_px.matrix<2>().rowwise() = Eigen::RowVector2d(300.0, 200.0);
  EXPECT_EQ(run(plugin_, scene_, matches).status, WEFT_NO_RESULT);
}

TEST_F(VolumeDegenerate, MatchesThatContradictEachOtherAreNeverEstimated) {
  const auto answer = run(plugin_, scene_, scene_.matches(100, 0.0, 1.0, kSeed, at_rest));
  EXPECT_NE(answer.status, WEFT_ERROR) << answer.message;
  if (const auto shape = answer.get<Shape>()) {
    EXPECT_NE(shape->shape_state(), ShapeState::estimated);
  }
}

TEST_F(VolumeDegenerate, ANumberThatIsNotFiniteIsAnErrorThatNamesTheMatch) {
  auto matches = scene_.matches(60, 0.0, 0.0, kSeed, at_rest);
  matches.image_px(17, 0) = std::numeric_limits<double>::quiet_NaN();
  const auto answer = run(plugin_, scene_, matches);
  EXPECT_EQ(answer.status, WEFT_ERROR);
  EXPECT_THAT(answer.message, ::testing::HasSubstr("match 17"));
}

TEST_F(VolumeDegenerate, ATemplateWithoutTetrahedraIsRefusedWithTheFix) {
  Template surface = scene_.block.templ();
  surface.tetrahedra = {};
  const auto answer = plugin_.process(
      0, {testing::input("template", surface), testing::input("camera", scene_.camera),
          testing::input("correspondences", scene_.matches(60, 0.0, 0.0, kSeed, at_rest))});
  EXPECT_EQ(answer.status, WEFT_ERROR);
  EXPECT_THAT(answer.message, ::testing::HasSubstr("templates/volume"));
}

}  // namespace
}  // namespace weft::volume
