// SPDX-License-Identifier: Apache-2.0
#include "../local_models.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/testing/synthetic.hpp>

#include "../isometric_bends.hpp"
#include "../local_patches.hpp"
#include "local_scene.hpp"

namespace weft::salzmann_local {
namespace {

constexpr BendSpec kBends{.size_m = 0.3, .turn_rad = 3.0, .reach_m = 0.06, .count = 200};

/// 5 x 5 vertices with a pitch of 0.02 m about (0,0).
Points2 square_patch() {
  Points2 flat_m(25, 2);
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 5; ++column) {
      flat_m.row(5 * row + column) << 0.02 * (column - 2), 0.02 * (row - 2);
    }
  }
  return flat_m;
}

Points3 in_space(const Points2& flat_m) {
  Points3 rest_m = Points3::Zero(flat_m.rows(), 3);
  rest_m.leftCols<2>() = flat_m;
  return rest_m;
}

Points3 bent_patch(const IsometricBend& bend, const Points2& flat_m) {
  Points3 bent_m(flat_m.rows(), 3);
  for (Eigen::Index k = 0; k < flat_m.rows(); ++k) {
    bent_m.row(k) = bend.at(flat_m.row(k).transpose()).transpose();
  }
  return bent_m;
}

Eigen::Matrix3d random_rotation(Rng& rng) {
  return Eigen::Quaterniond(rng.normal(), rng.normal(), rng.normal(), rng.normal())
      .normalized()
      .toRotationMatrix();
}

TEST(IsometricBend, KeepsLengthsAndAnglesEverywhere) {
  std::cout << "seed 7\n";
  constexpr double kStep_m = 1e-5;
  double most_bent = 0.0;
  for (const IsometricBend& bend : draw_bends(kBends, 7)) {
    for (const Eigen::Vector2d& place :
         {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.04, 0.03), Eigen::Vector2d(-0.05, 0.02)}) {
      Eigen::Matrix<double, 3, 2> slope;
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d step = kStep_m * Eigen::Vector2d::Unit(axis);
        slope.col(axis) = (bend.at(place + step) - bend.at(place - step)) / (2.0 * kStep_m);
      }
      EXPECT_LT((slope.transpose() * slope - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff(),
                1e-5);
      const Eigen::Vector3d flat = bend.at({0.0, 0.0}) + slope * place;
      most_bent = std::max(most_bent, (bend.at(place) - flat).norm());
    }
  }
  EXPECT_GT(most_bent, 0.005);  // and they do bend
}

TEST(IsometricBend, ThatOfASeedIsAlwaysTheSame) {
  const auto one = draw_bends(kBends, 11), again = draw_bends(kBends, 11);
  const auto other = draw_bends(kBends, 12);
  const Eigen::Vector2d place(0.03, -0.02);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].at(place), again[i].at(place));
    EXPECT_NE(one[i].at(place), other[i].at(place));
  }
}

TEST(LocalModel, LeavesAffineImagesOfThePatchFree) {
  std::cout << "seed 13\n";
  Rng rng(13);
  const Points2 flat_m = square_patch();
  const Points3 rest_m = in_space(flat_m);
  const LocalModel model = learn_model(flat_m, rest_m, draw_bends(kBends, 13));
  ASSERT_EQ(model.modes.cols(), 22);
  const Eigen::MatrixXd rows = prior_rows(model, 2e-5);
  for (int draw = 0; draw < 10; ++draw) {
    Eigen::Matrix3d map;
    for (double& value : map.reshaped()) value = rng.normal();
    const Points3 image = (rest_m * map).rowwise() + Eigen::RowVector3d(0.1, -0.2, 0.6);
    EXPECT_LT((rows * image).norm(), 1e-8);
    const Points3 bent = bent_patch(draw_bends(kBends, 14)[to_index(draw)], flat_m);
    EXPECT_GT((rows * bent).norm(), 0.1);
  }
}

TEST(LocalModel, LeavesACurvedPatchAtRestFree) {
  const Points2 flat_m = square_patch();
  const Points3 rest_m = bent_patch(draw_bends(kBends, 15).front(), flat_m);
  const LocalModel model = learn_model(flat_m, rest_m, draw_bends(kBends, 16));
  ASSERT_EQ(model.modes.cols(), 21);
  const Eigen::MatrixXd rows = prior_rows(model, 2e-5);
  EXPECT_LT((rows * rest_m).norm(), 1e-8);
  EXPECT_GT((rows * in_space(flat_m)).norm(), 0.1);
}

TEST(LocalModel, TurnsOfTheTrainingPatchesAreAveragedExactly) {
  std::cout << "seeds 17, 18\n";
  const Points2 flat_m = square_patch();
  const Points3 rest_m = in_space(flat_m);
  const std::vector<IsometricBend> bends = draw_bends(kBends, 17);
  const LocalModel model = learn_model(flat_m, rest_m, bends);
  // Coefficients of turned bends: [3k] with the coordinates one after the other.
  constexpr int kModes = 3, kTurns = 100;
  const auto modes = model.modes.leftCols<kModes>();
  Eigen::Matrix<double, 3 * kModes, 3 * kModes> covariance_m2;
  covariance_m2.setZero();
  Rng rng(18);
  for (const IsometricBend& bend : bends) {
    const Points3 bent_m = bent_patch(bend, flat_m);
    for (int turn = 0; turn < kTurns; ++turn) {
      const Eigen::Matrix<double, kModes, 3> coefficients =
          modes.transpose() * bent_m * random_rotation(rng);
      const Eigen::Matrix<double, 3 * kModes, 1> all = coefficients.reshaped();
      covariance_m2 += all * all.transpose() / (kTurns * static_cast<double>(bends.size()));
    }
  }
  const Eigen::VectorXd expected_m2 = model.variances_m2.head<kModes>().replicate<3, 1>();
  for (int i = 0; i < 3 * kModes; ++i) {
    for (int j = 0; j < 3 * kModes; ++j) {
      const double scale_m2 = std::sqrt(expected_m2[i] * expected_m2[j]);
      EXPECT_NEAR(covariance_m2(i, j) / scale_m2, i == j ? 1.0 : 0.0, 0.08) << i << ' ' << j;
    }
  }
}

TEST(LocalModel, FewModesHoldWhatOtherBendsDo) {
  std::cout << "seeds 19, 20\n";
  const Points2 flat_m = square_patch();
  const LocalModel model = learn_model(flat_m, in_space(flat_m), draw_bends(kBends, 19));
  EXPECT_TRUE(
      std::is_sorted(model.variances_m2.begin(), model.variances_m2.end(), std::greater<>()));
  EXPECT_LT((model.modes.transpose() * model.modes - Eigen::MatrixXd::Identity(22, 22)).norm(),
            1e-10);
  double all_m2 = 0.0, left_m2 = 0.0, cost = 0.0;
  const std::vector<IsometricBend> others = draw_bends(kBends, 20);
  const Eigen::MatrixXd rows = prior_rows(model, 2e-5);
  for (const IsometricBend& bend : others) {
    const Points3 bent_m = bent_patch(bend, flat_m);
    const Eigen::MatrixXd coefficients_m = model.modes.transpose() * bent_m;
    all_m2 += coefficients_m.squaredNorm();
    left_m2 += coefficients_m.bottomRows(16).squaredNorm();
    cost += (rows * bent_m).squaredNorm() / static_cast<double>(others.size() * 66);
  }
  std::cout << "6 of 22 modes leave " << left_m2 / all_m2 << ", mean square of a row " << cost
            << '\n';
  EXPECT_LT(left_m2, 0.01 * all_m2);
  EXPECT_LT(cost, 2.0);
}

TEST(LocalPatches, AreAllWindowsOfAGrid) {
  const Template templ = testing::make_template({.columns = 8, .rows = 6});
  const auto topology = build_topology(templ.faces.matrix<3>(), 48);
  const LocalPatches patches = local_patches(templ, *topology);
  ASSERT_EQ(patches.size(), 4U * 2U);
  EXPECT_EQ(patches[5].front(), 8 + 1);
  EXPECT_EQ(patches[5].back(), 5 * 8 + 5);
  for (const auto& patch : patches) EXPECT_EQ(patch.size(), 25U);
}

TEST(LocalPatches, AreSmallerOnAStrip) {
  const Template templ = testing::make_template({.columns = 7, .rows = 2});
  const auto topology = build_topology(templ.faces.matrix<3>(), 14);
  const LocalPatches patches = local_patches(templ, *topology);
  ASSERT_EQ(patches.size(), 3U);
  EXPECT_EQ(patches[2], (std::vector<std::int32_t>{2, 3, 4, 5, 6, 9, 10, 11, 12, 13}));
}

TEST(LocalPatches, OfAnotherMeshAreTheNearestVerticesOfEach) {
  std::cout << "seed 21\n";
  Scene scene(1e3, 0, 0.0, 21);
  scene.shuffle(21);
  const Template& templ = scene.templ;
  const auto rest_m = templ.vertices_m.matrix<3>();
  const auto topology = build_topology(templ.faces.matrix<3>(), rest_m.rows());
  const LocalPatches patches = local_patches(templ, *topology);
  ASSERT_EQ(patches.size(), to_index(rest_m.rows()));
  for (std::int32_t v = 0; v < rest_m.rows(); ++v) {
    const auto& patch = patches[to_index(v)];
    ASSERT_EQ(patch.size(), 25U);
    EXPECT_TRUE(std::is_sorted(patch.begin(), patch.end()));
    EXPECT_EQ(std::adjacent_find(patch.begin(), patch.end()), patch.end());
    EXPECT_TRUE(std::binary_search(patch.begin(), patch.end(), v));
    for (Eigen::Index w = 0; w < rest_m.rows(); ++w) {
      if ((rest_m.row(v) - rest_m.row(w)).norm() < 1.1 * 0.297 / 9.0) {  // along the sides
        EXPECT_TRUE(std::binary_search(patch.begin(), patch.end(), w));
      }
    }
  }
}

TEST(LocalModels, PatchesOfAGridShareOneModel) {
  const Template templ = testing::make_template();
  const auto topology = build_topology(templ.faces.matrix<3>(), templ.vertices_m.rows());
  const auto prior = local_models(templ, local_patches(templ, *topology), 0.033, {});
  ASSERT_TRUE(prior);
  EXPECT_EQ(prior->patch_count(), 6U * 2U);
  EXPECT_EQ(prior->row_count(), 12U * 22U);
  EXPECT_EQ(prior->model_count(), 1U);
}

TEST(LocalModels, ATriangleHasNone) {
  Template templ = testing::make_template({.columns = 2, .rows = 2});
  Faces faces(1, 3);
  faces << 0, 2, 1;
  templ.faces = make_array<std::int32_t>(faces);
  templ.vertices_m = make_array<double>(Points3(templ.vertices_m.matrix<3>().topRows(3)));
  templ.flat_px = make_array<double>(Points2(templ.flat_px.matrix<2>().topRows(3)));
  const auto prior = local_models(templ, {{0, 1, 2}}, 0.1, {});
  ASSERT_TRUE(prior);
  EXPECT_TRUE(prior->empty());
}

}  // namespace
}  // namespace weft::salzmann_local
