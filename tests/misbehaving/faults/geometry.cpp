// SPDX-License-Identifier: Apache-2.0
// Answers that are legal and wrong.
#include <algorithm>
#include <cmath>

#include "faults.hpp"

namespace weft::faults {
namespace {

using Reals = std::vector<double>;

/// The numbers of an output; empty where it was not made.
Reals read(const std::vector<Output>& outputs, std::string_view array) {
  for (const Output& output : outputs) {
    if (output.array != array || output.dtype != WEFT_F64) continue;
    Reals numbers(output.bytes() / sizeof(double));
    std::memcpy(numbers.data(), output.data, output.bytes());
    return numbers;
  }
  return {};
}

void put_back(std::vector<Output>& outputs, std::string_view array, const Reals& numbers) {
  for (Output& output : outputs) {
    if (output.array == array) std::memcpy(output.data, numbers.data(), output.bytes());
  }
}

unsigned char* flags(std::vector<Output>& outputs, std::string_view array) {
  for (Output& output : outputs) {
    if (output.array == array && output.bytes() > 0) return output.data;
  }
  return nullptr;
}

/// Where in the image matches or sightlines are; null where there are none.
const weft_array* places(const Inputs& inputs) {
  for (const char* name : {"image_px", "pixel_px"}) {
    const weft_array* found = find_array(inputs, name);
    if (found != nullptr && rows(*found) > 0) return found;
  }
  return nullptr;
}

bool has_come_before(const weft_array& image_px, std::int64_t match) {
  for (std::int64_t i = 0; i < match; ++i) {
    const bool is_same = value_at(image_px, i, 0) == value_at(image_px, match, 0) &&
                         value_at(image_px, i, 1) == value_at(image_px, match, 1);
    if (is_same) return true;
  }
  return false;
}

void distort_mask(std::vector<Output>& outputs, const weft_array& image_px) {
  unsigned char* kept = flags(outputs, "kept");
  if (kept == nullptr) return;
  const std::int64_t count = rows(image_px);
  if (has("prefers_first_match")) kept[0] = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    const double x = value_at(image_px, i, 0);
    const bool is_in_odd_stripe = std::fmod(std::floor(x / 16.0), 2.0) != 0.0;
    if (has("absolute_position") && is_in_odd_stripe) kept[i] = 0;
    if (has("duplicates_disagree") && has_come_before(image_px, i)) kept[i] = 0;
  }
}

void distort_shape(Reals& vertices, const weft_array* image_px) {
  const std::size_t count = vertices.size() / 3;
  double column_px = 0.0;
  for (std::int64_t i = 0; image_px != nullptr && i < rows(*image_px); ++i) {
    column_px += value_at(*image_px, i, 0) / static_cast<double>(rows(*image_px));
  }
  for (std::size_t i = 0; i < count; ++i) {
    double* vertex = &vertices[3 * i];
    if (has("millimetres")) std::for_each(vertex, vertex + 3, [](double& c) { c *= 1000.0; });
    if (has("mirrored")) vertex[0] *= -1.0;
    if (has("fixed_offset")) vertex[2] += 0.005;
    if (has("absolute_position")) vertex[2] += 1e-5 * column_px;
  }
  if (has("depends_on_match_order") && image_px != nullptr) {
    vertices[0] += 1e-5 * value_at(*image_px, rows(*image_px) - 1, 0);
  }
  if (!has("renumbered_vertices")) return;
  for (std::size_t i = 0; i < count / 2; ++i) {
    std::swap_ranges(&vertices[3 * i], &vertices[3 * i] + 3, &vertices[3 * (count - 1 - i)]);
  }
}

void distort_derivatives(std::vector<Output>& outputs) {
  if (has("wrong_jacobian")) {
    Reals jacobian = read(outputs, "jacobian");
    for (double& slope : jacobian) slope *= 1.01;
    put_back(outputs, "jacobian", jacobian);
  }
  if (!has("wrong_hessian")) return;
  Reals hessian = read(outputs, "hessian");
  for (std::size_t i = 0; i + 2 < hessian.size(); i += 3) std::swap(hessian[i + 1], hessian[i + 2]);
  put_back(outputs, "hessian", hessian);
}

}  // namespace

void distort_geometry(std::vector<Output>& outputs, const Inputs& inputs) {
  const weft_array* image_px = places(inputs);
  if (image_px != nullptr) distort_mask(outputs, *image_px);
  Reals vertices = read(outputs, "vertices_m");
  if (!vertices.empty()) {
    distort_shape(vertices, image_px);
    put_back(outputs, "vertices_m", vertices);
  }
  distort_derivatives(outputs);
  if (has("depends_on_match_order") && image_px != nullptr) {
    for (Output& output : outputs) {  // the parameters of a fitted warp
      if (!output.array.starts_with("model.") || output.dtype != WEFT_F64 || output.bytes() < 8)
        continue;
      auto* numbers = reinterpret_cast<double*>(output.data);
      const double x_px = value_at(*image_px, rows(*image_px) - 1, 0);
      for (std::size_t i = 0; i < output.bytes() / 8; ++i) numbers[i] *= 1.0 + 1e-5 * x_px;
    }
  }
  if (!has("off_by_half_pixel")) return;
  Reals places_px = read(outputs, "xy_px");
  for (std::size_t i = 0; i < places_px.size(); i += 2) places_px[i] += 0.5;
  put_back(outputs, "xy_px", places_px);
}

}  // namespace weft::faults
