// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::known_points {

/// Where a point of the surface was at a moment.
struct PointRow {
  bool by_frame = false;     ///< [] the moment is the index of a frame, else a time in s
  double moment = 0.0;       ///< [] s, or frames
  std::int32_t vertex = -1;  ///< [] -1 for a point of the template
  Eigen::Vector2d template_xy_m = Eigen::Vector2d::Zero();  ///< [2] m, template frame
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();        ///< [3] m, in the frame of the rows
  double radius_m = -1.0;                                   ///< [] m, below 0 is the solver's own
};

/// The fields of a row, in CSV files and in JSON lines alike.
enum class Field {
  time_s,
  frame,
  vertex,
  template_x_mm,
  template_y_mm,
  x_mm,
  y_mm,
  z_mm,
  radius_mm,
  sigma_mm
};
constexpr std::size_t kFields = 10;

/// The numbers of a row by field.
using Numbers = std::array<std::optional<double>, kFields>;

/// The error, and its field; none where one is missing.
struct RowMistake {
  std::string message;
  std::optional<Field> field = {};
};

/// The name of a field in files.
const char* name_of(Field field);

/// The field of this name, or nothing.
std::optional<Field> field_named(const std::string& name);

/// The message for a name that is no field.
std::string unknown_field(const std::string& name);

/// Checks that these fields make a row. It needs exactly one of time_s and frame; either vertex or
/// both template_x_mm and template_y_mm; X_mm, Y_mm and Z_mm; at most one of radius_mm and
/// sigma_mm.
std::optional<RowMistake> check_fields(const std::vector<Field>& fields);

/// A row of these numbers, whose fields have been checked. A normal error of `sigma_mm` along each
/// axis stays within 2.795 sigma in 95 % of cases: that is its radius.
std::optional<RowMistake> read_row(const Numbers& numbers, PointRow& row);

}  // namespace weft::known_points
