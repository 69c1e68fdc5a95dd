// SPDX-License-Identifier: Apache-2.0
#include "covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <iostream>
#include <numeric>
#include <weft/core/index.hpp>

#include "fit.hpp"
#include "scene.hpp"

namespace weft::particle_sft {
namespace {

constexpr HoldingNoise kNoise{0.5, 0.002, 0.02, 0.003, 0.01, 0.2};
constexpr double kPriorM = 0.3;

struct ObservedScene {
  Scene scene;
  MeshModel mesh;
  ParticleSystem system;
  Pinhole camera;

  explicit ObservedScene(Scene given) : scene(std::move(given)), system(system_of(scene)) {
    if (!mesh.build(scene.templ, 0.0)) throw std::runtime_error("the template is no mesh");
    camera = testing::pinhole(scene.camera);
  }

  std::vector<std::uint8_t> seen() const {
    return observed_vertices(system.rays, system.spheres, mesh.vertex_count());
  }

  std::vector<double> covariances_m2(ShapeCovariance& covariance,
                                     const HoldingNoise& noise = kNoise) const {
    std::vector<double> values(to_index(9 * mesh.vertex_count()));
    EXPECT_TRUE(covariance.compute(system, seen(), camera, scene.truth_m, noise, values.data()));
    return values;
  }

  std::vector<Eigen::Matrix3d> blocks(const HoldingNoise& noise = kNoise) const {
    ShapeCovariance covariance;
    if (!covariance.build(mesh)) throw std::runtime_error("the mesh is too large");
    const std::vector<double> values = covariances_m2(covariance, noise);
    std::vector<Eigen::Matrix3d> result;
    for (std::size_t v = 0; v < values.size(); v += 9) {
      result.emplace_back(Eigen::Map<const Eigen::Matrix3d>(&values[v]));
    }
    return result;
  }

  /// Everything that holds the shape, as rows of J / sigma: sum of squares of J (dx, e).
  Eigen::MatrixXd weighted_jacobian() const {
    const Points3& x = scene.truth_m;
    const std::vector<std::uint8_t> is_seen = seen();
    std::vector<Eigen::RowVectorXd> rows;
    const auto zero = [&] { return Eigen::RowVectorXd(Eigen::RowVectorXd::Zero(x.size() + 1)); };
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
      const bool known = is_seen[edge.i] != 0 && is_seen[edge.j] != 0;
      const double strain = known ? kNoise.strain : std::hypot(kNoise.strain, kNoise.unseen_strain);
      rows.back().segment<3>(3 * edge.i) = -along / (strain * edge.rest_length_m);
      rows.back().segment<3>(3 * edge.j) = along / (strain * edge.rest_length_m);
      rows.back()[x.size()] = -1.0 / strain;
    }
    rows.push_back(zero());
    rows.back()[x.size()] = 1.0 / kNoise.common_strain;
    for (const BendingHinge& hinge : mesh.hinges()) {
      bool known = true;
      for (const std::int32_t v : hinge.vertex) known = known && is_seen[v] != 0;
      const double unseen_rad = known ? 0.0 : kNoise.unseen_bend * std::sqrt(3.0 / hinge.weight);
      const double bend_rad = std::hypot(kNoise.bend_rad, unseen_rad);
      for (int r = 0; r < 3; ++r) {
        rows.push_back(zero());
        for (std::size_t k = 0; k < 4; ++k) {
          rows.back()[3 * hinge.vertex[k] + r] = hinge.coefficient_per_m[k] / bend_rad;
        }
      }
    }
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      rows.push_back(zero());
      rows.back()[i] = 1.0 / kPriorM;
    }
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(rows.size()), x.size() + 1);
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
  const ObservedScene observed(partly_seen());
  const Eigen::MatrixXd jacobian = observed.weighted_jacobian();
  const Eigen::MatrixXd inverse = Eigen::MatrixXd(jacobian.transpose() * jacobian).inverse();
  const std::vector<Eigen::Matrix3d> blocks = observed.blocks();
  ASSERT_EQ(blocks.size(), 60U);
  for (std::size_t v = 0; v < blocks.size(); ++v) {
    const auto at = 3 * static_cast<Eigen::Index>(v);
    const Eigen::Matrix3d expected = inverse.block<3, 3>(at, at);
    EXPECT_LT((blocks[v] - expected).norm(), 1e-7 * expected.norm()) << v;
  }
}

/// At the end of a strip of 400 x 20 mm that is seen up to a column, of rows of squares.
double std_at_end_m(int seen_columns, int cells, double unseen_bend) {
  const int columns = 20 * cells + 1;
  testing::SheetSpec strip{columns, cells + 1, 0.4, 0.02, 800, 40};
  Scene scene;
  scene.templ = testing::make_template(strip);
  scene.truth_m =
      testing::bent_vertices(scene.templ, testing::make_cylinder(strip, 1e9, 0.0, {0.6}));
  scene.seen.clear();
  for (std::int32_t v = 0; v < columns * (cells + 1); ++v) {
    if (v % columns < seen_columns) scene.seen.push_back(v);
  }
  scene.look();
  const ObservedScene observed(std::move(scene));
  HoldingNoise noise{0.05, 0.002, 1e-4};
  noise.unseen_bend = unseen_bend;
  return major_std_m(observed.blocks(noise)[to_index(columns) - 1]);
}

TEST(ShapeCovariance, GrowsBeyondWhatIsSeenAsIfTheSurfaceTurnedAtRandom) {
  const auto of_the_bend_m = [](int seen_columns, int cells, double unseen_bend) {
    return std::sqrt(std::pow(std_at_end_m(seen_columns, cells, unseen_bend), 2) -
                     std::pow(std_at_end_m(seen_columns, cells, 0.0), 2));
  };
  // White noise of the curvature, integrated twice: u sqrt(s^3 / (3 width)) at the length s, which
  // begins half a square before the last vertex that is seen. Whatever the mesh.
  const auto expected_m = [](double length_m) {
    return 0.005 * std::sqrt(std::pow(length_m, 3) / (3.0 * 0.02));
  };
  const double coarse = of_the_bend_m(21, 2, 0.005) / expected_m(0.205);
  const double fine = of_the_bend_m(41, 4, 0.005) / expected_m(0.2025);
  EXPECT_NEAR(coarse, 1.0, 0.15);
  EXPECT_NEAR(fine / coarse, 1.0, 0.02);
  EXPECT_NEAR(of_the_bend_m(21, 2, 0.005) / of_the_bend_m(31, 2, 0.005), std::pow(2.0, 1.5), 0.3);
  EXPECT_NEAR(of_the_bend_m(21, 2, 0.005) / of_the_bend_m(21, 2, 0.0025), 2.0, 0.1);
}

TEST(ShapeCovariance, LetsTheDistanceErrByWhatTheEdgesShare) {
  const ObservedScene observed(Scene::bent(0.25));
  HoldingNoise alone = kNoise, shared = kNoise;
  alone.common_strain = 0.0;
  shared.common_strain = 0.002;
  const std::vector<Eigen::Matrix3d> without = observed.blocks(alone),
                                     with = observed.blocks(shared);
  for (Eigen::Index v = 0; v < observed.scene.truth_m.rows(); ++v) {
    const Eigen::Vector3d place_m = observed.scene.truth_m.row(v).transpose();
    const Eigen::Vector3d ray = place_m.normalized();
    const auto at = to_index(v);
    const double more_m2 = ray.dot((with[at] - without[at]) * ray);
    EXPECT_NEAR(std::sqrt(more_m2) / (0.002 * place_m.norm()), 1.0, 0.05) << v;
  }
}

TEST(ShapeCovariance, DoesNotReadADirectionOffAnEdgeThatIsNotSeen) {
  // A corner of a flat surface is hidden, and was placed 3 mm out of its plane.
  Scene scene = Scene::flat();
  scene.truth_m(59, 2) += 0.003;
  std::erase(scene.seen, 59);
  scene.look();
  const ObservedScene observed(scene);
  const HoldingNoise trusting{0.05, 0.002, 0.02, 0.0, 0.0, 1.0};
  HoldingNoise honest = trusting;
  honest.unseen_strain = 0.03;
  EXPECT_GT(major_std_m(observed.blocks(honest)[59]),
            2.0 * major_std_m(observed.blocks(trusting)[59]));
}

TEST(ShapeCovariance, TellsTheCurvatureOfWhatIsSeen) {
  const Scene bent = Scene::bent(0.25);
  const ObservedScene observed(bent);
  ShapeCovariance covariance;
  ASSERT_TRUE(covariance.build(observed.mesh));
  // The mean over hinges along, across and askew to the axis of a cylinder of radius 0.25 m is
  // about half.
  const double per_m = covariance.curvature_per_m(bent.truth_m, observed.seen());
  EXPECT_GT(per_m, 1.0);
  EXPECT_LT(per_m, 4.0);
  const std::vector<std::uint8_t> nothing(to_index(bent.truth_m.rows()), 0);
  EXPECT_EQ(covariance.curvature_per_m(bent.truth_m, nothing), 0.0);
  EXPECT_LT(covariance.curvature_per_m(Scene::flat().truth_m, observed.seen()), 1e-3);
}

TEST(ShapeCovariance, IsTheScatterOfShapesSolvedFromRepeatedNoise) {
  constexpr int kTrials = 4000;
  const ObservedScene observed(partly_seen());
  const Eigen::MatrixXd jacobian = observed.weighted_jacobian();
  const Eigen::LLT<Eigen::MatrixXd> solver(jacobian.transpose() * jacobian);
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const Eigen::Index n = jacobian.cols() - 1;
  std::vector<Eigen::Matrix3d> scatter(60, Eigen::Matrix3d::Zero());
  Eigen::VectorXd noise(jacobian.rows());
  for (int trial = 0; trial < kTrials; ++trial) {
    for (double& each : noise) each = rng.normal();
    const Eigen::VectorXd moved = solver.solve(jacobian.transpose() * noise);
    for (Eigen::Index v = 0; v < n / 3; ++v) {
      const Eigen::Vector3d each = moved.segment<3>(3 * v);
      scatter[to_index(v)] += each * each.transpose() / kTrials;
    }
  }
  const std::vector<Eigen::Matrix3d> blocks = observed.blocks();
  for (std::size_t v = 0; v < blocks.size(); ++v) {
    // The scatter's own standard deviation is 1 / sqrt(2 * 4000), 1.1 %.
    EXPECT_NEAR(major_std_m(scatter[v]) / major_std_m(blocks[v]), 1.0, 0.05) << v;
  }
}

TEST(ShapeCovariance, NeverGrowsWithMoreSightlines) {
  const ObservedScene some(partly_seen());
  Scene whole = partly_seen();
  whole.seen.resize(60);
  std::iota(whole.seen.begin(), whole.seen.end(), 0);
  whole.look();
  const std::vector<Eigen::Matrix3d> less = some.blocks(), more = ObservedScene(whole).blocks();
  for (std::size_t v = 0; v < less.size(); ++v) {
    EXPECT_LE(major_std_m(more[v]), major_std_m(less[v])) << v;
  }
  EXPECT_LT(more[59].trace(), 0.9 * less[59].trace());
}

TEST(ShapeCovariance, IsSmallAtKnownPoints) {
  ObservedScene observed(partly_seen());
  const double alone_m = major_std_m(observed.blocks()[59]);
  observed.system.spheres.push_back(
      KnownSurfacePoint::at_vertex(59, observed.scene.truth_m.row(59), 0.001));
  const double with_sphere_m = major_std_m(observed.blocks()[59]);
  EXPECT_LT(with_sphere_m, alone_m);
  EXPECT_LE(with_sphere_m, 0.001);
}

TEST(ShapeCovariance, DoesNotDependOnWhatWasComputedBefore) {
  const ObservedScene observed(partly_seen()), other(Scene::bent(0.12));
  ShapeCovariance used, fresh;
  ASSERT_TRUE(used.build(observed.mesh));
  ASSERT_TRUE(fresh.build(observed.mesh));
  other.covariances_m2(used);
  EXPECT_EQ(observed.covariances_m2(used), observed.covariances_m2(fresh));
}

TEST(ShapeCovariance, SaysWhatAMeshNeedsThatIsTooFineForIt) {
  MeshModel mesh;
  ASSERT_TRUE(mesh.build(testing::make_template({.columns = 350, .rows = 350}), 0.0));
  const auto refused = ShapeCovariance().build(mesh);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::unsupported);
  EXPECT_NE(refused.error().message.find("covariance: the factor for 122500 vertices needs"),
            std::string::npos)
      << refused.error().message;
  EXPECT_NE(refused.error().message.find("set covariance: false"), std::string::npos);
}

}  // namespace
}  // namespace weft::particle_sft
