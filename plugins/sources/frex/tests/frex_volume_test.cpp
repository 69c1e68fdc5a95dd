// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "charted_objects.hpp"
#include "small_film.hpp"

namespace weft::testing {
namespace {

std::string mesh_template(const std::string& obj) {
  return "{use: templates/mesh, params: {mesh: " + obj + ", texture: " + WEFT_TEXTURES +
         "sheet_texture.png, unit_m: 0.001}}";
}

std::string volume_params(const std::string& obj, const std::string& more) {
  return "{object: " + mesh_template(obj) +
         ", image_width_px: 320, image_height_px: 240, focal_px: 400, distance_m: 0.4, fps: 10, "
         "period_s: 2" +
         (more.empty() ? "" : ", ") + more + "}";
}

class VolumeFilm : public OpenFilm {
 public:
  VolumeFilm(const std::string& obj, const std::string& more)
      : OpenFilm("sources/frex_volume", volume_params(obj, more)) {}
};

/// The first point at the place of each.
std::vector<Eigen::Index> first_there(const GroundTruth& truth) {
  const auto points = truth.points_m.matrix<3>();
  std::map<std::tuple<long, long, long>, Eigen::Index> at;
  std::vector<Eigen::Index> first;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto key = [&](int k) { return std::lround(1e8 * points(i, k)); };
    first.push_back(at.try_emplace({key(0), key(1), key(2)}, i).first->second);
  }
  return first;
}

/// The side of the box to which template points belong, by the layout of box_obj().
class Charts {
 public:
  explicit Charts(const GroundTruth& truth)
      : largest_(truth.template_xy_m.matrix<2>().colwise().maxCoeff()) {}

  /// -1 for no side.
  int of(const Eigen::Vector2d& template_m) const {
    if (template_m.hasNaN()) return -1;
    const int column = static_cast<int>((0.97 * template_m.x() / largest_.x() - 0.005) / 0.33);
    return 2 * column + (0.98 * template_m.y() / largest_.y() > 0.5 ? 1 : 0);
  }

 private:
  Eigen::Vector2d largest_;
};

/// The point at which the map of template points has that of true point `i`. The four pixels around
/// the image of the point determine the map, unless one of them shows another side.
std::optional<Eigen::Vector2d> place_in_map(const GroundTruth& truth, Eigen::Index i,
                                            const Eigen::Vector2d& pixel) {
  const Charts charts(truth);
  const auto x = static_cast<std::int64_t>(std::floor(pixel.x()));
  const auto y = static_cast<std::int64_t>(std::floor(pixel.y()));
  const Eigen::Vector2d there(truth.template_xy_m(i, 0), truth.template_xy_m(i, 1));
  std::array<Eigen::Vector2d, 4> uv;
  for (std::int64_t k = 0; k < 4; ++k) {
    const float* at = truth.uv_m.row(y + k / 2) + 2 * (x + k % 2);
    uv[to_index(k)] = Eigen::Vector2d(at[0], at[1]);
    if (charts.of(uv[to_index(k)]) != charts.of(there)) return std::nullopt;
  }
  const auto& [a, b, c, d] = uv;
  Eigen::Matrix2d slope;
  slope << 0.5 * (b - a + d - c), 0.5 * (c - a + d - b);
  return slope.inverse() * (there - 0.25 * (a + b + c + d)) +
         Eigen::Vector2d(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
}

/// m^3, of a closed surface.
double volume_m3(const GroundTruth& truth) {
  const auto points = truth.points_m.matrix<3>();
  double volume = 0.0;
  for (Eigen::Index f = 0; f < truth.faces.rows(); ++f) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return points.row(truth.faces(f, k)).transpose();
    };
    volume += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
  }
  return volume;
}

class VolumeMotions : public ::testing::TestWithParam<std::string> {};

TEST_P(VolumeMotions, KeepSeamsClosedAndTheVolume) {
  VolumeFilm film(box_obj(150, 60, 40, 16), "dense_truth: false, motion: " + GetParam());
  const GroundTruth rest = film.truth(0);
  const auto first = first_there(rest);
  const double volume = 0.15 * 0.06 * 0.04;
  EXPECT_NEAR(volume_m3(rest), volume, 1e-9 * volume);
  double moved_m = 0.0;
  for (std::uint64_t frame = 1; frame <= 20; frame += 3) {
    const GroundTruth truth = film.truth(frame);
    const auto points = truth.points_m.matrix<3>();
    Eigen::Index twins = 0;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      if (first[to_index(i)] == i) continue;
      ASSERT_EQ(points.row(i), points.row(first[to_index(i)]));
      ++twins;
    }
    EXPECT_EQ(twins, 12 * 15 + 8 * 2);
    // The truth's faces are chords of the curved sides.
    EXPECT_NEAR(volume_m3(truth), volume, 2e-3 * volume) << "frame " << frame;
    moved_m = std::max(moved_m, truth.diag.value("stretch_max", 0.0));
  }
  EXPECT_GT(moved_m, 0.05) << "the solid stays at rest";
}

TEST_P(VolumeMotions, ShowTruePointsWhereTheMapOfTheTextureHasThem) {
  VolumeFilm film(box_obj(150, 60, 40), "motion: " + GetParam());
  const auto first = first_there(film.truth(0));
  for (const std::uint64_t frame : {0, 4, 10, 13}) {
    const GroundTruth truth = film.truth(frame);
    const auto points = truth.points_m.matrix<3>();
    std::vector<int> together(first.size());
    for (const Eigen::Index there : first) ++together[to_index(there)];
    int seen = 0, compared = 0;
    double worst_px = 0.0;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      if (truth.visible(i) == 0 || together[to_index(first[to_index(i)])] > 1) continue;
      ++seen;
      const Eigen::Vector2d pixel = project(film.pinhole(), points.row(i).transpose());
      const auto there = place_in_map(truth, i, pixel);
      if (!there) continue;
      ++compared;
      worst_px = std::max(worst_px, (*there - pixel).norm());
    }
    EXPECT_GT(seen, 250) << "frame " << frame;
    EXPECT_GT(compared, 0.8 * seen) << "frame " << frame;
    EXPECT_LT(worst_px, 0.1) << "frame " << frame;
    RecordProperty("worst_px_" + std::to_string(frame), std::to_string(worst_px));
  }
}

INSTANTIATE_TEST_SUITE_P(All, VolumeMotions, ::testing::Values("bend", "twist", "press"),
                         [](const auto& motion) { return motion.param; });

TEST(FrexVolume, IsRigidAtFirstAndFacesTheCameraTurnedByTheView) {
  const std::string obj = box_obj(40, 150, 60);
  VolumeFilm turned(obj, "dense_truth: false"), facing(obj, "view_rad: [0, 0, 0]");
  PluginUnderTest object("templates/mesh", "{mesh: " + obj + ", texture: " + WEFT_TEXTURES +
                                               "sheet_texture.png, unit_m: 0.001}");
  const auto templ = object.process(0, {}).get<Template>();
  ASSERT_TRUE(templ.has_value());
  const auto rest_m = templ->vertices_m.matrix<3>();
  const GroundTruth first = turned.truth(0), flat = facing.truth(0);
  ASSERT_EQ(first.count(), rest_m.rows() + templ->faces.rows());
  const auto points_m = first.points_m.matrix<3>();
  for (Eigen::Index i = 0; i < rest_m.rows(); i += 7) {
    for (Eigen::Index j = 0; j < i; j += 5) {
      EXPECT_NEAR((points_m.row(i) - points_m.row(j)).norm(),
                  (rest_m.row(i) - rest_m.row(j)).norm(), 1e-9);
    }
    EXPECT_NEAR(first.template_xy_m(i, 0), templ->m_per_px(0) * templ->flat_px(i, 0), 1e-15);
  }
  // One side of the box that faces the camera is seen, three of the turned one.
  const auto extent_m = [](const GroundTruth& truth) -> Eigen::RowVector3d {
    const auto points = truth.points_m.matrix<3>();
    return points.colwise().maxCoeff() - points.colwise().minCoeff();
  };
  EXPECT_LT((extent_m(flat) - Eigen::RowVector3d(0.15, 0.06, 0.04)).norm(), 1e-9);
  const auto seen = [](const GroundTruth& truth) {
    return static_cast<double>(truth.visible.matrix<1>().cast<int>().sum()) /
           static_cast<double>(truth.count());
  };
  EXPECT_NEAR(seen(flat), 1.0 / 6.0, 0.02);
  EXPECT_NEAR(seen(first), 3.0 / 6.0, 0.06);
}

TEST(FrexVolume, TellsTheCentreOfEachFaceAsAPointOfTheSurface) {
  VolumeFilm film(box_obj(150, 60, 40), "motion: twist");
  const GroundTruth rest = film.truth(0);
  const auto points = rest.points_m.matrix<3>();
  const auto flat = rest.template_xy_m.matrix<2>();
  // Three faces at each centre.
  const Eigen::Index faces = rest.faces.rows() / 3, vertices = rest.count() - faces;
  for (Eigen::Index f = 0; f < faces; ++f) {
    ASSERT_EQ(rest.faces(3 * f, 2), vertices + f);
    Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
    Eigen::RowVector2d texture = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k) {
      place += points.row(rest.faces(3 * f + k, 0)) / 3.0;
      texture += flat.row(rest.faces(3 * f + k, 0)) / 3.0;
    }
    EXPECT_LT((place - points.row(vertices + f)).norm(), 1e-12);
    EXPECT_LT((texture - flat.row(vertices + f)).norm(), 1e-12);
  }
}

TEST(FrexVolume, GivesTheSameFrameInAnyOrder) {
  const std::string obj = can_obj(30, 120, 2);
  VolumeFilm one(obj, "occluder: true, mask: true"), other(obj, "occluder: true, mask: true");
  const auto late = one.pixels(7);
  one.pixels(2);
  other.pixels(2);
  EXPECT_EQ(other.pixels(7), late);
  EXPECT_EQ(one.pixels(7), late);
  EXPECT_TRUE(one.read(7).get<ObjectMask>().has_value());
}

TEST(FrexVolume, FilmsAnOpenSurfaceFromItsTexturedSide) {
  VolumeFilm film(std::string(WEFT_TEXTURES) + "label.obj", "view_rad: [0, 0, 0], angle_rad: 0.5");
  const GroundTruth truth = film.truth(0);
  EXPECT_EQ(truth.visible.matrix<1>().cast<int>().sum(), truth.count());
}

std::string volume_refusal(const std::string& parameters) {
  try {
    OpenFilm film("sources/frex_volume", parameters);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(FrexVolume, RefusesWhatItCannotFilm) {
  const std::string cube = box_obj(60, 60, 60);
  const auto expect_named = [](const std::string& parameters, const char* name) {
    const std::string message = volume_refusal(parameters);
    EXPECT_NE(message.find(name), std::string::npos) << message;
  };
  expect_named(volume_params(cube, "angle_rad: 1.2"), "give at most 0.99");
  expect_named(volume_params(cube, "view_rad: [0, 1]"), "'view_rad' has 2 numbers");
  expect_named(volume_params(cube, "edge_m: 0.00001"), "'edge_m'");
  EXPECT_EQ(volume_refusal(volume_params(cube, "motion: twist, angle_rad: 1.2")), "");
}

}  // namespace
}  // namespace weft::testing
