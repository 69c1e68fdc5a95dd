// SPDX-License-Identifier: Apache-2.0
// Compares a film of a bent surface with the exact surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/testing/synthetic.hpp>

#include "background.hpp"
#include "common/scene/sheet_renderer.hpp"
#include "sheet_mesh.hpp"

namespace weft::synthetic {
namespace {

constexpr int kColumns = 600, kRows = 424;
const testing::SheetSpec kSheet{2, 2, 0.297, 0.20988, kColumns, kRows};
const Pitch kPitch{0.297 / kColumns, 0.297 / kColumns};

template <class Grey>
scene::Picture make_print(int width, int height, const Grey& grey) {
  scene::Picture print{width, height};
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      print.pixels.emplace_back(scene::Colour::Constant(static_cast<float>(grey(u, v))));
    }
  }
  return print;
}

scene::Picture plain(double grey, int width = kColumns, int height = kRows) {
  return make_print(width, height, [&](int, int) { return grey; });
}

std::vector<float> greys(const scene::Picture& picture) {
  std::vector<float> greys;
  for (const scene::Colour& pixel : picture.pixels) greys.push_back(pixel[0]);
  return greys;
}

/// The surface over black.
std::vector<float> render(const scene::Picture& print, const DevelopableSheet& sheet,
                          Pitch pitch_m = kPitch) {
  const SheetMesh mesh(print.width, print.height, pitch_m);
  auto renderer =
      scene::SheetRenderer::create(testing::make_camera(), scene::MipTexture(print, true),
                                   mesh.uv_px(), mesh.faces(), plain(0.0, 640, 480));
  return greys(renderer->render(mesh.vertices_m(sheet), room_light()).image);
}

double at(const std::vector<float>& image, const Eigen::Vector2d& pixel) {
  const auto x = std::lround(pixel.x()), y = std::lround(pixel.y());
  return image[to_index(y * 640 + x)];
}

DevelopableSheet bent_sheet() {
  const SheetBend bend{0.5, 4.0, {{3.0, 0.2, 0.3}}};
  return testing::make_bent_sheet(kSheet, bend, {0.6, 0.02, -0.01, 0.3, -0.35, 0.2});
}

constexpr double kDotRadius = 5.5;  // px of the texture

/// Darkness of a dot with a soft edge at a distance from its centre, 0 to 1.
double ink(double distance) { return std::clamp(kDotRadius + 0.5 - distance, 0.0, 1.0); }

/// Centroid of the image of a dot: each bit of it counts with the area on which it is imaged. It is
/// not quite the image of the dot's centre.
Eigen::Vector2d imaged_centroid(const DevelopableSheet& sheet, const Eigen::Vector2d& dot) {
  const Pinhole camera = testing::pinhole(testing::make_camera());
  const auto seen = [&](const Eigen::Vector2d& uv) {
    return project(camera, sheet.at(kPitch[0] * uv.x(), kPitch[1] * uv.y()));
  };
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  const double step = 0.25;
  for (double dv = -6.5; dv <= 6.5; dv += step) {
    for (double du = -6.5; du <= 6.5; du += step) {
      const Eigen::Vector2d uv = dot + Eigen::Vector2d(du, dv), here = seen(uv);
      const Eigen::Vector2d a = seen(uv + Eigen::Vector2d(step, 0)) - here;
      const Eigen::Vector2d b = seen(uv + Eigen::Vector2d(0, step)) - here;
      const double w = ink(std::hypot(du, dv)) * std::abs(a.x() * b.y() - a.y() * b.x());
      sum += w * here;
      weight += w;
    }
  }
  return sum / weight;
}

/// Centroid of the difference to blank paper in the same light, which is the texture alone.
Eigen::Vector2d drawn_centroid(const std::vector<float>& image, const std::vector<float>& blank,
                               const Eigen::Vector2d& near) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  for (int dy = -9; dy <= 9; ++dy) {
    for (int dx = -9; dx <= 9; ++dx) {
      const Eigen::Vector2d pixel = (near + Eigen::Vector2d(dx, dy)).array().round();
      if (at(blank, pixel) < 90.0) continue;  // beside the surface
      const double darkness = 1.0 - at(image, pixel) / at(blank, pixel);
      sum += darkness * pixel;
      weight += darkness;
    }
  }
  return sum / weight;
}

TEST(SheetPicture, DrawsDotsWhereTheirTruthProjects) {
  const DevelopableSheet sheet = bent_sheet();
  std::vector<Eigen::Vector2d> dots;
  for (int j = 0; j < 7; ++j) {
    for (int i = 0; i < 10; ++i) dots.emplace_back(30.0 + 60.0 * i, 30.0 + 60.3 * j);
  }
  const scene::Picture printed = make_print(kColumns, kRows, [&](int u, int v) {
    double grey = 220.0;
    for (const Eigen::Vector2d& dot : dots) {
      grey -= 200.0 * ink((Eigen::Vector2d(u, v) - dot).norm());
    }
    return grey;
  });
  const std::vector<float> image = render(printed, sheet), blank = render(plain(220.0), sheet);
  double worst_px = 0.0, worst_point_px = 0.0;
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& dot : dots) {
    const Eigen::Vector2d truth = project(testing::pinhole(testing::make_camera()),
                                          sheet.at(kPitch[0] * dot.x(), kPitch[1] * dot.y()));
    const Eigen::Vector2d centre = drawn_centroid(image, blank, truth);
    const Eigen::Vector2d error = centre - imaged_centroid(sheet, dot);
    ASSERT_TRUE(error.allFinite());
    worst_point_px = std::max(worst_point_px, (centre - truth).norm());
    worst_px = std::max(worst_px, error.norm());
    mean_px += error / static_cast<double>(dots.size());
  }
  RecordProperty("worst_point_px", std::to_string(worst_point_px));
  RecordProperty("worst_px", std::to_string(worst_px));
  EXPECT_LT(worst_point_px, 0.05);
  EXPECT_LT(worst_px, 0.02);
  EXPECT_LT(mean_px.norm(), 0.002);
}

TEST(SheetPicture, CoversTheAreaOfTheSheet) {
  const DevelopableSheet sheet = testing::make_bent_sheet(kSheet, {}, {0.6, 0.0031, 0.0017});
  const std::vector<float> image = render(plain(100.0), sheet);
  const double total = std::accumulate(image.begin(), image.end(), 0.0);
  const double brightest = *std::max_element(image.begin(), image.end());
  const double area_px = 0.297 * 0.20988 * 820.0 * 820.0 / 0.36;
  EXPECT_NEAR(total / brightest, area_px, 0.002 * area_px);
}

TEST(SheetPicture, LeavesNoHoles) {
  const scene::Picture paper = plain(200.0);
  for (const double tilt : {-0.4, -0.1, 0.0, 0.25, 0.5}) {
    const DevelopableSheet sheet = testing::make_bent_sheet(
        kSheet, {tilt, 5.0, {{2.0, 0.15, 1.0}}}, {0.62, 0.0, 0.0, tilt, 0.7 * tilt, 2.0 * tilt});
    const std::vector<float> image = render(paper, sheet);
    Rng rng(21);
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector3d point = sheet.at(rng.uniform(0.006, 0.29), rng.uniform(0.006, 0.203));
      const Eigen::Vector2d pixel = project(testing::pinhole(testing::make_camera()), point);
      // Blank paper is between its darkest and its brightest; a hole would mix in black.
      ASSERT_GT(at(image, pixel), 200.0 * 0.45);
    }
  }
}

TEST(SheetPicture, HidesWhatLiesBehind) {
  // Rolled by more than half a turn away from the camera: the ends are behind the middle.
  const scene::Picture striped = make_print(kColumns, kRows, [](int u, int) {
    return std::abs(u - kColumns / 2) < kColumns / 5 ? 60.0 : 240.0;
  });
  const std::vector<float> image = render(striped, testing::make_cylinder(kSheet, 0.06, 0.0));
  EXPECT_LT(at(image, {319.5, 239.5}), 62.0);
  EXPECT_LT(at(image, {300.0, 200.0}), 62.0);
}

TEST(SheetPicture, ShowsTheBlankBackOfASheetThatCurlsTowardsTheCamera) {
  const std::vector<float> image = render(plain(60.0), testing::make_cylinder(kSheet, -0.04, 0.0));
  EXPECT_GT(at(image, {319.5, 239.5}), 90.0);
}

TEST(SheetPicture, AveragesTexelsThatAreSmallerThanARay) {
  const int width = 4800, height = 3392;
  const scene::Picture checks =
      make_print(width, height, [](int u, int v) { return (u + v) % 2 == 0 ? 0.0 : 200.0; });
  const Pitch pitch_m{0.297 / width, 0.297 / width};
  const testing::SheetSpec spec{2, 2, 0.297, 0.20988, width, height};
  const DevelopableSheet sheet = testing::make_bent_sheet(spec, {}, {0.6, 0, 0, 0.1, 0.2, 0.1});
  const std::vector<float> image = render(checks, sheet, pitch_m);
  const std::vector<float> paper = render(plain(100.0, width, height), sheet, pitch_m);
  for (int y = 150; y < 330; ++y) {
    for (int x = 180; x < 460; ++x) {
      const Eigen::Vector2d pixel(x, y);
      ASSERT_NEAR(at(image, pixel), at(paper, pixel), 6.0);
    }
  }
}

TEST(SheetPicture, DrawsNothingWhenTheSheetIsBehindTheCameraOrOutsideTheImage) {
  for (const testing::PoseSpec& pose :
       {testing::PoseSpec{-0.5}, testing::PoseSpec{0.6, 3.0}, testing::PoseSpec{0.6, 0.0, -3.0}}) {
    const auto image = render(plain(200.0), testing::make_bent_sheet(kSheet, {}, pose));
    EXPECT_EQ(*std::max_element(image.begin(), image.end()), 0.0F);
  }
}

TEST(SheetPicture, DrawsASheetThatIsOnlyPartlyInTheImage) {
  const auto sheet = testing::make_bent_sheet(kSheet, {}, {0.3, 0.12, 0.08});
  const auto image = render(plain(200.0), sheet);
  EXPECT_GT(at(image, {639, 479}), 90.0);
  EXPECT_EQ(at(image, {0, 0}), 0.0);
}

TEST(Background, IsSmoothAndTheSameForTheSameSeedOnly) {
  const std::vector<float> desk = greys(draw_background(320, 240, 3));
  EXPECT_EQ(desk, greys(draw_background(320, 240, 3)));
  EXPECT_NE(desk, greys(draw_background(320, 240, 4)));
  float steepest = 0.0F;
  for (std::size_t i = 1; i < desk.size(); ++i) {
    if (i % 320 != 0) steepest = std::max(steepest, std::abs(desk[i] - desk[i - 1]));
  }
  EXPECT_LT(steepest, 25.0F);
  const auto [low, high] = std::minmax_element(desk.begin(), desk.end());
  EXPECT_GT(*high - *low, 60.0F);
}

}  // namespace
}  // namespace weft::synthetic
