// SPDX-License-Identifier: Apache-2.0
#include "sheet_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <weft/geometry/rectangular_grid.hpp>

namespace weft::synthetic {

SheetMesh::SheetMesh(int print_width, int print_height, Pitch pitch_m) : pitch_m_(pitch_m) {
  constexpr int kCellsAlongWidth = 180;
  const double width_m = pitch_m[0] * print_width, height_m = pitch_m[1] * print_height;
  const double cells = std::clamp(kCellsAlongWidth * height_m / width_m, 8.0, 1000.0);
  const int columns = kCellsAlongWidth + 1, rows = static_cast<int>(std::lround(cells)) + 1;
  uv_px_ = rectangular_grid_px(columns, rows, print_width, print_height);
  faces_ = *rectangular_grid_faces(columns, rows);
}

Points3 SheetMesh::vertices_m(const DevelopableSheet& sheet) const {
  Points3 vertices_m(uv_px_.rows(), 3);
  for (Eigen::Index v = 0; v < uv_px_.rows(); ++v) {
    vertices_m.row(v) = sheet.at(pitch_m_[0] * uv_px_(v, 0), pitch_m_[1] * uv_px_(v, 1));
  }
  return vertices_m;
}

scene::Light room_light() { return {Eigen::Vector3d(-0.5, -0.5, -0.7).normalized(), 0.45}; }

}  // namespace weft::synthetic
