// SPDX-License-Identifier: Apache-2.0
#include "point_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/suggest.hpp>

namespace weft::known_points {
namespace {

constexpr std::array<const char*, kFields> kNames{
    "time_s", "frame", "vertex", "template_x_mm", "template_y_mm",
    "X_mm",   "Y_mm",  "Z_mm",   "radius_mm",     "sigma_mm"};
constexpr double kMetresPerMillimetre = 1e-3;
constexpr double kRadiusOverSigma =
    2.795;  // 95 % of the chi distribution with 3 degrees of freedom

std::size_t at(Field field) { return to_index(field); }

std::optional<RowMistake> check_whole(const Numbers& numbers, Field field) {
  const auto& number = numbers[at(field)];
  const double most = std::numeric_limits<std::int32_t>::max();
  if (!number || (*number == std::floor(*number) && *number >= 0.0 && *number <= most)) return {};
  return RowMistake{std::string("'") + name_of(field) + "' must be a whole number from 0", field};
}

}  // namespace

const char* name_of(Field field) { return kNames[at(field)]; }

std::optional<Field> field_named(const std::string& name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Field>(found - kNames.begin());
}

std::string unknown_field(const std::string& name) {
  return "'" + name + "' is unknown" +
         did_you_mean(name, {kNames.begin(), kNames.end()}, ": remove or rename it");
}

std::optional<RowMistake> check_fields(const std::vector<Field>& fields) {
  const auto has = [&](Field field) {
    return std::find(fields.begin(), fields.end(), field) != fields.end();
  };
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto end = fields.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(fields.begin(), end, fields[i]) == end) continue;
    return RowMistake{std::string("'") + name_of(fields[i]) + "' is given twice", fields[i]};
  }
  if (has(Field::time_s) == has(Field::frame))
    return RowMistake{"needs one of 'time_s' and 'frame'"};
  const bool by_template = has(Field::template_x_mm) || has(Field::template_y_mm);
  if (has(Field::vertex) == by_template || has(Field::template_x_mm) != has(Field::template_y_mm)) {
    return RowMistake{"needs either 'vertex' or both 'template_x_mm' and 'template_y_mm'"};
  }
  for (const Field field : {Field::x_mm, Field::y_mm, Field::z_mm}) {
    if (!has(field)) return RowMistake{std::string("needs '") + name_of(field) + "'"};
  }
  if (has(Field::radius_mm) && has(Field::sigma_mm)) {
    return RowMistake{"has both 'radius_mm' and 'sigma_mm': leave one out", Field::sigma_mm};
  }
  return {};
}

std::optional<RowMistake> read_row(const Numbers& numbers, PointRow& row) {
  for (const Field field : {Field::frame, Field::vertex}) {
    if (auto mistake = check_whole(numbers, field)) return mistake;
  }
  for (const Field field : {Field::radius_mm, Field::sigma_mm}) {
    if (numbers[at(field)].value_or(0.0) >= 0.0) continue;
    return RowMistake{std::string("'") + name_of(field) + "' must not be negative", field};
  }
  const auto metres = [&](Field field) {
    return kMetresPerMillimetre * numbers[at(field)].value_or(0.0);
  };
  row = {};
  row.by_frame = numbers[at(Field::frame)].has_value();
  row.moment = row.by_frame ? *numbers[at(Field::frame)] : *numbers[at(Field::time_s)];
  row.vertex = static_cast<std::int32_t>(numbers[at(Field::vertex)].value_or(-1.0));
  row.template_xy_m = {metres(Field::template_x_mm), metres(Field::template_y_mm)};
  row.point_m = {metres(Field::x_mm), metres(Field::y_mm), metres(Field::z_mm)};
  if (numbers[at(Field::radius_mm)]) row.radius_m = metres(Field::radius_mm);
  if (numbers[at(Field::sigma_mm)]) row.radius_m = kRadiusOverSigma * metres(Field::sigma_mm);
  return {};
}

}  // namespace weft::known_points
