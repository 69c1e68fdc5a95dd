// SPDX-License-Identifier: Apache-2.0
#include "common/hidden_bend.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/synthetic.hpp>

#include "scene.hpp"

namespace weft::particle_sft {
namespace {

using solvers::add_uncovered;
using solvers::add_unmeasured;
using solvers::BendContinuation;
using solvers::hidden_part;
using solvers::HiddenBend;

constexpr int kColumns = 13, kRows = 9;

/// A fine surface, flat and bent to a cylinder whose rulings are slanted; its last columns are
/// hidden.
struct RolledSheet {
  testing::SheetSpec sheet{kColumns, kRows, 0.24, 0.16, 600, 400};
  Template templ = testing::make_template(sheet);
  MeshTopology topology = *build_topology(templ.faces.matrix<3>(), kColumns* kRows);
  std::vector<DistanceConstraint> bending =
      *distance_constraints(topology.bending_pairs, templ.vertices_m.matrix<3>());
  IndexLists neighbours = vertex_neighbours(topology.edges, kColumns* kRows);
  std::vector<std::uint8_t> hidden = std::vector<std::uint8_t>(kColumns * kRows, 0);
  BendContinuation continuation;

  RolledSheet() {
    EXPECT_TRUE(continuation.build(templ));
    for (int v = 0; v < kColumns * kRows; ++v) {
      hidden[to_index(v)] = v % kColumns >= 9 ? 1 : 0;
    }
  }

  Points3 cylinder(double radius_m) const {
    return testing::bent_vertices(templ, testing::make_cylinder(sheet, radius_m, 0.3));
  }

  /// The same with the hidden part anywhere.
  Points3 spoilt(Points3 shape_m) const {
    for (Eigen::Index v = 0; v < shape_m.rows(); ++v) {
      if (hidden[to_index(v)] != 0) shape_m.row(v) << 0.3, 0.2, 0.9;
    }
    return shape_m;
  }

  Visibility visibility() const {
    Visibility seen;
    seen.visible = Array<std::uint8_t>({kColumns * kRows}, 0);
    seen.reason = Array<std::uint8_t>({kColumns * kRows}, 0);
    std::fill_n(seen.visible.data(), kColumns * kRows, 1);
    return seen;
  }
};

double largest_error_m(const Points3& a, const Points3& b) {
  return (a - b).rowwise().norm().maxCoeff();
}

TEST(HiddenBend, GoesOnWithACylinderBothWaysRound) {
  const RolledSheet scene;
  for (const double radius_m : {0.1, -0.1}) {
    const Points3 truth_m = scene.cylinder(radius_m);
    const HiddenBend bend =
        scene.continuation.continued(scene.spoilt(truth_m), scene.hidden, scene.bending);
    EXPECT_LT(largest_error_m(bend.shape_m, truth_m), 1.5e-3) << radius_m;
    EXPECT_LT(strain_statistics(
                  *distance_constraints(scene.topology.edges, scene.templ.vertices_m.matrix<3>()),
                  bend.shape_m)
                  .max,
              0.01)
        << radius_m;
  }
}

TEST(HiddenBend, EndsWhereTheBendOfTheSeenPartFades) {
  const RolledSheet scene;
  // Bent by less and less up to the hidden columns, and straight there.
  constexpr double kStraightFrom_m = 0.17, kMost_per_m = 14.0, kStep_m = 1e-4;
  std::vector<Eigen::Vector2d> curve_m{Eigen::Vector2d::Zero()};
  for (double s_m = 0.0, turn_rad = 0.0; s_m < 0.25; s_m += kStep_m) {
    turn_rad += kStep_m * kMost_per_m * std::max(0.0, 1.0 - s_m / kStraightFrom_m);
    curve_m.emplace_back(curve_m.back() +
                         kStep_m * Eigen::Vector2d(std::cos(turn_rad), std::sin(turn_rad)));
  }
  Points3 truth_m = scene.templ.vertices_m.matrix<3>();
  const double left_m = truth_m.col(0).minCoeff();
  for (Eigen::Index v = 0; v < truth_m.rows(); ++v) {
    const auto place = to_index((truth_m(v, 0) - left_m) / kStep_m + 0.5);
    truth_m.row(v) << curve_m[place].x(), truth_m(v, 1), curve_m[place].y();
  }
  const HiddenBend bend =
      scene.continuation.continued(scene.spoilt(truth_m), scene.hidden, scene.bending);
  EXPECT_LT(largest_error_m(bend.shape_m, truth_m), 5e-3);
}

TEST(HiddenBend, LeavesAFlatSheetFlatAndItsRestLengthsAlone) {
  const RolledSheet scene;
  const Points3 flat_m = scene.templ.vertices_m.matrix<3>();
  const HiddenBend bend =
      scene.continuation.continued(scene.spoilt(flat_m), scene.hidden, scene.bending);
  EXPECT_LT(largest_error_m(bend.shape_m, flat_m), 1e-9);
  for (std::size_t i = 0; i < scene.bending.size(); ++i) {
    EXPECT_NEAR(bend.bending[i].rest_length_m, scene.bending[i].rest_length_m, 1e-9);
  }
}

TEST(HiddenBend, ChangesRestLengthsInTheHiddenPartOnly) {
  const RolledSheet scene;
  const Points3 truth_m = scene.cylinder(0.08);
  const HiddenBend bend =
      scene.continuation.continued(scene.spoilt(truth_m), scene.hidden, scene.bending);
  const auto is_hidden = [&](std::int32_t v) { return scene.hidden[to_index(v)]; };
  int changed = 0;
  for (std::size_t i = 0; i < scene.bending.size(); ++i) {
    const DistanceConstraint& pair = bend.bending[i];
    if (pair.i % kColumns < 8 && pair.j % kColumns < 8) {
      EXPECT_EQ(pair.rest_length_m, scene.bending[i].rest_length_m);
    } else if (is_hidden(pair.i) && is_hidden(pair.j)) {
      const double true_m = (truth_m.row(pair.i) - truth_m.row(pair.j)).norm();
      EXPECT_NEAR(pair.rest_length_m, true_m, 2e-4);
      ++changed;
    }
  }
  EXPECT_GT(changed, 30);
}

TEST(HiddenBend, LeavesAShapeOfWhichNothingIsSeen) {
  RolledSheet scene;
  const Points3 shape_m = scene.cylinder(0.1);
  std::fill(scene.hidden.begin(), scene.hidden.end(), 1);
  EXPECT_EQ(scene.continuation.continued(shape_m, scene.hidden, scene.bending).shape_m, shape_m);
}

TEST(HiddenBend, IsNotContinuedIntoAFoldThatItWouldTear) {
  RolledSheet scene;
  // Both ends are seen where a bump of the middle columns brings them; the middle is hidden.
  const auto folded = [&](double rise_m) {
    Points3 shape_m = scene.templ.vertices_m.matrix<3>();
    for (Eigen::Index v = 0; v < shape_m.rows(); ++v) {
      const double column = static_cast<double>(v % kColumns);
      const double bump = std::max(0.0, 1.0 - std::abs(column - 6.0) / 3.0);
      shape_m(v, 2) += rise_m * bump;
      if (column > 6.0) shape_m(v, 0) -= 0.04;
    }
    return shape_m;
  };
  for (int v = 0; v < kColumns * kRows; ++v) {
    scene.hidden[to_index(v)] = v % kColumns >= 4 && v % kColumns <= 8 ? 1 : 0;
  }
  const Points3 shape_m = folded(0.03);
  const HiddenBend bend = scene.continuation.continued(shape_m, scene.hidden, scene.bending);
  EXPECT_EQ(bend.shape_m, shape_m);
  EXPECT_EQ(bend.torn_vertices, 5 * kRows);
  for (std::size_t i = 0; i < scene.bending.size(); ++i) {
    EXPECT_EQ(bend.bending[i].rest_length_m, scene.bending[i].rest_length_m);
  }
}

TEST(HiddenBend, TakesPartsWithoutARayThatReachTheBorderForUncovered) {
  const RolledSheet scene;
  MeshModel mesh;
  ASSERT_TRUE(mesh.build(scene.templ, 0.0));
  const auto is_ringed = [](std::int32_t v) { return v == 4 * kColumns + 4; };
  const auto is_corner = [](std::int32_t v) { return v % kColumns >= 10 && v / kColumns >= 6; };
  std::vector<RayConstraint> rays;
  for (std::int32_t v = 0; v < kColumns * kRows; ++v) {
    if (!is_ringed(v) && !is_corner(v)) rays.push_back({{v, v, v}, {1, 0, 0}, {0, 0, 1}, 1.0});
  }
  std::vector<std::uint8_t> uncovered;
  add_uncovered(observed_vertices(rays, {}, mesh.vertex_count()), mesh.neighbours(), mesh.border(),
                uncovered);
  ASSERT_EQ(uncovered.size(), to_index(kColumns * kRows));
  for (std::int32_t v = 0; v < kColumns * kRows; ++v) {
    EXPECT_EQ(uncovered[to_index(v)] != 0, is_corner(v)) << v;
  }
}

TEST(HiddenBend, TakesTheUnmeasuredVerticesBesideAHiddenOneAsHidden) {
  const RolledSheet scene;
  Visibility seen = scene.visibility();
  std::vector<RayConstraint> rays;
  for (std::int32_t v = 0; v < kColumns * kRows; ++v) {
    if (v % kColumns < 6 && v != 0) rays.push_back({{v, v, v}, {1, 0, 0}, {0, 0, 1}, 1.0});
  }
  const std::vector<std::uint8_t> measured = observed_vertices(rays, {}, kColumns * kRows);
  EXPECT_TRUE(hidden_part(seen, measured, scene.neighbours)->empty()) << "unmeasured is not hidden";
  seen.visible(12) = 0;
  seen.reason(12) = static_cast<std::uint8_t>(SightReason::outside);
  EXPECT_TRUE(hidden_part(seen, measured, scene.neighbours)->empty()) << "nor is what is outside";
  seen.reason(12) = static_cast<std::uint8_t>(SightReason::hidden);
  const auto hidden = hidden_part(seen, measured, scene.neighbours);
  ASSERT_TRUE(hidden);
  for (std::int32_t v = 0; v < kColumns * kRows; ++v) {
    EXPECT_EQ((*hidden)[to_index(v)], v % kColumns >= 6 ? 1 : 0) << v;
  }
  seen.visible = Array<std::uint8_t>({5}, 0);
  EXPECT_FALSE(hidden_part(seen, measured, scene.neighbours));
}

TEST(HiddenBend, BringsASolverNearerToWhatItCannotSee) {
  Scene scene = Scene::bent(0.09);
  scene.seen.clear();
  Visibility sight;
  sight.visible = Array<std::uint8_t>({60}, 0);
  sight.reason = Array<std::uint8_t>({60}, 0);
  sight.score = Array<double>({60}, 0.0);
  for (std::int32_t v = 0; v < 60; ++v) {
    const bool seen = v % 10 >= 2 && v % 10 <= 7;
    sight.visible(v) = seen ? 1 : 0;
    sight.reason(v) = static_cast<std::uint8_t>(seen ? SightReason::seen : SightReason::hidden);
    if (seen) scene.seen.push_back(v);
  }
  scene.look();
  testing::PluginUnderTest plugin(kId), flat(kId, "{continue_uncovered_bend: false}");
  const testing::PluginAnswer without = scene.run(flat);
  ASSERT_EQ(without.status, WEFT_OK) << without.message;
  const Shape first = without.get<Shape>().value();
  const testing::PluginAnswer with = plugin.process(
      0, {testing::input("template", scene.templ), testing::input("camera", scene.camera),
          testing::input("sightlines", scene.lines), testing::input("previous.shape", first),
          testing::input("visibility", sight)});
  ASSERT_EQ(with.status, WEFT_OK) << with.message;
  const auto hidden_error_m = [&](const Shape& shape) {
    double sum = 0.0;
    for (std::int64_t v = 0; v < 60; ++v) {
      const Eigen::RowVector3d offset = shape.vertices_m.matrix<3>().row(v) - scene.truth_m.row(v);
      sum += sight.visible(v) == 0 ? offset.norm() / 24.0 : 0.0;
    }
    return sum;
  };
  EXPECT_LT(hidden_error_m(with.get<Shape>().value()), 0.5 * hidden_error_m(first));
  const testing::PluginAnswer uncovered = scene.run(plugin);  // visible but not recognised
  ASSERT_EQ(uncovered.status, WEFT_OK) << uncovered.message;
  EXPECT_LT(hidden_error_m(uncovered.get<Shape>().value()), 0.5 * hidden_error_m(first));
}

/// Marks every vertex as seen.
Visibility all_in_sight(std::int64_t count) {
  Visibility sight;
  sight.visible = Array<std::uint8_t>({count}, 0);
  sight.reason = Array<std::uint8_t>({count}, 0);
  sight.score = Array<double>({count}, 0.0);
  std::fill_n(sight.visible.data(), count, std::uint8_t{1});
  std::fill_n(sight.score.data(), count, 1.0);
  return sight;
}

TEST(HiddenBend, AddsEveryVertexWithoutARayToTheHiddenOnes) {
  const std::vector<RayConstraint> rays{{{0, 1, 2}, {0.5, 0.3, 0.2}, {0, 0, 1}, 1.0}};
  std::vector<std::uint8_t> hidden{0, 1, 0, 0, 1};
  const std::vector<std::uint8_t> measured = observed_vertices(rays, {}, 5);
  add_unmeasured(measured, hidden);
  EXPECT_EQ(hidden, (std::vector<std::uint8_t>{0, 1, 0, 1, 1}));
  std::vector<std::uint8_t> nothing_hidden;
  add_unmeasured(measured, nothing_hidden);
  EXPECT_EQ(nothing_hidden, (std::vector<std::uint8_t>{0, 0, 0, 1, 1}));
}

/// Half a cylinder at rest that has opened. Its middle six of ten columns have sightlines. Its
/// sides are visible but nothing is recognised there.
struct OpenedHalfCylinder {
  static constexpr double kRest_m = 0.297 / 3.14159265358979;
  Scene scene;

  OpenedHalfCylinder() {
    const Template flat = scene.templ;
    const testing::PoseSpec ahead{0.6, 0, 0, 0, 0, 0};
    const auto bent_m = [&](double radius_m) {
      return testing::bent_vertices(
          flat, testing::make_cylinder(reference_sheet(), radius_m, 0.0, ahead));
    };
    scene.templ.vertices_m = make_array<double>(bent_m(kRest_m));
    scene.truth_m = bent_m(1.25 * kRest_m);
    scene.seen.clear();
    for (std::int32_t v = 0; v < 60; ++v) {
      if (!is_side(v)) scene.seen.push_back(v);
    }
    scene.look();
  }

  static bool is_side(std::int64_t v) { return v % 10 < 2 || v % 10 > 7; }

  /// The truth with its sides mirrored at the planes of the outermost strips that are measured.
  Points3 sides_bent_back() const {
    Points3 shape_m = scene.truth_m;
    for (const auto& [rim, next] : {std::pair(2, 3), std::pair(7, 6)}) {
      const Eigen::Vector3d place_m = scene.truth_m.row(rim);
      const Eigen::Vector3d along_m = scene.truth_m.row(rim + 10).transpose() - place_m;
      const Eigen::Vector3d inwards_m = scene.truth_m.row(next).transpose() - place_m;
      const Eigen::Vector3d normal = along_m.cross(inwards_m).normalized();
      for (Eigen::Index v = 0; v < 60; ++v) {
        if (!is_side(v) || (v % 10 < 5) != (rim < 5)) continue;
        const Eigen::Vector3d offset_m = shape_m.row(v).transpose() - place_m;
        shape_m.row(v) -= 2.0 * normal.dot(offset_m) * normal.transpose();
      }
    }
    return shape_m;
  }

  double side_error_m(const Points3& shape_m) const {
    double sum_m = 0.0;
    for (Eigen::Index v = 0; v < 60; ++v) {
      if (is_side(v)) sum_m += (shape_m.row(v) - scene.truth_m.row(v)).norm() / 24.0;
    }
    return sum_m;
  }

  double side_error_m(testing::PluginUnderTest& plugin) const {
    const testing::PluginAnswer outcome = plugin.process(
        0, {testing::input("template", scene.templ), testing::input("camera", scene.camera),
            testing::input("sightlines", scene.lines),
            testing::input("previous.shape", shape_of(sides_bent_back())),
            testing::input("visibility", all_in_sight(60))});
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.message;
    return side_error_m(Points3(outcome.get<Shape>().value().vertices_m.matrix<3>()));
  }
};

TEST(HiddenBend, LaysOutTheSidesOfACurvedTemplateOnWhichNothingIsRecognised) {
  const OpenedHalfCylinder object;
  EXPECT_GT(object.side_error_m(object.sides_bent_back()), 0.02);
  testing::PluginUnderTest without(kId,
                                   "{continue_hidden_bend: false, continue_uncovered_bend: false}");
  EXPECT_GT(object.side_error_m(without), 0.01) << "distances alone keep the opposite bend";
  testing::PluginUnderTest with(kId);
  EXPECT_LT(object.side_error_m(with), 2e-3);
}

}  // namespace
}  // namespace weft::particle_sft
