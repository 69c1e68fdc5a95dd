// SPDX-License-Identifier: Apache-2.0
#include "rest_sheet.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <weft/core/index.hpp>
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

/// The vertices of the chart with the largest surface.
std::vector<Eigen::Index> largest_chart(const Faces& faces, const Points3& vertices_m) {
  std::vector<std::int32_t> chart(to_index(vertices_m.rows()));
  std::iota(chart.begin(), chart.end(), 0);
  const auto root = [&](std::int32_t v) {
    while (chart[to_index(v)] != v) v = chart[to_index(v)] = chart[to_index(chart[to_index(v)])];
    return v;
  };
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 1; k < 3; ++k) chart[to_index(root(faces(f, k)))] = root(faces(f, 0));
  }
  std::vector<double> area(chart.size());
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::RowVector3d a = vertices_m.row(faces(f, 0));
    const Eigen::RowVector3d b = vertices_m.row(faces(f, 1)), c = vertices_m.row(faces(f, 2));
    area[to_index(root(faces(f, 0)))] += (b - a).cross(c - a).norm();
  }
  const auto largest =
      static_cast<std::int32_t>(std::max_element(area.begin(), area.end()) - area.begin());
  std::vector<Eigen::Index> vertices;
  for (std::int32_t v = 0; v < vertices_m.rows(); ++v) {
    if (root(v) == largest) vertices.push_back(v);
  }
  return vertices;
}

/// The rigid transform of the template frame that lays the texture's side before the camera.
Result<RigidAlignment> towards_camera(const RestSheet& sheet, const Points3& vertices_m) {
  Points3 flat_m = Points3::Zero(sheet.uv_px.rows(), 3);
  flat_m.leftCols<2>() = sheet.flat_m();
  if (sheet.first.empty()) return align_points(vertices_m, flat_m);
  // Charts lie anywhere in the texture, so that only one of them can determine the direction.
  const std::vector<Eigen::Index> chart = largest_chart(sheet.faces, vertices_m);
  const Points3 there_m = vertices_m(chart, Eigen::all), here_m = flat_m(chart, Eigen::all);
  return align_points(there_m, here_m);
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

RestSheet RestSheet::welded(const Welding& welding) const {
  RestSheet sheet;
  const auto count = static_cast<Eigen::Index>(welding.kept.size());
  sheet.uv_px.resize(count, 2);
  sheet.rest_m.resize(count, 3);
  for (Eigen::Index p = 0; p < count; ++p) {
    const std::int32_t v = welding.kept[to_index(p)];
    sheet.uv_px.row(p) = uv_px.row(v);
    sheet.rest_m.row(p) = rest_m.row(v);
    sheet.in_hand.push_back(in_hand[to_index(v)]);
  }
  sheet.pitch_m = pitch_m;
  sheet.faces = welding.faces;
  sheet.is_unrolled = false;
  return sheet;
}

Result<void> check_pitch(const Template& object) {
  if (object.m_per_px.present()) return {};
  return Error{Errc::invalid_data,
               "the object has no m_per_px, so its truth has no place on the template: use "
               "templates/rectangular, outline or mesh"};
}

Result<RestSheet> sheet_of(const Template& templ) {
  if (auto legal = check_pitch(templ); !legal) return legal.error();
  auto first = first_at_place(templ);
  if (!first) return first.error();
  RestSheet sheet;
  sheet.uv_px = templ.flat_px.matrix<2>();
  sheet.pitch_m = templ.m_per_px.matrix<1>().transpose();
  sheet.faces = templ.faces.matrix<3>();
  const Points3 vertices_m = templ.vertices_m.matrix<3>();
  sheet.is_unrolled = !Welding(*first, sheet.faces).has_seams();
  if (!sheet.is_unrolled) sheet.first = *std::move(first);
  auto facing = towards_camera(sheet, vertices_m);
  if (!facing) return facing.error();
  sheet.rest_m = transform_points(*facing, vertices_m);
  sheet.in_hand = hands_on(sheet.rest_m);
  return sheet;
}

}  // namespace weft::frex
