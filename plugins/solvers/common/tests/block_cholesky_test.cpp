// SPDX-License-Identifier: Apache-2.0
#include "common/cholesky/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <iostream>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/cholesky/couplings.hpp"

namespace weft::solvers {
namespace {

constexpr std::uint64_t kMatrixSeed = 7;

/// A surface, and a positive definite matrix with a block for each pair that a term joins.
struct System {
  Points3 rest_m;
  Couplings couplings;
  BlockMatrix matrix;
  Eigen::MatrixXd dense;

  System(int columns, int rows) {
    std::cout << "seed " << kMatrixSeed << "\n";
    const Template templ = testing::make_template({.columns = columns, .rows = rows});
    rest_m = templ.vertices_m.matrix<3>();
    const auto topology = build_topology(templ.faces.matrix<3>(), rest_m.rows());
    if (!topology) throw std::runtime_error("the template is no mesh");
    for (const Edges* pairs : {&topology->edges, &topology->bending_pairs}) {
      for (Eigen::Index p = 0; p < pairs->rows(); ++p) {
        couplings.of((*pairs)(p, 0), (*pairs)(p, 1));
      }
    }
    const auto count = to_index(rest_m.rows());
    matrix.diagonal.assign(count, 0.1 * Eigen::Matrix3d::Identity());
    matrix.coupling.assign(couplings.pairs().size(), Eigen::Matrix3d::Zero());
    Rng rng(kMatrixSeed);
    for (std::size_t c = 0; c < couplings.pairs().size(); ++c) {
      Eigen::Matrix<double, 2, 6> rows_of;
      for (Eigen::Index k = 0; k < rows_of.size(); ++k) rows_of(k) = rng.normal();
      const Eigen::Matrix<double, 6, 6> square = rows_of.transpose() * rows_of;
      const auto [i, j] = couplings.pairs()[c];
      matrix.diagonal[to_index(i)] += square.topLeftCorner<3, 3>();
      matrix.diagonal[to_index(j)] += square.bottomRightCorner<3, 3>();
      matrix.coupling[c] += square.topRightCorner<3, 3>();
    }
    dense = Eigen::MatrixXd::Zero(3 * rest_m.rows(), 3 * rest_m.rows());
    for (std::size_t v = 0; v < count; ++v) {
      const auto at = static_cast<Eigen::Index>(3 * v);
      dense.block<3, 3>(at, at) = matrix.diagonal[v];
    }
    for (std::size_t c = 0; c < couplings.pairs().size(); ++c) {
      const Eigen::Index i = 3 * couplings.pairs()[c][0], j = 3 * couplings.pairs()[c][1];
      dense.block<3, 3>(i, j) = matrix.coupling[c];
      dense.block<3, 3>(j, i) = matrix.coupling[c].transpose();
    }
  }
};

TEST(BlockCholesky, SolvesAndInvertsAsADenseFactorDoes) {
  for (const auto& [columns, rows] : {std::pair(2, 2), std::pair(10, 6), std::pair(15, 11)}) {
    const System system(columns, rows);
    BlockCholesky factor;
    ASSERT_TRUE(factor.analyse(system.rest_m, system.couplings.pairs()));
    const double damping = 0.05;
    ASSERT_TRUE(factor.factorise(system.matrix, damping));
    const Eigen::MatrixXd damped =
        system.dense +
        damping * Eigen::MatrixXd::Identity(system.dense.rows(), system.dense.rows());
    Rng rng(kMatrixSeed);
    Points3 right(system.rest_m.rows(), 3);
    for (Eigen::Index k = 0; k < right.size(); ++k) right.data()[k] = rng.normal();
    const Eigen::VectorXd expected =
        damped.llt().solve(Eigen::Map<const Eigen::VectorXd>(right.data(), right.size()));
    Points3 solved = right;
    factor.solve(solved);
    EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(solved.data(), solved.size()) - expected).norm(),
              1e-11 * expected.norm());
    const Eigen::MatrixXd inverse = damped.inverse();
    std::vector<Eigen::Matrix3d> blocks(to_index(system.rest_m.rows()));
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
  ASSERT_TRUE(factor.analyse(system.rest_m, system.couplings.pairs()));
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
}  // namespace weft::solvers
