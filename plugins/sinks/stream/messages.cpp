// SPDX-License-Identifier: Apache-2.0
#include "messages.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>

namespace weft::stream {
namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 56;

bool has_covariance(const FramePoints& points) {
  return points.covariance && points.shape.covariance_m2.present();
}

template <class Number>
void add(std::string& text, Number number) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text.append(digits.data(), end);
}

void add_triple(std::string& text, const double* xyz) {
  text += '[';
  add(text, xyz[0]);
  text += ',';
  add(text, xyz[1]);
  text += ',';
  add(text, xyz[2]);
  text += ']';
}

/// A list of one entry for each row of the array.
template <class AddRow>
void add_rows(std::string& text, const Array<double>& array, AddRow&& add_row) {
  text += '[';
  for (std::int64_t i = 0; i < array.rows(); ++i) {
    if (i > 0) text += ',';
    add_row(array.row(i));
  }
  text += ']';
}

/// The reason why the host gives the shape less confidence than its solver; a shape without one has
/// no key.
void add_reason(std::string& text, const Shape& shape) {
  const auto* reason = shape.others.find<std::uint8_t>("x.weft.reason");
  if (reason == nullptr) return;
  text += ",\"reason\":\"";
  for (std::int64_t i = 0; i < reason->rows(); ++i) {
    const auto each = static_cast<char>((*reason)(i));
    if (each == '"' || each == '\\') text += '\\';
    text += each < ' ' && each >= 0 ? ' ' : each;
  }
  text += '"';
}

template <class Number>
void put(std::string& bytes, Number number) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void put_rows(std::string& bytes, const Array<double>& array) {
  const std::size_t row = static_cast<std::size_t>(array.row_elements()) * sizeof(double);
  for (std::int64_t i = 0; i < array.rows(); ++i) {
    bytes.append(reinterpret_cast<const char*>(array.row(i)), row);
  }
}

}  // namespace

std::string json_line(const FramePoints& points) {
  const Shape& shape = points.shape;
  std::string text = "{\"frame\":";
  add(text, points.frame);
  text += ",\"time_s\":";
  if (std::isnan(points.time_s)) {
    text += "null";
  } else {
    add(text, points.time_s);
  }
  text += ",\"state\":\"" + std::string(to_string(shape.shape_state())) + "\",\"age_frames\":";
  add(text, shape.age_frames);
  text += ",\"confidence\":";
  add(text, shape.confidence);
  add_reason(text, shape);
  text += ",\"vertices_m\":";
  add_rows(text, shape.vertices_m, [&](const double* xyz) { add_triple(text, xyz); });
  text += ",\"covariance_m2\":";
  if (has_covariance(points)) {
    add_rows(text, shape.covariance_m2, [&](const double* rows) {
      text += '[';
      add_triple(text, rows);
      text += ',';
      add_triple(text, rows + 3);
      text += ',';
      add_triple(text, rows + 6);
      text += ']';
    });
  } else {
    text += "null";
  }
  text += "}\n";
  return text;
}

std::string packed(const FramePoints& points) {
  const Shape& shape = points.shape;
  const bool covariance = has_covariance(points);
  const auto vertices = static_cast<std::size_t>(shape.vertices_m.rows());
  const std::size_t size = kHeaderBytes + vertices * sizeof(double) * (covariance ? 12 : 3);
  std::string bytes = "WEFT";
  bytes.reserve(size);
  put(bytes, kVersion);
  put(bytes, static_cast<std::uint32_t>(size));
  put(bytes, static_cast<std::uint32_t>(vertices));
  put(bytes, points.frame);
  put(bytes, points.time_s);
  put(bytes, shape.confidence);
  put(bytes, shape.state);
  put(bytes, std::uint32_t{covariance ? 1U : 0U});
  put(bytes, shape.age_frames);
  put_rows(bytes, shape.vertices_m);
  if (covariance) put_rows(bytes, shape.covariance_m2);
  return bytes;
}

}  // namespace weft::stream
