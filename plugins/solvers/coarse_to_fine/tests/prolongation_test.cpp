// SPDX-License-Identifier: Apache-2.0
#include "prolongation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <iostream>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::coarse_to_fine {
namespace {

/// Fine vertices of a surface, and its thinned mesh with a prolongation.
struct Carried {
  Template templ;
  coarse_mesh::CoarseMesh coarse;
  Prolongation prolongation;

  Carried(int columns, int rows, Eigen::Index count, const Points3* rest_m = nullptr) {
    testing::SheetSpec spec;
    spec.columns = columns;
    spec.rows = rows;
    templ = testing::make_template(spec);
    const auto built = coarse.build(templ, count);
    EXPECT_TRUE(built) << built.error().message;
    const Points3 flat_m = templ.vertices_m.matrix<3>();
    prolongation.build(coarse, coarse_mesh::places_of(templ), rest_m != nullptr ? *rest_m : flat_m);
  }

  Points3 carried_m(const Points3& truth_m) const {
    Points3 coarse_m(coarse.count(), 3);
    for (Eigen::Index c = 0; c < coarse_m.rows(); ++c) {
      coarse_m.row(c) = truth_m.row(coarse.vertices()[to_index(c)]);
    }
    return prolongation.surface_m(coarse_m);
  }

  double largest_error_m(const DevelopableSheet& sheet) const {
    const Points3 truth_m = testing::bent_vertices(templ, sheet);
    return (carried_m(truth_m) - truth_m).rowwise().norm().maxCoeff();
  }
};

TEST(Prolongation, KeepsASheetFlatWhereverItMoves) {
  const Carried sheet(41, 27, 100);
  EXPECT_LT(sheet.largest_error_m(testing::make_cylinder({}, 1e9, 0.3, {0.5, 0.1, 0, 0.4, 0.2, 1})),
            1e-9);
}

TEST(Prolongation, OfACylinderAndAnSBendIsTheirSurface) {
  const Carried sheet(41, 27, 120);
  const double cylinder_m = sheet.largest_error_m(testing::make_cylinder({}, 0.15, 0.3));
  SheetBend s_bend{0.2, 0.0, {{8.0, 0.3, 0.0}}};
  const double s_bend_m = sheet.largest_error_m(testing::make_bent_sheet({}, s_bend));
  std::cout << "largest error: cylinder " << 1e3 * cylinder_m << " mm, s-bend " << 1e3 * s_bend_m
            << " mm\n";
  EXPECT_LT(cylinder_m, 0.0002);
  EXPECT_LT(s_bend_m, 0.0002);
}

TEST(Prolongation, OfAShapeThatOnlyMovesIsExactHoweverCurvedItIsAtRest) {
  testing::SheetSpec spec;
  spec.columns = 41;
  spec.rows = 27;
  const Template flat = testing::make_template(spec);
  const auto sheet = testing::make_cylinder({}, 0.05, 0.3);
  Points3 rest_m = testing::bent_vertices(flat, sheet);
  std::cout << "seed 5\n";
  Rng rng(5);
  for (Eigen::Index v = 0; v < rest_m.rows(); ++v) rest_m(v, 2) += 0.001 * rng.uniform();
  const Carried carried(41, 27, 60, &rest_m);
  const Eigen::AngleAxisd turn(1.2, Eigen::Vector3d(1.0, 2.0, -1.0).normalized());
  const Points3 moved_m =
      (rest_m * turn.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(0.1, 0.2, 0.3);
  EXPECT_LT((carried.carried_m(moved_m) - moved_m).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace weft::coarse_to_fine
