// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::testing {
namespace {

constexpr int kOpen = 0, kCount = 1, kRead = 2;
constexpr int kColumns = 40, kRows = 28;

/// Small and quick, unless the test asks for more; the print is 842 x 595 px.
std::string params(const std::string& more) {
  return std::string("{texture: ") + WEFT_TEXTURES +
         "sheet_texture.png, columns: " + std::to_string(kColumns) +
         ", rows: " + std::to_string(kRows) +
         ", image_width_px: 320, image_height_px: 240, "
         "focal_px: 400" +
         (more.empty() ? "" : ", ") + more + "}";
}

/// The source, opened, with one frame's outputs at a time.
class Opened {
 public:
  explicit Opened(const std::string& more = "", std::uint64_t run_seed = 1)
      : plugin_("sources/frex", params(more), run_seed) {
    const Outcome opened = plugin_.process(kOpen, {});
    if (opened.status != WEFT_OK) throw std::runtime_error(opened.message);
    camera = *opened.get<Camera>();
  }

  Outcome read(std::uint64_t frame) {
    Outcome outcome = plugin_.process(kRead, {}, frame);
    if (outcome.status != WEFT_OK) throw std::runtime_error(outcome.message);
    return outcome;
  }
  std::vector<std::uint8_t> pixels(std::uint64_t frame) {
    const Array<std::uint8_t> array = read(frame).get<Image>()->pixels;
    return {array.data(), array.data() + array.size()};
  }
  GroundTruth truth(std::uint64_t frame) { return *read(frame).get<GroundTruth>(); }
  Pinhole pinhole() const { return {camera.fx, camera.fy, camera.cx, camera.cy}; }

  Camera camera;

 private:
  PluginUnderTest plugin_;
};

/// Largest |l / l0 - 1| over the edges of the true mesh, l0 measured on the template.
double worst_strain(const GroundTruth& truth) {
  Points3 flat = Points3::Zero(truth.count(), 3);
  flat.leftCols<2>() = truth.template_xy_m.matrix<2>();
  const auto topology = build_topology(truth.faces.matrix<3>(), truth.count());
  return strain_statistics(*distance_constraints(topology->edges, flat), truth.points_m.matrix<3>())
      .max;
}

/// The template point that the map has at a pixel.
Eigen::Vector2d template_point(const GroundTruth& truth, std::int64_t x, std::int64_t y) {
  return {truth.uv_m.row(y)[2 * x], truth.uv_m.row(y)[2 * x + 1]};
}

/// The point of the mesh at a template point; vertices are kColumns to a row.
Eigen::Vector3d on_the_mesh(const GroundTruth& truth, const Eigen::Vector2d& template_m) {
  const auto flat = truth.template_xy_m.matrix<2>();
  const Eigen::Vector2d first = flat.row(0).transpose();
  const Eigen::Vector2d cell_m(flat(1, 0) - flat(0, 0), flat(kColumns, 1) - flat(0, 1));
  const Eigen::Array2d place = (template_m - first).array() / cell_m.array();
  const auto i = static_cast<Eigen::Index>(std::clamp(place.x(), 0.0, kColumns - 1.001));
  const auto j = static_cast<Eigen::Index>(std::clamp(place.y(), 0.0, kRows - 1.001));
  const Eigen::Index cell = 2 * (j * (kColumns - 1) + i);
  Eigen::Vector3d nearest = Eigen::Vector3d::Constant(NAN);
  double inside = -1e9;
  for (Eigen::Index f = cell; f < cell + 2; ++f) {
    Eigen::Matrix3d corners, places;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = truth.faces(f, k);
      corners.col(k) << flat(v, 0), flat(v, 1), 1.0;
      places.col(k) = truth.points_m.matrix<3>().row(v).transpose();
    }
    const Eigen::Vector3d weights = corners.inverse() * template_m.homogeneous();
    if (weights.minCoeff() <= inside) continue;
    inside = weights.minCoeff();
    nearest = places * weights;
  }
  return nearest;
}

/// Largest distance, in px, of a pixel from the image of the mesh at its template point, and, in m,
/// of their depths.
struct MapErrors {
  double px = 0.0, depth_m = 0.0;
  int pixels = 0;
};

MapErrors compare_pixels(const GroundTruth& truth, const Pinhole& camera) {
  MapErrors worst;
  for (std::int64_t y = 0; y < truth.uv_m.rows(); ++y) {
    for (std::int64_t x = 0; x < truth.uv_m.dim(1); ++x) {
      const Eigen::Vector2d there = template_point(truth, x, y);
      if (there.hasNaN()) continue;
      const Eigen::Vector3d point = on_the_mesh(truth, there);
      const Eigen::Vector2d off =
          project(camera, point) - Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y));
      worst.px = std::max(worst.px, off.norm());
      worst.depth_m = std::max(worst.depth_m, std::abs(truth.depth_m(y, x) - point.z()));
      ++worst.pixels;
    }
  }
  return worst;
}

/// Whether a triangle that does not touch the vertex stands between it and the camera, by
/// the signed volumes of the ray and the sides of each triangle in turn.
bool is_hidden(const GroundTruth& truth, std::int32_t vertex) {
  const auto points = truth.points_m.matrix<3>();
  const Eigen::Vector3d ray = points.row(vertex).transpose();
  for (Eigen::Index f = 0; f < truth.faces.rows(); ++f) {
    Eigen::Matrix3d corners;
    bool touches = false;
    for (int k = 0; k < 3; ++k) {
      touches = touches || truth.faces(f, k) == vertex;
      corners.col(k) = points.row(truth.faces(f, k)).transpose();
    }
    if (touches) continue;
    const Eigen::Vector3d a = corners.col(0), b = corners.col(1), c = corners.col(2);
    const double ab = a.cross(b).dot(ray), bc = b.cross(c).dot(ray), ca = c.cross(a).dot(ray);
    const bool inside = (ab > 0.0 && bc > 0.0 && ca > 0.0) || (ab < 0.0 && bc < 0.0 && ca < 0.0);
    if (inside && corners.determinant() / (ab + bc + ca) < 1.0 - 1e-9) return true;
  }
  return false;
}

/// Whether a triangle at the vertex shows the camera its printed side, as rectangular_grid_faces()
/// orders them.
std::vector<bool> show_their_print(const GroundTruth& truth) {
  std::vector<bool> shown(static_cast<std::size_t>(truth.count()));
  for (Eigen::Index f = 0; f < truth.faces.rows(); ++f) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) {
      corners.col(k) = truth.points_m.matrix<3>().row(truth.faces(f, k)).transpose();
    }
    if (corners.determinant() >= 0.0) continue;
    for (int k = 0; k < 3; ++k) shown[static_cast<std::size_t>(truth.faces(f, k))] = true;
  }
  return shown;
}

struct Agreement {
  int visible = 0, wrongly_visible = 0, wrongly_hidden = 0;
  int compared = 0;  ///< of the visible vertices, by the map around them
  double worst_px = 0.0;
};

/// Visibility against a search through all triangles, and the map around the images of the visible
/// vertices against the vertices. Where the four pixels about a vertex see another part of the
/// sheet, or nothing, the map cannot be read between them.
Agreement compare_vertices(const GroundTruth& truth, const Pinhole& camera) {
  constexpr double kFlat_m = 0.003;  // depths that four pixels of one part have at most
  Agreement result;
  const std::vector<bool> shown = show_their_print(truth);
  for (std::int32_t v = 0; v < truth.count(); ++v) {
    const bool is_seen = shown[static_cast<std::size_t>(v)] && !is_hidden(truth, v);
    if (truth.visible(v) == 0) result.wrongly_hidden += is_seen ? 1 : 0;
    if (truth.visible(v) == 0) continue;
    ++result.visible;
    result.wrongly_visible += is_seen ? 0 : 1;
    const Eigen::Vector3d point = truth.points_m.matrix<3>().row(v).transpose();
    const Eigen::Vector2d pixel = project(camera, point);
    const auto x = static_cast<std::int64_t>(std::floor(pixel.x()));
    const auto y = static_cast<std::int64_t>(std::floor(pixel.y()));
    const Eigen::Vector2d share = pixel - Eigen::Vector2d(x, y);
    Eigen::Vector2d read = Eigen::Vector2d::Zero();
    double nearest_m = 1e9, farthest_m = 0.0;
    for (int k = 0; k < 4; ++k) {
      const int i = k % 2, j = k / 2;
      const double weight =
          (i == 1 ? share.x() : 1.0 - share.x()) * (j == 1 ? share.y() : 1.0 - share.y());
      read += weight * template_point(truth, x + i, y + j);
      nearest_m = std::min<double>(nearest_m, truth.depth_m(y + j, x + i));
      farthest_m = std::max<double>(farthest_m, truth.depth_m(y + j, x + i));
    }
    if (read.hasNaN() || farthest_m - nearest_m > kFlat_m) continue;
    ++result.compared;
    const double error_px = (project(camera, on_the_mesh(truth, read)) - pixel).norm();
    result.worst_px = std::max(result.worst_px, error_px);
  }
  return result;
}

class FrexPatterns : public ::testing::TestWithParam<const char*> {};

TEST_P(FrexPatterns, HaveMapsThatAgreeWithTheirVertices) {
  Opened source("period_s: 1.6, seed: 3, pattern: " + std::string(GetParam()));
  for (const std::uint64_t frame : {0, 12, 24}) {
    SCOPED_TRACE("frame " + std::to_string(frame));
    const GroundTruth truth = source.truth(frame);
    const MapErrors maps = compare_pixels(truth, source.pinhole());
    EXPECT_GT(maps.pixels, 9000);
    EXPECT_LT(maps.px, 0.01);
    EXPECT_LT(maps.depth_m, 1e-4);
    const Agreement vertices = compare_vertices(truth, source.pinhole());
    EXPECT_GT(vertices.visible, 300);
    EXPECT_LE(vertices.wrongly_visible, 0.005 * vertices.visible);
    EXPECT_LE(vertices.wrongly_hidden, 0.005 * vertices.visible);
    EXPECT_GT(vertices.compared, 0.7 * vertices.visible);
    EXPECT_LT(vertices.worst_px, 0.5);
  }
}

TEST_P(FrexPatterns, KeepTheirLengthsUnlessTheyAreElastic) {
  const bool is_elastic = std::string(GetParam()) == "bulge";
  Opened source("period_s: 1.6, seed: 4, dense_truth: false, pattern: " + std::string(GetParam()));
  double bent_m = 0.0;
  for (std::uint64_t frame = 0; frame < 40; frame += 4) {
    const GroundTruth truth = source.truth(frame);
    if (!is_elastic) {
      EXPECT_LT(worst_strain(truth), 0.002) << "frame " << frame;
    }
    EXPECT_LT(truth.diag.value("edge_strain", 1.0), 0.002) << "frame " << frame;
    EXPECT_NEAR(truth.diag.value("stretch_max", -1.0), worst_strain(truth), 1e-12);
    const auto points = truth.points_m.matrix<3>();
    const Points3 centred = points.rowwise() - points.colwise().mean();
    const double thickness = Eigen::JacobiSVD<Points3>(centred).singularValues().minCoeff() /
                             std::sqrt(static_cast<double>(points.rows()));
    bent_m = std::max(bent_m, thickness);
  }
  EXPECT_GT(bent_m, 0.003) << "the sheet stays flat";
}

INSTANTIATE_TEST_SUITE_P(All, FrexPatterns,
                         ::testing::Values("roll", "s_bend", "corner_fold", "wave", "handles",
                                           "bulge"),
                         [](const auto& pattern) { return std::string(pattern.param); });

TEST(Frex, SaysHowFarItIsStretched) {
  Opened source("stretch: 0.15, pattern: roll, period_s: 1.6, dense_truth: false");
  double most = 0.0;
  for (std::uint64_t frame = 0; frame <= 30; frame += 6) {
    const GroundTruth truth = source.truth(frame);
    EXPECT_NEAR(truth.diag.value("stretch_max", 0.0), worst_strain(truth), 1e-12);
    EXPECT_LT(truth.diag.value("edge_strain", 1.0), 0.002);
    most = std::max(most, worst_strain(truth));
  }
  EXPECT_NEAR(most, 0.15, 0.01);
}

TEST(Frex, IsFlatBeforeTheCameraAtFirst) {
  Opened source("pattern: handles");
  const GroundTruth truth = source.truth(0);
  EXPECT_EQ(truth.kind, "frex");
  ASSERT_EQ(truth.count(), 40 * 28);
  EXPECT_EQ(truth.faces.rows(), 2 * 39 * 27);
  const auto points = truth.points_m.matrix<3>();
  EXPECT_NEAR(points.col(2).minCoeff(), 0.6, 1e-12);
  EXPECT_NEAR(points.col(2).maxCoeff(), 0.6, 1e-12);
  EXPECT_NEAR(points.col(0).sum(), 0.0, 1e-9);
  EXPECT_NEAR(truth.template_xy_m(0, 0), -0.5 * 0.297 / 842.0, 1e-15);
  EXPECT_EQ(truth.visible.matrix<1>().cast<int>().sum(), 40 * 28);
}

TEST(Frex, GivesTheSameBytesInAnyOrderWhateverTheSeedOfTheRun) {
  Opened first("occluder: true, background: clutter"),
      second("occluder: true, background: clutter", 2), other("seed: 2");
  const auto early = first.pixels(2), late = first.pixels(9);
  EXPECT_EQ(second.pixels(9), late);
  EXPECT_EQ(second.pixels(2), early);
  EXPECT_EQ(first.pixels(2), early);
  EXPECT_NE(early, late);
  EXPECT_NE(other.pixels(2), early);
  const GroundTruth a = first.truth(9), b = second.truth(9);
  EXPECT_EQ(a.points_m.matrix<3>(), b.points_m.matrix<3>());
  EXPECT_EQ(std::memcmp(a.uv_m.data(), b.uv_m.data(),
                        static_cast<std::size_t>(a.uv_m.size()) * sizeof(float)),
            0);
}

TEST(Frex, ShowsTheBackgroundInGapsAndStillKnowsTheTruth) {
  Opened gap("invisible_frames: [3], noise_grey: 0"), whole("noise_grey: 0");
  EXPECT_NE(gap.pixels(3), whole.pixels(3));
  EXPECT_EQ(gap.pixels(4), whole.pixels(4));
  const GroundTruth hidden = gap.truth(3);
  EXPECT_EQ(hidden.points_m.matrix<3>(), whole.truth(3).points_m.matrix<3>());
  EXPECT_EQ(hidden.visible.matrix<1>().cast<int>().sum(), 0);
  EXPECT_EQ(hidden.depth_m(120, 160), 0.0F);
  EXPECT_TRUE(std::isnan(hidden.uv_m.row(120)[320]));
}

TEST(Frex, MovesSmoothlyButForItsCuts) {
  Opened source("cut_frames: [4], pattern: wave, dense_truth: false");
  Points3 before = source.truth(0).points_m.matrix<3>();
  for (std::uint64_t frame = 1; frame < 8; ++frame) {
    const Points3 now = source.truth(frame).points_m.matrix<3>();
    const double step_m = (now - before).rowwise().norm().maxCoeff();
    if (frame == 4) {
      EXPECT_GT(step_m, 0.02);
    } else {
      EXPECT_LT(step_m, 0.02) << "frame " << frame;
    }
    before = now;
  }
}

TEST(Frex, HidesVerticesBehindTheOccluder) {
  Opened free("pattern: bulge, period_s: 2"), hidden("pattern: bulge, period_s: 2, occluder: true");
  const auto seen = [](const GroundTruth& truth) {
    return truth.visible.matrix<1>().cast<int>().sum();
  };
  int fewest = 40 * 28;
  for (std::uint64_t frame = 0; frame < 30; frame += 6) {
    EXPECT_LE(seen(hidden.truth(frame)), seen(free.truth(frame)));
    fewest = std::min(fewest, seen(hidden.truth(frame)));
  }
  EXPECT_LT(fewest, 0.95 * 40 * 28);
}

TEST(Frex, HasTheNoiseThatIsAsked) {
  Opened clean("noise_grey: 0"), noisy("noise_grey: 3");
  const auto a = clean.pixels(1), b = noisy.pixels(1);
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] < 20 || a[i] > 235) continue;
    const double difference = static_cast<double>(b[i]) - static_cast<double>(a[i]);
    sum += difference;
    squares += difference * difference;
    ++count;
  }
  ASSERT_GT(count, 50000);
  EXPECT_NEAR(std::sqrt(squares / count), std::sqrt(9.0 + 1.0 / 6.0), 0.06);
  EXPECT_NEAR(sum / count, 0.0, 0.06);
}

std::string refusal(const std::string& text) {
  try {
    PluginUnderTest plugin("sources/frex", text);
    const Outcome opened = plugin.process(kOpen, {});
    return opened.status == WEFT_OK ? "" : opened.message;
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(Frex, SaysWhatIsWrongWithItsParameters) {
  const auto expect_named = [](const std::string& text, const char* name) {
    EXPECT_NE(refusal(text).find(name), std::string::npos) << refusal(text);
  };
  expect_named("{texture: /nowhere/sheet.png}", "/nowhere/sheet.png");
  expect_named("{}", "texture");
  expect_named(params("cut_frames: [60]"), "from 0 to 59");
  expect_named(params("invisible_frames: [2.5]"), "whole numbers");
  expect_named(params("background: image"), "background_image");
  expect_named(params(std::string("background_image: ") + WEFT_TEXTURES + "sole_texture.png"),
               "background: image");
  expect_named(params("stretch: 0.3"), "stretch");
  expect_named(params("pattern: rolled"), "rolled");
}

TEST(Frex, RefusesFramesItDoesNotHaveAndToReadBeforeItIsOpen) {
  PluginUnderTest source("sources/frex", params("frames: 3"));
  EXPECT_EQ(source.process(kRead, {}, 0).status, WEFT_ERROR);
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  EXPECT_EQ(source.process(kCount, {}).get<Count>()->frames, 3);
  EXPECT_EQ(source.process(kRead, {}, 2).status, WEFT_OK);
  EXPECT_EQ(source.process(kRead, {}, 3).status, WEFT_ERROR);
}

}  // namespace
}  // namespace weft::testing
