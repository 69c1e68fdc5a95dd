// SPDX-License-Identifier: Apache-2.0
#include "rest_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/geometry/rigid_alignment.hpp>

namespace weft::frex {
namespace {

/// Two patches in the middle row of a grid, at the left and the right border.
std::vector<bool> hands_on_grid(int columns, int rows) {
  const int deep = std::max(2, columns / 16), high = std::max(2, rows / 8);
  const int first_row = (rows - high) / 2;
  std::vector<bool> in_hand;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      in_hand.push_back(std::min(i, columns - 1 - i) < deep && j >= first_row &&
                        j < first_row + high);
    }
  }
  return in_hand;
}

/// The same shares of any surface.
std::vector<bool> hands_on(const Points3& rest_m) {
  const Eigen::RowVector3d low = rest_m.colwise().minCoeff(), high = rest_m.colwise().maxCoeff();
  std::vector<bool> in_hand;
  for (Eigen::Index v = 0; v < rest_m.rows(); ++v) {
    const Eigen::RowVector3d place = (rest_m.row(v) - low).cwiseQuotient(high - low);
    in_hand.push_back(std::min(place.x(), 1.0 - place.x()) < 1.0 / 16.0 &&
                      std::abs(place.y() - 0.5) < 1.0 / 16.0);
  }
  return in_hand;
}

}  // namespace

Result<scene::Cloth> RestSheet::cloth(const Points3& start_m) const {
  return columns > 0 ? scene::Cloth::create(columns, rows, start_m)
                     : scene::Cloth::create(start_m, faces);
}

Result<RestSheet> rectangle(const scene::MipTexture& print, double width_m, double height_m,
                            int columns, int rows) {
  auto faces = rectangular_grid_faces(columns, rows);
  if (!faces) return faces.error();
  const double pitch_m = width_m / print.width();
  RestSheet sheet;
  sheet.pitch_m << pitch_m, height_m > 0.0 ? height_m / print.height() : pitch_m;
  sheet.uv_px = rectangular_grid_px(columns, rows, print.width(), print.height());
  sheet.rest_m = Points3::Zero(sheet.uv_px.rows(), 3);
  sheet.rest_m.leftCols<2>() = sheet.flat_m();
  sheet.faces = *std::move(faces);
  sheet.in_hand = hands_on_grid(columns, rows);
  sheet.columns = columns;
  sheet.rows = rows;
  return sheet;
}

Result<RestSheet> sheet_of(const Template& templ) {
  if (!templ.m_per_px.present()) {
    return Error{Errc::invalid_data,
                 "the object has no m_per_px, so its truth has no place on the template: use "
                 "templates/rectangular, outline or mesh"};
  }
  RestSheet sheet;
  sheet.uv_px = templ.flat_px.matrix<2>();
  sheet.pitch_m = templ.m_per_px.matrix<1>().transpose();
  sheet.faces = templ.faces.matrix<3>();
  Points3 flat_m = Points3::Zero(sheet.uv_px.rows(), 3);
  flat_m.leftCols<2>() = sheet.flat_m();
  const Points3 vertices_m = templ.vertices_m.matrix<3>();
  const auto facing = align_points(vertices_m, flat_m);
  if (!facing) return facing.error();
  sheet.rest_m = transform_points(*facing, vertices_m);
  sheet.in_hand = hands_on(sheet.rest_m);
  return sheet;
}

}  // namespace weft::frex
