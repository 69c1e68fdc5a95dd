// SPDX-License-Identifier: Apache-2.0
// How the matches of photographs are distributed over the charts of the texture.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>

#include "pipeline/survey/template_faults.hpp"

namespace weft {
namespace {

/// The chart of each face, counted from 0: parts of the mesh that are connected by vertex index.
std::vector<std::int32_t> charts_of(const Faces& faces, Eigen::Index vertices) {
  std::vector<std::int32_t> parent(to_index(vertices));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root_of = [&](std::int32_t v) {
    while (parent[to_index(v)] != v)
      v = parent[to_index(v)] = parent[to_index(parent[to_index(v)])];
    return v;
  };
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 1; k < 3; ++k) parent[to_index(root_of(faces(f, k)))] = root_of(faces(f, 0));
  }
  std::vector<std::int32_t> number(parent.size(), -1), charts;
  std::int32_t count = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    std::int32_t& chart = number[to_index(root_of(faces(f, 0)))];
    if (chart < 0) chart = count++;
    charts.push_back(chart);
  }
  return charts;
}

/// An image of few cells that keeps the nearest face in each, so that hidden faces do not count.
class FaceImage {
 public:
  FaceImage(const Camera& camera, const Points3& points_m) : camera_(camera), points_m_(points_m) {
    constexpr double kLongerSide = 256.0;
    cell_px_ = static_cast<double>(std::max(camera.width_px, camera.height_px)) / kLongerSide;
    columns_ = static_cast<int>(std::ceil(static_cast<double>(camera.width_px) / cell_px_));
    rows_ = static_cast<int>(std::ceil(static_cast<double>(camera.height_px) / cell_px_));
    nearest_.assign(to_index(columns_ * rows_), {std::numeric_limits<double>::infinity(), -1});
  }

  void draw(std::int32_t face, const Eigen::RowVector3i& corners) {
    std::array<Eigen::Vector2d, 3> at;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d point_m = points_m_.row(corners(k));
      if (!(point_m.z() > 0.0)) return;
      at[to_index(k)] = Eigen::Vector2d(camera_.fx * point_m.x() / point_m.z() + camera_.cx,
                                        camera_.fy * point_m.y() / point_m.z() + camera_.cy) /
                        cell_px_;
    }
    const double twice_area = cross(at[1] - at[0], at[2] - at[0]);
    if (!(std::abs(twice_area) > 0.0)) return;
    const auto range = [&](int axis, int length, int& first, int& last) {
      const auto [low, high] = std::minmax({at[0][axis], at[1][axis], at[2][axis]});
      first = static_cast<int>(std::clamp(std::floor(low), 0.0, static_cast<double>(length)));
      last = static_cast<int>(std::clamp(std::ceil(high), 0.0, static_cast<double>(length)));
    };
    int left = 0, right = 0, top = 0, bottom = 0;
    range(0, columns_, left, right);
    range(1, rows_, top, bottom);
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        const Eigen::Vector2d cell(x + 0.5, y + 0.5);
        const double w0 = cross(at[1] - cell, at[2] - cell) / twice_area;
        const double w1 = cross(at[2] - cell, at[0] - cell) / twice_area;
        if (w0 < 0.0 || w1 < 0.0 || w0 + w1 > 1.0) continue;
        const double depth_m = w0 * points_m_(corners(0), 2) + w1 * points_m_(corners(1), 2) +
                               (1.0 - w0 - w1) * points_m_(corners(2), 2);
        Nearest& nearest = nearest_[to_index(y * columns_ + x)];
        // Front faces are counter-clockwise in the image; v points down.
        if (depth_m < nearest.depth_m) nearest = {depth_m, twice_area < 0.0 ? face : -1};
      }
    }
  }

  /// Calls add(face) for each cell that shows the front of a face.
  template <class Add>
  void for_each(Add&& add) const {
    for (const Nearest& nearest : nearest_) {
      if (nearest.face >= 0) add(nearest.face);
    }
  }

 private:
  struct Nearest {
    double depth_m;
    std::int32_t face;  ///< -1 for none and for the back of a face
  };

  static double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  }

  const Camera& camera_;
  const Points3& points_m_;
  double cell_px_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<Nearest> nearest_;
};

}  // namespace

std::optional<ChartMatches> chart_matches(const Template& templ, const Camera& camera,
                                          const std::vector<Correspondences>& photographs) {
  constexpr double kFewestExpected = 8.0, kLeastShare = 0.1;
  const Faces faces = templ.faces.matrix<3>();
  const std::vector<std::int32_t> charts = charts_of(faces, templ.vertices_m.rows());
  if (charts.empty()) return std::nullopt;
  const auto count = to_index(*std::max_element(charts.begin(), charts.end()) + 1);
  const auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), faces);
  if (count < 2 || !locator) return std::nullopt;
  std::vector<double> cells(count, 0.0), matches(count, 0.0);
  for (const Correspondences& photograph : photographs) {
    const auto pose = pose_at_rest(templ, camera, photograph);
    if (!pose) continue;
    const Points3 points_m =
        transform_points(pose->camera_from_template, templ.vertices_m.matrix<3>());
    FaceImage image(camera, points_m);
    for (std::int32_t f = 0; f < faces.rows(); ++f) image.draw(f, faces.row(f));
    image.for_each([&](std::int32_t face) { ++cells[to_index(charts[to_index(face)])]; });
    for (std::int64_t i = 0; i < photograph.count(); ++i) {
      if (photograph.kept(i) == 0) continue;
      const FaceLocation on =
          locator->locate({photograph.template_px(i, 0), photograph.template_px(i, 1)});
      if (on.face >= 0) ++matches[to_index(charts[to_index(on.face)])];
    }
  }
  const double all_cells = std::accumulate(cells.begin(), cells.end(), 0.0);
  const double all_matches = std::accumulate(matches.begin(), matches.end(), 0.0);
  if (all_cells == 0.0) return std::nullopt;
  ChartMatches found;
  for (std::size_t c = 0; c < count; ++c) {
    const double expected = all_matches * cells[c] / all_cells;
    if (expected < kFewestExpected) continue;
    ++found.judged;
    if (matches[c] >= kLeastShare * expected) continue;
    ++found.unmatched;
    found.unmatched_share += cells[c] / all_cells;
  }
  return found;
}

}  // namespace weft
