// SPDX-License-Identifier: Apache-2.0
#include "cholesky/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <iostream>
#include <weft/core/index.hpp>

#include "scene.hpp"

namespace weft::gauss_newton {
namespace {

constexpr std::uint64_t kMatrixSeed = 7;

/// A sheet, and a positive definite matrix with a block for each pair that a term joins.
struct System {
  Template templ;
  MeshModel mesh;
  BlockMatrix matrix;
  Eigen::MatrixXd dense;

  System(int columns, int rows) {
    std::cout << "seed " << kMatrixSeed << "\n";
    testing::SheetSpec spec = reference_sheet();
    spec.columns = columns;
    spec.rows = rows;
    templ = testing::make_template(spec);
    if (!mesh.build(templ, 0.0)) throw std::runtime_error("the template is no mesh");
    const auto count = to_index(mesh.vertex_count());
    matrix.diagonal.assign(count, 0.1 * Eigen::Matrix3d::Identity());
    matrix.coupling.assign(mesh.couplings.size(), Eigen::Matrix3d::Zero());
    Rng rng(kMatrixSeed);
    for (std::size_t c = 0; c < mesh.couplings.size(); ++c) {
      Eigen::Matrix<double, 2, 6> rows_of;
      for (Eigen::Index k = 0; k < rows_of.size(); ++k) rows_of(k) = rng.normal();
      const Eigen::Matrix<double, 6, 6> square = rows_of.transpose() * rows_of;
      const auto [i, j] = mesh.couplings[c];
      matrix.diagonal[to_index(i)] += square.topLeftCorner<3, 3>();
      matrix.diagonal[to_index(j)] += square.bottomRightCorner<3, 3>();
      matrix.coupling[c] += square.topRightCorner<3, 3>();
    }
    dense = Eigen::MatrixXd::Zero(3 * mesh.vertex_count(), 3 * mesh.vertex_count());
    for (std::size_t v = 0; v < count; ++v) {
      const auto at = static_cast<Eigen::Index>(3 * v);
      dense.block<3, 3>(at, at) = matrix.diagonal[v];
    }
    for (std::size_t c = 0; c < mesh.couplings.size(); ++c) {
      const Eigen::Index i = 3 * mesh.couplings[c][0], j = 3 * mesh.couplings[c][1];
      dense.block<3, 3>(i, j) = matrix.coupling[c];
      dense.block<3, 3>(j, i) = matrix.coupling[c].transpose();
    }
  }
};

TEST(BlockCholesky, SolvesAndInvertsAsADenseFactorDoes) {
  for (const auto& [columns, rows] : {std::pair(2, 2), std::pair(10, 6), std::pair(15, 11)}) {
    const System system(columns, rows);
    BlockCholesky factor;
    ASSERT_TRUE(factor.analyse(system.mesh.rest_m, system.mesh.couplings));
    const double damping = 0.05;
    ASSERT_TRUE(factor.factorise(system.matrix, damping));
    const Eigen::MatrixXd damped =
        system.dense +
        damping * Eigen::MatrixXd::Identity(system.dense.rows(), system.dense.rows());
    Rng rng(kMatrixSeed);
    Points3 right(system.mesh.vertex_count(), 3);
    for (Eigen::Index k = 0; k < right.size(); ++k) right.data()[k] = rng.normal();
    const Eigen::VectorXd expected =
        damped.llt().solve(Eigen::Map<const Eigen::VectorXd>(right.data(), right.size()));
    Points3 solved = right;
    factor.solve(solved);
    EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(solved.data(), solved.size()) - expected).norm(),
              1e-11 * expected.norm());
    const Eigen::MatrixXd inverse = damped.inverse();
    std::vector<Eigen::Matrix3d> blocks(to_index(system.mesh.vertex_count()));
    factor.inverse_blocks(blocks);
    for (std::size_t v = 0; v < blocks.size(); ++v) {
      const auto at = static_cast<Eigen::Index>(3 * v);
      EXPECT_LT((inverse.block<3, 3>(at, at) - blocks[v]).norm(), 1e-10 * blocks[v].norm());
    }
  }
}

TEST(BlockCholesky, SaysWhereAMatrixIsNotPositiveDefiniteAndGoesOn) {
  System system(10, 6);
  BlockCholesky factor;
  ASSERT_TRUE(factor.analyse(system.mesh.rest_m, system.mesh.couplings));
  BlockMatrix indefinite = system.matrix;
  indefinite.diagonal[30] -= 1e3 * Eigen::Matrix3d::Identity();
  EXPECT_FALSE(factor.factorise(indefinite, 0.0));
  Points3 first = Points3::Ones(60, 3), again = first;
  ASSERT_TRUE(factor.factorise(system.matrix, 0.0));
  factor.solve(first);
  EXPECT_FALSE(factor.factorise(indefinite, 0.0));
  ASSERT_TRUE(factor.factorise(system.matrix, 0.0));
  factor.solve(again);
  EXPECT_EQ(first, again);
}

}  // namespace
}  // namespace weft::gauss_newton
