// SPDX-License-Identifier: Apache-2.0
#include "common/scene/sheet_renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/geometry/rectangular_grid.hpp>

namespace weft::scene {
namespace {

constexpr int kMeshColumns = 13, kMeshRows = 9, kPrintWidth = 240, kPrintHeight = 160;
constexpr double kPitch_m = 0.001;
const Camera kCamera{400.0, 400.0, 159.5, 119.5, 320, 240};

template <class Grey>
MipTexture make_print(const Grey& grey) {
  Picture picture{kPrintWidth, kPrintHeight, {}};
  for (int v = 0; v < kPrintHeight; ++v) {
    for (int u = 0; u < kPrintWidth; ++u) {
      picture.pixels.push_back(Colour::Constant(static_cast<float>(grey(u, v))));
    }
  }
  return MipTexture(picture, true);
}

MipTexture plain(double grey) {
  return make_print([&](int, int) { return grey; });
}

Points2 grid_px() {
  Points2 uv(kMeshColumns * kMeshRows, 2);
  for (Eigen::Index v = 0; v < uv.rows(); ++v) {
    uv.row(v) << static_cast<double>(v % kMeshColumns) * kPrintWidth / (kMeshColumns - 1) - 0.5,
        static_cast<double>(v / kMeshColumns) * kPrintHeight / (kMeshRows - 1) - 0.5;
  }
  return uv;
}

/// The places of a surface's points; x and y in m from its middle.
template <class Place>
Points3 sheet(const Place& place) {
  const Points2 uv = grid_px();
  Points3 vertices(uv.rows(), 3);
  for (Eigen::Index v = 0; v < uv.rows(); ++v) {
    const double x = kPitch_m * (uv(v, 0) + 0.5 - 0.5 * kPrintWidth);
    const double y = kPitch_m * (uv(v, 1) + 0.5 - 0.5 * kPrintHeight);
    vertices.row(v) = place(x, y).transpose();
  }
  return vertices;
}

Points3 tilted_sheet() {
  return sheet([](double x, double y) {
    return Eigen::Vector3d(0.01 + 0.9 * x, y, 0.6 + std::sqrt(1.0 - 0.81) * x);
  });
}

SheetRenderer make_renderer(MipTexture print, float background = 0.0F, const Paper& paper = {}) {
  Picture behind{320, 240, {}};
  behind.pixels.resize(320U * 240U, Colour::Constant(background));
  return *SheetRenderer::create(kCamera, std::move(print), grid_px(),
                                *rectangular_grid_faces(kMeshColumns, kMeshRows), std::move(behind),
                                paper);
}

const Light kAllAround{{0.0, 0.0, -1.0}, 1.0};

float grey_at(const View& view, int x, int y) { return view.image.at(x, y)[0]; }

TEST(SheetRenderer, KnowsTheTemplatePointAndDepthOfEachPixel) {
  SheetRenderer renderer = make_renderer(plain(200.0));
  const View view = renderer.render(tilted_sheet(), kAllAround);
  int seen = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const float depth = view.depth_m(y, x);
      if (depth == 0.0F) continue;
      ++seen;
      const double u = view.uv_px.row(y)[2 * x], v = view.uv_px.row(y)[2 * x + 1];
      // Back through the plane of the surface.
      const double sheet_x = kPitch_m * (u + 0.5 - 0.5 * kPrintWidth);
      const double sheet_y = kPitch_m * (v + 0.5 - 0.5 * kPrintHeight);
      const Eigen::Vector3d point(0.01 + 0.9 * sheet_x, sheet_y,
                                  0.6 + std::sqrt(1.0 - 0.81) * sheet_x);
      ASSERT_NEAR(depth, point.z(), 1e-6);
      ASSERT_NEAR(400.0 * point.x() / point.z() + 159.5, x, 1e-3);
      ASSERT_NEAR(400.0 * point.y() / point.z() + 119.5, y, 1e-3);
    }
  }
  EXPECT_GT(seen, 15000);
}

TEST(SheetRenderer, CoversTheAreaOfTheSheet) {
  SheetRenderer renderer = make_renderer(plain(100.0));
  const View view = renderer.render(
      sheet([](double x, double y) { return Eigen::Vector3d(x + 0.0031, y + 0.0017, 0.6); }),
      kAllAround);
  double total = 0.0;
  for (const Colour& pixel : view.image.pixels) total += pixel[0];
  const double area_px = 0.24 * 0.16 * 400.0 * 400.0 / 0.36;
  EXPECT_NEAR(total / 100.0, area_px, 0.004 * area_px);
}

TEST(SheetRenderer, AveragesAPrintThatIsTooFineToSee) {
  SheetRenderer renderer =
      make_renderer(make_print([](int u, int v) { return (u + v) % 2 == 0 ? 220.0 : 20.0; }));
  const View view = renderer.render(
      sheet([](double x, double y) { return Eigen::Vector3d(x, y, 2.4); }), kAllAround);
  for (int y = 110; y < 130; ++y) {
    for (int x = 145; x < 175; ++x) ASSERT_NEAR(grey_at(view, x, y), 120.0F, 3.0F);
  }
}

TEST(SheetRenderer, ShadesByTheAngleToTheLamp) {
  SheetRenderer renderer = make_renderer(plain(100.0));
  const View view = renderer.render(tilted_sheet(), {{0.0, 0.0, -1.0}, 0.2});
  EXPECT_NEAR(grey_at(view, 160, 120), 100.0 * (0.2 + 0.8 * 0.9), 0.1);
}

/// The left half lies flat, the right half is turned over in front of it, its back to the camera.
Points3 folded_sheet() {
  return sheet([](double x, double y) {
    return x <= 0.0 ? Eigen::Vector3d(x, y, 0.6) : Eigen::Vector3d(-x, y, 0.6 - 0.25 * x);
  });
}

TEST(SheetRenderer, ShowsTheBlankBackBeforeWhatItHides) {
  SheetRenderer renderer = make_renderer(plain(50.0));
  const View view = renderer.render(folded_sheet(), kAllAround);
  EXPECT_NEAR(grey_at(view, 130, 120), 208.0F, 0.5F);
  EXPECT_TRUE(std::isnan(view.uv_px.row(120)[2 * 130]));
  EXPECT_GT(view.depth_m(120, 130), 0.5F);
  EXPECT_LT(view.depth_m(120, 130), 0.6F);
  // No part of the textured side is visible: one half is behind, the other turned over.
  const auto seen = std::count(view.is_visible.begin(), view.is_visible.end(), 1);
  EXPECT_LE(seen, 2 * kMeshRows) << "only the crease and the border of the lower half may be seen";
}

TEST(SheetRenderer, ShowsPaperAroundThePrintAndOnTheBack) {
  // The surface reaches 40 px of the texture beyond its left and right borders.
  Points2 uv = grid_px();
  uv.col(0) = (uv.col(0).array() + 0.5) * (kPrintWidth + 80.0) / kPrintWidth - 40.5;
  const Paper white{250.0F, 240.0F};
  const Picture black{320, 240, std::vector<Colour>(320U * 240U, Colour::Zero())};
  auto renderer = *SheetRenderer::create(
      kCamera, plain(50.0), uv, *rectangular_grid_faces(kMeshColumns, kMeshRows), black, white);
  const View view = renderer.render(
      sheet([](double x, double y) { return Eigen::Vector3d(x, y, 0.6); }), kAllAround);
  // 160 px wide in the image, where the texture covers 240 of 320 parts.
  EXPECT_EQ(grey_at(view, 85, 120), 240.0F);
  EXPECT_TRUE(std::isnan(view.uv_px.row(120)[2 * 85]));
  EXPECT_NEAR(view.depth_m(120, 85), 0.6, 1e-6);
  EXPECT_EQ(grey_at(view, 105, 120), 50.0F);
  EXPECT_NEAR(view.uv_px.row(120)[2 * 105], (105.5 - 100.0) * 320.0 / 160.0 - 0.5, 1e-3);
  EXPECT_EQ(grey_at(view, 215, 120), 50.0F);
  EXPECT_EQ(grey_at(view, 225, 120), 240.0F);

  SheetRenderer folded = make_renderer(plain(50.0), 0.0F, white);
  EXPECT_NEAR(grey_at(folded.render(folded_sheet(), kAllAround), 130, 120), 250.0F, 0.5F);
}

TEST(SheetRenderer, TellsWhichShareOfAPixelItCovers) {
  SheetRenderer renderer = make_renderer(plain(100.0), 20.0F);
  const View view = renderer.render(
      sheet([](double x, double y) { return Eigen::Vector3d(x + 0.0031, y + 0.0017, 0.6); }),
      kAllAround);
  double total = 0.0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const float coverage = view.coverage(y, x);
      total += coverage;
      ASSERT_NEAR(grey_at(view, x, y), 100.0F * coverage + 20.0F * (1.0F - coverage), 1e-3F);
    }
  }
  const double area_px = 0.24 * 0.16 * 400.0 * 400.0 / 0.36;
  EXPECT_NEAR(total, area_px, 0.002 * area_px);
  const View nothing = renderer.render_nothing();
  EXPECT_EQ(
      *std::max_element(nothing.coverage.data(), nothing.coverage.data() + nothing.coverage.size()),
      0.0F);
}

TEST(SheetRenderer, MarksVerticesBehindASolidAndOutsideTheImage) {
  SheetRenderer renderer = make_renderer(plain(50.0));
  Solid board{{Points3(3, 3), Faces(1, 3)}, {3, Colour::Constant(10.0F)}};
  board.mesh.vertices_m << -1.0, -1.0, 0.3, 0.0, -1.0, 0.3, 0.0, 9.0, 0.3;
  board.mesh.faces << 0, 2, 1;
  const Points3 vertices =
      sheet([](double x, double y) { return Eigen::Vector3d(x + 0.15, y, 0.6); });
  const View view = renderer.render(vertices, kAllAround, board);
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    const double pixel = 400.0 * vertices(v, 0) / 0.6 + 159.5;
    const bool expected = vertices(v, 0) > 0.0 && pixel < 319.5;
    EXPECT_EQ(view.is_visible[to_index(v)], expected ? 1 : 0) << "vertex " << v;
  }
  EXPECT_FLOAT_EQ(view.depth_m(120, 150), 0.3F);
  EXPECT_NEAR(grey_at(view, 150, 120), 10.0F, 0.1F);
}

TEST(SheetRenderer, LeavesTheBackgroundWhereNothingIs) {
  SheetRenderer renderer = make_renderer(plain(50.0), 77.0F);
  const View beside = renderer.render(
      sheet([](double x, double y) { return Eigen::Vector3d(x + 3.0, y, 0.6); }), kAllAround);
  EXPECT_TRUE(std::all_of(beside.image.pixels.begin(), beside.image.pixels.end(),
                          [](const Colour& pixel) { return pixel[0] == 77.0F; }));
  const View behind = renderer.render(
      sheet([](double x, double y) { return Eigen::Vector3d(x, y, -0.6); }), kAllAround);
  EXPECT_EQ(grey_at(behind, 160, 120), 77.0F);
}

}  // namespace
}  // namespace weft::scene
