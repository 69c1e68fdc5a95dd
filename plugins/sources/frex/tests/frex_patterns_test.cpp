// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

#include "small_film.hpp"

namespace weft::testing {
namespace {

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

/// True if a triangle that does not touch the vertex is between it and the camera. The test uses
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

/// True for each vertex with a triangle that shows the camera its textured side, as
/// rectangular_grid_faces() orders them.
std::vector<bool> show_their_print(const GroundTruth& truth) {
  std::vector<bool> shown(to_index(truth.count()));
  for (Eigen::Index f = 0; f < truth.faces.rows(); ++f) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) {
      corners.col(k) = truth.points_m.matrix<3>().row(truth.faces(f, k)).transpose();
    }
    if (corners.determinant() >= 0.0) continue;
    for (int k = 0; k < 3; ++k) shown[to_index(truth.faces(f, k))] = true;
  }
  return shown;
}

struct Agreement {
  int visible = 0, wrongly_visible = 0, wrongly_hidden = 0;
  int compared = 0;  ///< number of visible vertices, by the map around them
  double worst_px = 0.0;
};

/// Visibility against a search through all triangles, and the map around the images of the visible
/// vertices against the vertices. Where the four pixels about a vertex see another part of the
/// surface, or nothing, the map cannot be read between them.
Agreement compare_vertices(const GroundTruth& truth, const Pinhole& camera) {
  constexpr double kFlat_m = 0.003;  // depths that four pixels of one part have at most
  Agreement result;
  const std::vector<bool> shown = show_their_print(truth);
  for (std::int32_t v = 0; v < truth.count(); ++v) {
    const bool is_seen = shown[to_index(v)] && !is_hidden(truth, v);
    if (truth.visible(v) == 0) result.wrongly_hidden += is_seen ? 1 : 0;
    if (truth.visible(v) == 0) continue;
    ++result.visible;
    result.wrongly_visible += is_seen ? 0 : 1;
    const Eigen::Vector3d point = truth.points_m.matrix<3>().row(v).transpose();
    const Eigen::Vector2d pixel = project(camera, point);
    const auto x = static_cast<std::int64_t>(std::floor(pixel.x()));
    const auto y = static_cast<std::int64_t>(std::floor(pixel.y()));
    const Eigen::Vector2d share = pixel.array() - pixel.array().floor();
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
  SmallFilm source("period_s: 1.6, seed: 3, pattern: " + std::string(GetParam()));
  for (const std::uint64_t frame : {12, 24}) {
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
  SmallFilm source("period_s: 1.6, seed: 4, dense_truth: false, pattern: " +
                   std::string(GetParam()));
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
                                           "bulge", "folds"),
                         [](const auto& pattern) { return std::string(pattern.param); });

}  // namespace
}  // namespace weft::testing
