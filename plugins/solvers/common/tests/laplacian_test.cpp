// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>
#include <stdexcept>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/laplacian/affine_rows.hpp"
#include "common/laplacian/control_mesh.hpp"
#include "common/laplacian/inextensible_fit.hpp"
#include "common/laplacian/inlier_search.hpp"
#include "common/laplacian/seen_matches.hpp"

namespace weft::solvers {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kSeed = 20121007;

Template flat_template() { return testing::make_template(); }

/// The surface at rest around a cylinder.
Template curved_template() {
  Template templ = testing::make_template();
  const auto sheet = testing::make_cylinder({}, 0.1, 0.4);
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    templ.vertices_m.matrix<3>().row(v) =
        sheet.bent(templ.vertices_m(v, 0), templ.vertices_m(v, 1)).transpose();
  }
  return templ;
}

ControlMesh control_mesh(const Template& templ, int controls = 25) {
  auto mesh = make_control_mesh(templ, controls);
  if (!mesh) throw std::runtime_error(mesh.error().message);
  return *std::move(mesh);
}

AffineRows rows_of(const Template& templ) {
  const Points3 rest_m = templ.vertices_m.matrix<3>();
  const Faces faces = templ.faces.matrix<3>();
  return affine_rows(rest_m, faces, *build_topology(faces, rest_m.rows()));
}

/// A random affine map of space applied to points [N,3].
Points3 affine_image(const Points3& points_m, Rng& rng) {
  Eigen::Matrix3d linear;
  for (double& value : linear.reshaped()) value = rng.uniform(-2.0, 2.0);
  const Eigen::RowVector3d shift(rng.normal(), rng.normal(), rng.normal());
  return (points_m * linear).rowwise() + shift;
}

Eigen::MatrixX3d controls_of(const ControlMesh& mesh, const Points3& vertices_m) {
  Eigen::MatrixX3d controls_m(mesh.control_count(), 3);
  for (Eigen::Index k = 0; k < controls_m.rows(); ++k) {
    controls_m.row(k) = vertices_m.row(mesh.controls[to_index(k)]);
  }
  return controls_m;
}

TEST(AffineRows, VanishOnAFlatMeshAndOnAffineImagesOfIt) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const Template templ = flat_template();
  const AffineRows affine = rows_of(templ);
  ASSERT_TRUE(affine.flat);
  const Points3 rest_m = templ.vertices_m.matrix<3>();
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(rest_m.rows());
  EXPECT_LT(Eigen::VectorXd(affine.rows * ones).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(Eigen::MatrixXd(affine.rows * rest_m).cwiseAbs().maxCoeff(), 1e-12);
  for (int draw = 0; draw < 10; ++draw) {
    const Points3 moved_m = affine_image(rest_m, rng);
    EXPECT_LT(Eigen::MatrixXd(affine.rows * moved_m).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(AffineRows, EachHasNormOne) {
  for (const Template& templ : {flat_template(), curved_template()}) {
    const Eigen::SparseMatrix<double> rows = rows_of(templ).rows;
    const Eigen::VectorXd norms2 = Eigen::MatrixXd(rows).rowwise().squaredNorm();
    EXPECT_LT((norms2.array() - 1.0).abs().maxCoeff(), 1e-12);
  }
}

TEST(AffineRows, ACurvedMeshHasTwoVirtualVerticesForEachFace) {
  const Template templ = curved_template();
  const AffineRows affine = rows_of(templ);
  EXPECT_FALSE(affine.flat);
  EXPECT_EQ(affine.rows.cols(), templ.vertices_m.rows() + 2 * templ.faces.rows());
}

TEST(AffineRows, ANearlyFlatMeshCountsAsFlat) {
  Template templ = flat_template();
  Rng rng(kSeed);
  for (std::int64_t v = 0; v < templ.vertices_m.rows(); ++v) {
    templ.vertices_m(v, 2) += rng.uniform(-1e-3, 1e-3);
  }
  EXPECT_TRUE(rows_of(templ).flat);
}

TEST(ControlMesh, CarriesAffineImagesAlongWithoutBending) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  for (const Template& templ : {flat_template(), curved_template()}) {
    const ControlMesh mesh = control_mesh(templ);
    EXPECT_EQ(mesh.control_count(), 25);
    EXPECT_LT((mesh.weights.rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-9);
    for (int draw = 0; draw < 5; ++draw) {
      const Points3 moved_m = affine_image(mesh.rest_m, rng);
      const Eigen::MatrixX3d controls_m = controls_of(mesh, moved_m);
      const Points3 off_m = mesh.weights * controls_m - moved_m;
      EXPECT_LT(off_m.cwiseAbs().maxCoeff(), 1e-8);
      EXPECT_LT((controls_m.transpose() * mesh.bending * controls_m).trace(), 1e-12);
    }
  }
}

TEST(ControlMesh, LeavesTheControlsWhereTheyArePut) {
  const ControlMesh mesh = control_mesh(flat_template());
  for (Eigen::Index k = 0; k < mesh.control_count(); ++k) {
    Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(mesh.control_count());
    expected[k] = 1.0;
    EXPECT_EQ(Eigen::RowVectorXd(mesh.weights.row(mesh.controls[to_index(k)])), expected);
  }
}

TEST(ControlMesh, MovesEveryVertexWhereThereAreAsManyControls) {
  const ControlMesh mesh = control_mesh(flat_template(), 200);
  EXPECT_EQ(mesh.control_count(), 60);
  EXPECT_EQ(mesh.weights.rowwise().sum(), Eigen::VectorXd(Eigen::VectorXd::Ones(60)));
}

TEST(ControlMesh, AFinerMeshBendsAsHard) {
  testing::SheetSpec fine;
  fine.columns = 28;
  fine.rows = 16;
  const auto sheet = testing::make_cylinder({}, 0.25, 0.0);
  const auto energy = [&](const Template& templ) {
    const ControlMesh mesh = control_mesh(templ, 60);
    const Eigen::MatrixX3d controls_m = controls_of(mesh, testing::bent_vertices(templ, sheet));
    return (controls_m.transpose() * mesh.bending * controls_m).trace();
  };
  const double coarse = energy(flat_template());
  EXPECT_NEAR(energy(testing::make_template(fine)) / coarse, 1.0, 0.35);
}

TEST(FarthestVertices, ChoosesTheCornersFirst) {
  const Template templ = flat_template();
  const Faces faces = templ.faces.matrix<3>();
  const Points3 rest_m = templ.vertices_m.matrix<3>();
  const auto chosen = farthest_vertices(rest_m, build_topology(faces, rest_m.rows())->edges, 8);
  EXPECT_THAT(std::vector<std::int32_t>(chosen.begin(), chosen.begin() + 4),
              ::testing::UnorderedElementsAre(0, 9, 50, 59));
  EXPECT_EQ(std::set<std::int32_t>(chosen.begin(), chosen.end()).size(), 8U);
}

TEST(ControlMesh, RefusesPartsThatDoNotHangTogether) {
  Template templ = flat_template();
  std::vector<std::int32_t> kept;
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    bool crosses = false;
    for (int k = 0; k < 3; ++k) crosses = crosses || templ.faces(f, k) % 10 == 4;
    bool beyond = false;
    for (int k = 0; k < 3; ++k) beyond = beyond || templ.faces(f, k) % 10 == 5;
    if (!(crosses && beyond)) kept.insert(kept.end(), templ.faces.row(f), templ.faces.row(f) + 3);
  }
  templ.faces = Array<std::int32_t>({static_cast<std::int64_t>(kept.size() / 3), 3});
  std::copy(kept.begin(), kept.end(), templ.faces.data());
  const auto mesh = make_control_mesh(templ, 25);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().code, Errc::unsupported);
  EXPECT_THAT(mesh.error().message, HasSubstr("not connected by edges"));
}

TEST(ControlMesh, NamesAFaceWithoutArea) {
  Template templ = flat_template();
  templ.vertices_m.matrix<3>().row(0) = templ.vertices_m.matrix<3>().row(1);
  const auto mesh = make_control_mesh(templ, 25);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().code, Errc::invalid_data);
}

/// Matches of a bent surface.
struct Seen {
  Template templ;
  ControlMesh mesh;
  Camera camera = testing::make_camera();
  Points3 truth_m;
  testing::LabelledMatches drawn;
  SeenMatches matches;

  Seen(double radius_m, const testing::MatchSpec& spec, int controls = 25)
      : templ(flat_template()), mesh(control_mesh(templ, controls)) {
    const auto sheet = testing::make_cylinder({}, radius_m, 0.3, {0.6, 0.02, 0.01, 0.2, 0.3, 0.1});
    truth_m = testing::bent_vertices(templ, sheet);
    std::cout << "seed " << kSeed << "\n";
    Rng rng(kSeed);
    drawn = testing::draw_matches(templ, camera, truth_m, spec, rng);
    matches = *read_matches(drawn.matches, testing::pinhole(camera), mesh);
  }

  Inliers inliers(const InlierSearchOptions& options = {}) const {
    auto found = find_inliers(mesh, matches, options);
    if (!found) throw std::runtime_error(found.error().message);
    return *std::move(found);
  }
};

TEST(LinearShape, IsExactForTheRestShapeInAnyPose) {
  const Seen seen(1e9, {200, 1.0, 0.0});
  const Points3 found_m = seen.mesh.weights * seen.inliers().shape.controls_m;
  EXPECT_LT((found_m - seen.truth_m).norm(), 1e-6 * seen.truth_m.norm());
}

TEST(LinearShape, ProjectsBentSheetsWithinAPixel) {
  for (const double radius_m : {1e9, 0.25, -0.25, 0.15}) {
    const Seen seen(radius_m, {200, 1.0, 0.5});
    const Inliers inliers = seen.inliers();
    const double mean_px = distances_px(seen.matches, inliers.shape.controls_m).mean();
    std::cout << "radius " << radius_m << " m: " << mean_px << " px, gap "
              << inliers.shape.eigen_gap << "\n";
    EXPECT_LT(mean_px, 1.0);
  }
}

TEST(ReprojectionMatrix, IsTheSquareOfTheDistancesFromTheSightlines) {
  const Seen seen(0.25, {50, 0.8, 0.5});
  Eigen::VectorXd counts = Eigen::VectorXd::Ones(50);
  counts[3] = 0.0;
  counts[20] = 0.25;
  const Eigen::MatrixX3d controls_m = controls_of(seen.mesh, seen.truth_m);
  const Points3 points_m = seen.matches.weights * controls_m;
  double sum_m2 = 0.0;
  for (Eigen::Index m = 0; m < 50; ++m) {
    const Eigen::RowVector2d off_m =
        points_m.row(m).head<2>() - seen.matches.slopes.row(m) * points_m(m, 2);
    sum_m2 += counts[m] * off_m.squaredNorm();
  }
  const Eigen::VectorXd c = controls_m.reshaped();
  EXPECT_NEAR(c.dot(reprojection_matrix(seen.matches, counts) * c), sum_m2, 1e-9 * sum_m2);
}

TEST(FindInliers, SeparatesHalfOfTheMatchesFromTheOthers) {
  for (const double radius_m : {1e9, 0.5, 0.25}) {
    const Seen seen(radius_m, {400, 0.5, 0.5});
    const Inliers found = seen.inliers({.affine_test = true});
    double right = 0.0, all_right = 0.0;
    for (std::size_t m = 0; m < found.inlier.size(); ++m) {
      const double correct = seen.drawn.correct[seen.matches.places[m]];
      right += found.inlier[m] * correct;
      all_right += correct;
    }
    std::cout << "radius " << radius_m << " m: precision "
              << right / static_cast<double>(found.count) << ", recall " << right / all_right
              << "\n";
    EXPECT_GT(right / static_cast<double>(found.count), 0.98);
    EXPECT_GT(right / all_right, 0.9);
  }
}

TEST(FindInliers, KeepsAllWhereConfigured) {
  const Seen seen(0.25, {200, 0.5, 0.5});
  InlierSearchOptions options;
  options.rejects = false;
  EXPECT_EQ(seen.inliers(options).count, 200);
}

TEST(InextensibleFit, StretchesNoEdgeAndReachesTheSheet) {
  for (const double radius_m : {1e9, 0.25, -0.25}) {
    const Seen seen(radius_m, {200, 1.0, 0.5});
    const InextensibleFit fit =
        inextensible_fit(seen.mesh, seen.matches, seen.inliers(), InextensibleFitOptions{});
    EXPECT_TRUE(fit.converged);
    const Points3 found_m = seen.mesh.weights * fit.controls_m;
    double most = 0.0;
    for (const DistanceConstraint& edge : seen.mesh.edges) {
      const double length_m = (found_m.row(edge.i) - found_m.row(edge.j)).norm();
      most = std::max(most, length_m / edge.rest_length_m - 1.0);
    }
    const double error_m = (found_m - seen.truth_m).rowwise().norm().mean();
    std::cout << "radius " << radius_m << " m: " << 1e3 * error_m << " mm, " << fit.iterations
              << " iterations, excess " << most << "\n";
    EXPECT_LT(most, 0.01);
    EXPECT_LT(error_m, 0.006);
  }
}

TEST(InextensibleFit, DoesNotDependOnItsStart) {
  const Seen seen(0.25, {200, 1.0, 0.5});
  Inliers inliers = seen.inliers();
  InextensibleFitOptions options;
  options.tolerance_m = 1e-8;
  options.max_iterations = 20000;
  const auto first = inextensible_fit(seen.mesh, seen.matches, inliers, options);
  // Mirrored in depth about the mean of the matches, on which the pull depends.
  const double middle_m = (seen.matches.weights * inliers.shape.controls_m.col(2)).mean();
  inliers.shape.controls_m.col(2) = 2.0 * middle_m - inliers.shape.controls_m.col(2).array();
  const auto second = inextensible_fit(seen.mesh, seen.matches, inliers, options);
  ASSERT_TRUE(first.converged && second.converged);
  EXPECT_LT((first.controls_m - second.controls_m).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(OnALine, KnowsPointsPlacesAndLines) {
  Eigen::MatrixXd points(4, 3);
  points << 0, 0, 0, 1, 1, 1, 2, 2, 2, 5, 5, 5;
  EXPECT_TRUE(on_a_line(points));
  EXPECT_TRUE(on_a_line(Eigen::MatrixXd::Ones(5, 2)));
  EXPECT_TRUE(on_a_line(Eigen::MatrixXd::Zero(0, 2)));
  points(1, 2) = 2.0;
  EXPECT_FALSE(on_a_line(points));
}

}  // namespace
}  // namespace weft::solvers
