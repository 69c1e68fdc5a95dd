// SPDX-License-Identifier: Apache-2.0
#include "covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <iostream>
#include <numeric>

#include "fit.hpp"
#include "scene.hpp"

namespace weft::particle_sft {
namespace {

constexpr HoldingNoise kNoise{0.5, 0.002, 0.02};
constexpr double kPriorM = 0.1;

struct Held {
  Scene scene;
  MeshModel mesh;
  ParticleSystem system;
  Pinhole camera;

  explicit Held(Scene given) : scene(std::move(given)), system(scene.system()) {
    if (!mesh.build(scene.templ, 0.0)) throw std::runtime_error("the template is no mesh");
    camera = testing::pinhole(scene.camera);
  }

  std::vector<Eigen::Matrix3d> blocks() const {
    ShapeCovariance covariance;
    if (!covariance.build(mesh)) throw std::runtime_error("the mesh is too large");
    std::vector<double> values(static_cast<std::size_t>(9 * mesh.vertex_count()));
    EXPECT_TRUE(covariance.compute(system, camera, scene.truth_m, kNoise, values.data()));
    std::vector<Eigen::Matrix3d> result;
    for (std::size_t v = 0; v < values.size(); v += 9) {
      result.emplace_back(Eigen::Map<const Eigen::Matrix3d>(&values[v]));
    }
    return result;
  }

  /// Everything that holds the shape, as rows of J / sigma: sum of squares of J dx.
  Eigen::MatrixXd weighted_jacobian() const {
    const Points3& x = scene.truth_m;
    std::vector<Eigen::RowVectorXd> rows;
    const auto zero = [&] { return Eigen::RowVectorXd(Eigen::RowVectorXd::Zero(x.size())); };
    for (const RayConstraint& seen : system.rays) {
      const Eigen::Vector3d ray(seen.ray[0], seen.ray[1], seen.ray[2]);
      const double depth_m = seen_point_m(seen, x).z();
      const double sigma_m = kNoise.ray_px * depth_m / (0.5 * (camera.fx + camera.fy));
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray * ray.transpose();
      for (int r = 0; r < 3; ++r) {
        rows.push_back(zero());
        for (std::size_t k = 0; k < 3; ++k) {
          rows.back().segment<3>(3 * seen.vertices[k]) +=
              std::sqrt(seen.trust) * seen.weights[k] * across.row(r) / sigma_m;
        }
      }
    }
    for (const DistanceConstraint& edge : system.stretch) {
      rows.push_back(zero());
      const Eigen::RowVector3d along = (x.row(edge.j) - x.row(edge.i)).normalized();
      rows.back().segment<3>(3 * edge.i) = -along / (kNoise.strain * edge.rest_length_m);
      rows.back().segment<3>(3 * edge.j) = along / (kNoise.strain * edge.rest_length_m);
    }
    for (const BendingHinge& hinge : mesh.hinges()) {
      for (int r = 0; r < 3; ++r) {
        rows.push_back(zero());
        for (std::size_t k = 0; k < 4; ++k) {
          rows.back()[3 * hinge.vertex[k] + r] = hinge.coefficient_per_m[k] / kNoise.bend_rad;
        }
      }
    }
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      rows.push_back(zero());
      rows.back()[i] = 1.0 / kPriorM;
    }
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(rows.size()), x.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      jacobian.row(static_cast<Eigen::Index>(r)) = rows[r];
    }
    return jacobian;
  }
};

Scene partly_seen() {
  Scene scene = Scene::bent(0.25, {0.6, 0.0, 0.0, 0.3, -0.2, 0.0});
  scene.seen.resize(37);
  scene.look();
  return scene;
}

double major_std_m(const Eigen::Matrix3d& covariance_m2) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance_m2).eigenvalues()[2]);
}

TEST(ShapeCovariance, IsTheDiagonalOfTheDenseInverse) {
  const Held held(partly_seen());
  const Eigen::MatrixXd jacobian = held.weighted_jacobian();
  const Eigen::MatrixXd inverse = Eigen::MatrixXd(jacobian.transpose() * jacobian).inverse();
  const std::vector<Eigen::Matrix3d> blocks = held.blocks();
  ASSERT_EQ(blocks.size(), 60U);
  for (std::size_t v = 0; v < blocks.size(); ++v) {
    const auto at = 3 * static_cast<Eigen::Index>(v);
    const Eigen::Matrix3d expected = inverse.block<3, 3>(at, at);
    EXPECT_LT((blocks[v] - expected).norm(), 1e-7 * expected.norm()) << v;
  }
}

/// At the end of a strip of 0.4 m that is seen up to a column.
double std_at_end_m(int seen_columns, double bend_per_m) {
  testing::SheetSpec strip{41, 3, 0.4, 0.02, 800, 40};
  Scene scene;
  scene.templ = testing::make_template(strip);
  scene.truth_m =
      testing::bent_vertices(scene.templ, testing::make_cylinder(strip, 1e9, 0.0, {0.6}));
  scene.seen.clear();
  for (std::int32_t v = 0; v < 41 * 3; ++v) {
    if (v % 41 < seen_columns) scene.seen.push_back(v);
  }
  scene.look();
  const Held held(std::move(scene));
  ShapeCovariance covariance;
  EXPECT_TRUE(covariance.build(held.mesh));
  std::vector<double> values(static_cast<std::size_t>(9 * held.mesh.vertex_count()));
  EXPECT_TRUE(covariance.compute(held.system, held.camera, held.scene.truth_m,
                                 {0.05, 0.002, 1e-4, bend_per_m}, values.data()));
  return major_std_m(Eigen::Map<const Eigen::Matrix3d>(&values[9 * (41 + 40)]));
}

TEST(ShapeCovariance, GrowsBeyondWhatIsSeenAsIfTheBendErredAllTheWay) {
  const auto of_the_bend_m = [](int seen_columns, double bend_per_m) {
    return std::sqrt(std::pow(std_at_end_m(seen_columns, bend_per_m), 2) -
                     std::pow(std_at_end_m(seen_columns, 0.0), 2));
  };
  // Twice the length, four times the error; edges that erred each by itself would give 2.8.
  EXPECT_NEAR(of_the_bend_m(21, 0.1) / of_the_bend_m(31, 0.1), 4.0, 0.4);
  EXPECT_NEAR(of_the_bend_m(21, 0.1) / of_the_bend_m(21, 0.05), 2.0, 0.1);
}

TEST(ShapeCovariance, IsTheScatterOfShapesSolvedFromRepeatedNoise) {
  constexpr int kTrials = 4000;
  const Held held(partly_seen());
  const Eigen::MatrixXd jacobian = held.weighted_jacobian();
  const Eigen::LLT<Eigen::MatrixXd> solver(jacobian.transpose() * jacobian);
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const Eigen::Index n = jacobian.cols();
  std::vector<Eigen::Matrix3d> scatter(60, Eigen::Matrix3d::Zero());
  Eigen::VectorXd noise(jacobian.rows());
  for (int trial = 0; trial < kTrials; ++trial) {
    for (double& each : noise) each = rng.normal();
    const Eigen::VectorXd moved = solver.solve(jacobian.transpose() * noise);
    for (Eigen::Index v = 0; v < n / 3; ++v) {
      const Eigen::Vector3d each = moved.segment<3>(3 * v);
      scatter[static_cast<std::size_t>(v)] += each * each.transpose() / kTrials;
    }
  }
  const std::vector<Eigen::Matrix3d> blocks = held.blocks();
  for (std::size_t v = 0; v < blocks.size(); ++v) {
    // The scatter's own standard deviation is 1 / sqrt(2 * 4000), 1.1 %.
    EXPECT_NEAR(major_std_m(scatter[v]) / major_std_m(blocks[v]), 1.0, 0.05) << v;
  }
}

TEST(ShapeCovariance, NeverGrowsWithMoreSightlines) {
  const Held some(partly_seen());
  Scene whole = partly_seen();
  whole.seen.resize(60);
  std::iota(whole.seen.begin(), whole.seen.end(), 0);
  whole.look();
  const std::vector<Eigen::Matrix3d> less = some.blocks(), more = Held(whole).blocks();
  for (std::size_t v = 0; v < less.size(); ++v) {
    EXPECT_LE(major_std_m(more[v]), major_std_m(less[v])) << v;
  }
  EXPECT_LT(more[59].trace(), 0.9 * less[59].trace());
}

TEST(ShapeCovariance, IsSmallAtKnownPoints) {
  Held held(partly_seen());
  const double alone_m = major_std_m(held.blocks()[59]);
  held.system.spheres.push_back(
      KnownSurfacePoint::at_vertex(59, held.scene.truth_m.row(59), 0.001));
  const double held_m = major_std_m(held.blocks()[59]);
  EXPECT_LT(held_m, alone_m);
  EXPECT_LE(held_m, 0.001);
}

TEST(ShapeCovariance, DoesNotDependOnWhatWasComputedBefore) {
  const Held held(partly_seen()), other(Scene::bent(0.12));
  ShapeCovariance used, fresh;
  ASSERT_TRUE(used.build(held.mesh));
  ASSERT_TRUE(fresh.build(held.mesh));
  std::vector<double> first(540), second(540);
  ASSERT_TRUE(used.compute(other.system, other.camera, other.scene.truth_m, kNoise, first.data()));
  ASSERT_TRUE(used.compute(held.system, held.camera, held.scene.truth_m, kNoise, first.data()));
  ASSERT_TRUE(fresh.compute(held.system, held.camera, held.scene.truth_m, kNoise, second.data()));
  EXPECT_EQ(first, second);
}

TEST(ShapeCovariance, SaysWhatAMeshNeedsThatIsTooFineForIt) {
  MeshModel mesh;
  ASSERT_TRUE(mesh.build(testing::make_template({.columns = 220, .rows = 220}), 0.0));
  const auto refused = ShapeCovariance().build(mesh);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::unsupported);
  EXPECT_NE(refused.error().message.find("the covariance of 48400 vertices needs"),
            std::string::npos)
      << refused.error().message;
  EXPECT_NE(refused.error().message.find("set covariance: false"), std::string::npos);
}

}  // namespace
}  // namespace weft::particle_sft
