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

double Likeness::unlike_share(const view::ViewLevel& view, const view::Picture& image,
                              const Eigen::Vector2d& shift_px, const Points2& flat_px,
                              const TexelAt& texel_at) {
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
    for (int x = 0; x < view.grey.width; x += step_px) {
      const int seen_x = x + view.x0 + shift_x;
      if (seen_x < 0 || seen_x >= image.width) continue;
      if (view.face[to_index(y) * to_index(view.grey.width) + to_index(x)] < 0) continue;
      const Eigen::RowVector2d at = (texel_at(x + view.x0, y + view.y0) - low_px) / side_px;
      const int column = std::clamp(static_cast<int>(at.x()), 0, columns - 1);
      const int row = std::clamp(static_cast<int>(at.y()), 0, rows - 1);
      Cell& cell = cells_[to_index(row * columns + column)];
      const auto drawn = static_cast<double>(view.grey.row(y)[x]);
      const auto seen = static_cast<double>(image.row(seen_y)[seen_x]);
      cell.count += 1.0;
      cell.sum_drawn += drawn;
      cell.sum_seen += seen;
      cell.sum_drawn2 += drawn * drawn;
      cell.sum_seen2 += seen * seen;
      cell.sum_both += drawn * seen;
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
