// SPDX-License-Identifier: Apache-2.0
#include "common/ply/ply_reader.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <weft/core/stop_check.hpp>

namespace weft::ply {
namespace {

constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

template <class T>
double as(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double value_of(PlyType type, const unsigned char* bytes) {
  switch (type) {
    case PlyType::i8:
      return as<std::int8_t>(bytes);
    case PlyType::u8:
      return as<std::uint8_t>(bytes);
    case PlyType::i16:
      return as<std::int16_t>(bytes);
    case PlyType::u16:
      return as<std::uint16_t>(bytes);
    case PlyType::i32:
      return as<std::int32_t>(bytes);
    case PlyType::u32:
      return as<std::uint32_t>(bytes);
    case PlyType::f32:
      return as<float>(bytes);
    case PlyType::f64:
      break;
  }
  return as<double>(bytes);
}

bool is_length(double count) { return count >= 0.0 && count == std::floor(count); }

std::string no_length(const PlyProperty& property) {
  return "'" + property.name +
         "' begins with its length, which must be a whole number from 0: correct it, or export the "
         "file again";
}

}  // namespace

bool is_ply(std::string_view text) {
  return text.starts_with("ply") && text.find_first_of("\r\n") == 3;
}

double number_at(const PlyRow& row, int property) {
  if (property < 0 || row[to_index(property)].size() != 1) return NAN;
  return row[to_index(property)].front();
}

Result<void> PlyReader::read_header(PlyUse use) {
  auto header = read_ply_header(path_, lines_, use);
  if (!header) return header.error();
  header_ = *std::move(header);
  bytes_ = lines_.rest();
  return {};
}

Error PlyReader::mistake(const PlyElement& element, std::int64_t i,
                         const std::string& sentence) const {
  if (line() > 0) return mistake_at(path_, line(), sentence);
  const std::string where = element.name + " " + std::to_string(i + 1);
  return {Errc::invalid_data, path_ + ": " + where + ": " + sentence, {}};
}

std::int64_t PlyReader::line() const {
  return header_.format == PlyFormat::ascii ? lines_.number() : 0;
}

Error PlyReader::cut_off(const PlyElement& element, std::int64_t i) const {
  return {Errc::invalid_data,
          path_ + ": ends in " + element.name + " " + std::to_string(i + 1) + " of " +
              std::to_string(element.count) + ": the file is cut off; copy or export it again",
          {}};
}

Result<void> PlyReader::read_row(const PlyElement& element, std::int64_t i, PlyRow& row) {
  worked_in_loop(i);
  for (std::vector<double>& values : row) values.clear();
  return header_.format == PlyFormat::ascii ? read_ascii(element, i, row)
                                            : read_binary(element, i, row);
}

Result<void> PlyReader::read_ascii(const PlyElement& element, std::int64_t i, PlyRow& row) {
  std::vector<std::string_view> words;
  while (words.empty()) {
    const auto line = lines_.next();
    if (!line) return cut_off(element, i);
    words = words_of(*line);
  }
  std::size_t at = 0;
  const auto next = [&] {
    return at < words.size() ? number_in<double>(words[at++]) : std::nullopt;
  };
  for (std::size_t k = 0; k < row.size(); ++k) {
    const PlyProperty& property = element.properties[k];
    std::vector<double>& values = row[k];
    const auto count = property.length ? next() : std::optional(1.0);
    if (count && !is_length(*count)) return mistake(element, i, no_length(property));
    while (count && static_cast<double>(values.size()) < *count) {
      const auto value = next();
      if (!value) break;
      values.push_back(*value);
    }
    if (!count || static_cast<double>(values.size()) < *count) {
      return mistake(element, i,
                     "'" + property.name +
                         "' has too few numbers, or a word that is none: "
                         "correct the line");
    }
  }
  if (at == words.size()) return {};
  return mistake(element, i,
                 "the line has " + std::to_string(words.size()) +
                     " numbers where the header declares " + std::to_string(at) +
                     ": correct the line");
}

Result<void> PlyReader::read_binary(const PlyElement& element, std::int64_t i, PlyRow& row) {
  for (std::size_t k = 0; k < row.size(); ++k) {
    const PlyProperty& property = element.properties[k];
    const auto count = property.length ? binary_value(*property.length) : std::optional(1.0);
    if (!count) return cut_off(element, i);
    if (!is_length(*count)) return mistake(element, i, no_length(property));
    const double left = static_cast<double>(bytes_.size());
    if (*count * static_cast<double>(kBytes[static_cast<int>(property.type)]) > left) {
      return cut_off(element, i);
    }
    while (static_cast<double>(row[k].size()) < *count) {
      row[k].push_back(*binary_value(property.type));
    }
  }
  return {};
}

std::optional<double> PlyReader::binary_value(PlyType type) {
  static_assert(std::endian::native == std::endian::little);
  const std::size_t size = kBytes[static_cast<int>(type)];
  if (bytes_.size() < size) return std::nullopt;
  unsigned char raw[sizeof(double)];
  std::memcpy(raw, bytes_.data(), size);
  bytes_.remove_prefix(size);
  if (header_.format == PlyFormat::big_endian) std::reverse(raw, raw + size);
  return value_of(type, raw);
}

}  // namespace weft::ply
