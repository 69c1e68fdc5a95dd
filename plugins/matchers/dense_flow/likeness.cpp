// SPDX-License-Identifier: Apache-2.0
#include "likeness.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::dense_flow {
namespace {

constexpr double kCellsAlongDiagonal = 48.0;
constexpr double kAlikeContrast = 0.5;
constexpr double kLeastContrast = 10.0;  // grey levels
constexpr double kSamplesAlongCell = 12.0;
constexpr double kFewestSamples = 16.0;
// Where the contrast of the image is below this share of the usual one, an object covers the
// texture.
constexpr double kCovered = 0.3, kWeightOfCovered = 0.2;

}  // namespace

bool Likeness::Cell::has_contrast() const {
  return count >= kFewestSamples && drawn2() >= kLeastContrast * kLeastContrast * count;
}

void Likeness::Cell::add(double drawn, double seen) {
  count += 1.0;
  sum_drawn += drawn;
  sum_seen += seen;
  sum_drawn2 += drawn * drawn;
  sum_seen2 += seen * seen;
  sum_both += drawn * seen;
}

double Likeness::unlike_share(const view::ViewLevel& view, int k, const view::Picture& image,
                              const Eigen::Vector2d& shift_px, const Points2& flat_px,
                              const TexelMap& texel_map) {
  const Eigen::RowVector2d low_px = flat_px.colwise().minCoeff();
  const Eigen::RowVector2d size_px = flat_px.colwise().maxCoeff() - low_px;
  const double side_px = std::max(size_px.norm() / kCellsAlongDiagonal, 1e-9);
  const int columns = static_cast<int>(size_px.x() / side_px) + 1;
  const int rows = static_cast<int>(size_px.y() / side_px) + 1;
  cells_.assign(to_index(columns * rows), {});
  const double cell_px = std::hypot(view.grey.width, view.grey.height) / kCellsAlongDiagonal;
  const int step_px = std::max(1, static_cast<int>(cell_px / kSamplesAlongCell));
  const auto shift_x = static_cast<int>(std::lround(shift_px.x()));
  const auto shift_y = static_cast<int>(std::lround(shift_px.y()));
  for (int y = 0; y < view.grey.height; y += step_px) {
    worked(20 * view.grey.width / step_px);
    const int seen_y = y + view.y0 + shift_y;
    if (seen_y < 0 || seen_y >= image.height) continue;
    // Along a row the cell is a fraction of linear functions, for each face.
    const std::int32_t* faces = view.face.data() + to_index(y) * to_index(view.grey.width);
    const double scale = 1 << k, image_y = scale * (y + view.y0 + 0.5) - 0.5;
    Eigen::Vector3d at_left = Eigen::Vector3d::Zero(), along_row = at_left;
    std::int32_t face = -1;
    for (int x = 0; x < view.grey.width; x += step_px) {
      const int seen_x = x + view.x0 + shift_x;
      if (seen_x < 0 || seen_x >= image.width || faces[x] < 0) continue;
      if (faces[x] != face) {
        face = faces[x];
        Eigen::Matrix3d map = texel_map(face);
        map.topRows<2>() = (map.topRows<2>() - low_px.transpose() * map.row(2)) / side_px;
        at_left = map * Eigen::Vector3d(scale * (view.x0 + 0.5) - 0.5, image_y, 1.0);
        along_row = scale * map.col(0);
      }
      const double inverse = 1.0 / (at_left.z() + x * along_row.z());
      const int column = static_cast<int>(inverse * (at_left.x() + x * along_row.x()));
      const int row = static_cast<int>(inverse * (at_left.y() + x * along_row.y()));
      cells_[to_index(std::clamp(row, 0, rows - 1) * columns + std::clamp(column, 0, columns - 1))]
          .add(static_cast<double>(view.grey.row(y)[x]),
               static_cast<double>(image.row(seen_y)[seen_x]));
    }
  }
  contrasts_.clear();
  for (const Cell& cell : cells_) {
    if (cell.has_contrast()) contrasts_.push_back(std::sqrt(cell.seen2() / cell.drawn2()));
  }
  if (contrasts_.empty()) return 0.0;
  const double usual = median_in_place(contrasts_);
  double all = 0.0, unlike = 0.0;
  for (const Cell& cell : cells_) {
    if (!cell.has_contrast()) continue;
    const double drawn2 = cell.drawn2(), seen2 = cell.seen2();
    all += drawn2;
    if (seen2 > 0.0 && cell.both() >= kAlikeContrast * std::sqrt(drawn2 * seen2)) continue;
    const bool is_covered = seen2 < kCovered * kCovered * usual * usual * drawn2;
    unlike += is_covered ? kWeightOfCovered * drawn2 : drawn2;
  }
  return unlike / all;
}

}  // namespace weft::dense_flow
