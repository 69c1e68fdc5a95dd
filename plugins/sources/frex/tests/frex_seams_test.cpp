// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rigid_alignment.hpp>

#include "charted_objects.hpp"
#include "small_film.hpp"

namespace weft::testing {
namespace {

/// The object of a mesh file, bent with the usual size by default.
class SeamFilm : public OpenFilm {
 public:
  SeamFilm(const std::string& obj, const std::string& more)
      : OpenFilm("sources/frex_object",
                 "{object: {use: templates/mesh, params: {mesh: " + obj +
                     ", texture: " + WEFT_TEXTURES +
                     "sheet_texture.png, unit_m: 0.001}}, image_width_px: 320, image_height_px: "
                     "240, focal_px: 400, distance_m: 0.4, fps: 10, period_s: 1.6, dense_truth: "
                     "false, " +
                     more + "}") {}
};

/// Pairs of points at one place.
std::vector<std::pair<Eigen::Index, Eigen::Index>> twins_in(const GroundTruth& truth) {
  const auto points = truth.points_m.matrix<3>();
  std::map<std::tuple<double, double, double>, Eigen::Index> at;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> twins;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto [found, is_new] = at.try_emplace({points(i, 0), points(i, 1), points(i, 2)}, i);
    if (!is_new) twins.emplace_back(found->second, i);
  }
  return twins;
}

struct SeamCase {
  const char* name;
  std::string (*obj)();
  std::size_t twins;
};

class FrexSeams : public ::testing::TestWithParam<SeamCase> {};

TEST_P(FrexSeams, StayClosedWhileTheObjectKeepsItsLengths) {
  for (const char* pattern : {"wave", "bulge", "handles"}) {
    SCOPED_TRACE(pattern);
    SeamFilm film(GetParam().obj(), std::string("pattern: ") + pattern);
    const GroundTruth first = film.truth(0);
    const auto twins = twins_in(first);
    EXPECT_EQ(twins.size(), GetParam().twins);
    Points3 before = first.points_m.matrix<3>();
    double moved_m = 0.0;
    for (std::uint64_t frame = 1; frame <= 20; ++frame) {
      const GroundTruth truth = film.truth(frame);
      const Points3 now = truth.points_m.matrix<3>();
      for (const auto& [a, b] : twins) ASSERT_EQ(now.row(a), now.row(b));
      EXPECT_LT(truth.diag.value("edge_strain", 1.0), 0.002) << "frame " << frame;
      const double step_m = (now - before).rowwise().norm().maxCoeff();
      EXPECT_LT(step_m, 0.04) << "frame " << frame;
      moved_m = std::max(moved_m, step_m);
      before = now;
    }
    EXPECT_GT(moved_m, 0.001);
  }
}

TEST_P(FrexSeams, MoveRigidlyWithoutBend) {
  SeamFilm film(GetParam().obj(), "pattern: wave, bend: 0");
  const Points3 first = film.truth(0).points_m.matrix<3>();
  for (const std::uint64_t frame : {5, 11}) {
    const auto pose = align_points(first, film.truth(frame).points_m.matrix<3>());
    ASSERT_TRUE(pose);
    EXPECT_LT(pose->rms, 1e-9);
  }
}

std::string closed_can() { return can_obj(33, 100, 2); }
std::string open_can() { return can_obj(33, 100, 1); }
std::string cushion() { return cushion_obj(120, 30); }
std::string box() { return box_obj(150, 60, 40); }

// Points with a twin. The can has a seam of 9 and a rim of 32 for each lid, and the cushion a rim
// of
// 48. The box has 12 edges of 7 inner vertices, and 8 corners with two twins each.
INSTANTIATE_TEST_SUITE_P(Objects, FrexSeams,
                         ::testing::Values(SeamCase{"closed_can", closed_can, 9 + 2 * 32},
                                           SeamCase{"open_can", open_can, 9 + 32},
                                           SeamCase{"cushion", cushion, 48},
                                           SeamCase{"box", box, 12 * 7 + 8 * 2}),
                         [](const auto& object) { return std::string(object.param.name); });

/// mm: a flat surface of two charts, which meet at a straight seam.
std::string halved_sheet() {
  ObjWriter obj;
  for (const double left : {0.0, 0.5}) {
    obj.add([&](double s, double t) { return Eigen::Vector3d(120 * (left + 0.5 * s), 80 * t, 0); },
            10, 12, {0.02 + left, 0.02, 0.46, 0.9});
  }
  return obj.write("halves");
}

TEST(FrexSeams, OfAFlatObjectLetItBendAsClothDoes) {
  SeamFilm film(halved_sheet(), "pattern: roll, bend: 0.7");
  const auto twins = twins_in(film.truth(0));
  ASSERT_EQ(twins.size(), 13U);
  const GroundTruth truth = film.truth(8);
  const auto points = truth.points_m.matrix<3>();
  for (const auto& [a, b] : twins) EXPECT_EQ(points.row(a), points.row(b));
  EXPECT_LT(truth.diag.value("edge_strain", 1.0), 0.002);
  const auto flat = align_points(film.truth(0).points_m.matrix<3>(), points);
  ASSERT_TRUE(flat);
  EXPECT_GT(flat->rms, 0.005) << "the surface is not bent";
}

}  // namespace
}  // namespace weft::testing
