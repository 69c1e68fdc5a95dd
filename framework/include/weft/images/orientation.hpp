// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <weft/core/index.hpp>

namespace weft {

/// Transform of a stored image to an upright one: a transposition or none, then reversals of
/// columns and rows. EXIF numbers the eight cases from 1 to 8.
struct Turns {
  bool sideways = false, columns = false, rows = false;

  /// True for transforms that include a reflection.
  bool mirrored() const { return (sideways != columns) != rows; }
};

inline Turns turns(int orientation) {
  switch (orientation) {
    case 2:
      return {false, true, false};
    case 3:
      return {false, true, true};
    case 4:
      return {false, false, true};
    case 5:
      return {true, false, false};
    case 6:
      return {true, true, false};
    case 7:
      return {true, true, true};
    case 8:
      return {true, false, true};
    default:
      return {};
  }
}

/// Describes the transform of an orientation, for messages.
inline std::string orientation_text(int orientation) {
  static constexpr const char* kTexts[] = {"is not turned",
                                           "is mirrored",
                                           "is turned by 180 degrees",
                                           "is turned by 180 degrees and mirrored",
                                           "is turned by 90 degrees clockwise and mirrored",
                                           "is turned by 90 degrees clockwise",
                                           "is turned by 90 degrees anticlockwise and mirrored",
                                           "is turned by 90 degrees anticlockwise"};
  return std::string(kTexts[std::clamp(orientation, 1, 8) - 1]) + " (EXIF orientation " +
         std::to_string(orientation) + ")";
}

namespace detail {

/// Reads numbers at positions of a text; they are 0 beyond its end.
class Bytes {
 public:
  explicit Bytes(std::string_view text) : text_(text) {}
  bool has(std::uint64_t end) const { return end <= text_.size(); }
  std::uint32_t at(std::uint64_t i) const {
    return i < text_.size() ? static_cast<unsigned char>(text_[to_index(i)]) : 0U;
  }
  std::uint32_t big16(std::uint64_t i) const { return at(i) << 8U | at(i + 1); }
  std::uint32_t big32(std::uint64_t i) const { return big16(i) << 16U | big16(i + 2); }
  std::uint32_t little16(std::uint64_t i) const { return at(i + 1) << 8U | at(i); }
  std::uint32_t little32(std::uint64_t i) const { return little16(i + 2) << 16U | little16(i); }
  std::string_view part(std::uint64_t from, std::uint64_t count) const {
    return from > text_.size() ? std::string_view() : text_.substr(to_index(from), to_index(count));
  }
  std::uint64_t size() const { return text_.size(); }

 private:
  std::string_view text_;
};

/// Fields of the first directory of a TIFF file or of EXIF data, which share the format, and of the
/// EXIF directory that it references.
struct TiffFields {
  std::int64_t width_px = 0, height_px = 0;  ///< [px] stored size
  int bits = 0;                              ///< bits per channel; 0: unknown
  int orientation = 1;                       ///< EXIF orientation, 1 to 8
  int focal_35mm_mm = 0;                     ///< [mm] FocalLengthIn35mmFilm; 0: absent
  std::int64_t exif_width_px = 0,
               exif_height_px = 0;   ///< [px] PixelXDimension, PixelYDimension; 0: absent
  std::uint64_t orientation_at = 0;  ///< byte offset of the orientation value; 0: absent
  bool big_endian = false;
};

/// Numbers of a TIFF in one of two byte orders, with offsets of one of two sizes.
class TiffNumbers {
 public:
  explicit TiffNumbers(std::string_view text)
      : bytes_(text), big_endian_(text.starts_with("MM")), wide_(u16(2) == 43) {}

  bool big_endian() const { return big_endian_; }
  /// Checks the magic number of classic TIFF and BigTIFF, after the byte order.
  bool is_tiff() const {
    return (bytes_.at(0) == 'I' || big_endian_) && bytes_.at(0) == bytes_.at(1) &&
           (u16(2) == 42 || wide_);
  }
  std::uint64_t u16(std::uint64_t i) const {
    return big_endian_ ? bytes_.big16(i) : bytes_.little16(i);
  }
  std::uint64_t u32(std::uint64_t i) const {
    return big_endian_ ? bytes_.big32(i) : bytes_.little32(i);
  }
  /// Reads an offset or a count.
  std::uint64_t word(std::uint64_t i) const {
    if (!wide_) return u32(i);
    return big_endian_ ? u32(i) << 32U | u32(i + 4) : u32(i + 4) << 32U | u32(i);
  }
  std::uint64_t word_bytes() const { return wide_ ? 8 : 4; }

  std::uint64_t first_directory() const { return wide_ ? word(8) : u32(4); }
  std::uint64_t entries(std::uint64_t directory) const {
    constexpr std::uint64_t kMost = 65535;
    return std::min(kMost, wide_ ? word(directory) : u16(directory));
  }
  std::uint64_t entry(std::uint64_t directory, std::uint64_t index) const {
    return directory + (wide_ ? 8 : 2) + index * (4 + 2 * word_bytes());
  }
  std::uint64_t value_at(std::uint64_t entry) const { return entry + 4 + word_bytes(); }
  /// The first value of an entry, which is stored elsewhere if the values do not fit.
  std::uint64_t value(std::uint64_t entry) const {
    const std::uint64_t type = u16(entry + 2), at = value_at(entry);
    if (type == 3) return u16(2 * word(entry + 4) > word_bytes() ? word(at) : at);
    return type == 1 ? bytes_.at(at) : type == 16 ? word(at) : u32(at);
  }

 private:
  Bytes bytes_;
  bool big_endian_, wide_;
};

/// Calls visit(tag, entry) for the entries of a directory that lie within the text.
template <class Visit>
void for_each_entry(const TiffNumbers& numbers, std::uint64_t directory, std::uint64_t end,
                    Visit&& visit) {
  for (std::uint64_t i = 0; i < numbers.entries(directory); ++i) {
    const std::uint64_t entry = numbers.entry(directory, i);
    if (entry >= end) break;
    visit(numbers.u16(entry), entry);
  }
}

inline TiffFields tiff_fields(std::string_view text) {
  TiffFields fields;
  const TiffNumbers numbers(text);
  if (!numbers.is_tiff()) return fields;
  fields.big_endian = numbers.big_endian();
  std::uint64_t exif = 0;  // byte offset of the EXIF directory
  for_each_entry(numbers, numbers.first_directory(), text.size(), [&](auto tag, auto entry) {
    const std::uint64_t value = numbers.value(entry);
    if (tag == 256) fields.width_px = static_cast<std::int64_t>(value);
    if (tag == 257) fields.height_px = static_cast<std::int64_t>(value);
    if (tag == 258) fields.bits = static_cast<int>(std::min<std::uint64_t>(value, 64));
    if (tag == 274) fields.orientation_at = numbers.value_at(entry);
    if (tag == 274 && value >= 1 && value <= 8) fields.orientation = static_cast<int>(value);
    if (tag == 34665) exif = value;
  });
  if (exif == 0) return fields;
  for_each_entry(numbers, exif, text.size(), [&](auto tag, auto entry) {
    constexpr std::uint64_t kMost = 65535;  // limit of two bytes and of the side of an image
    const std::uint64_t value = std::min(kMost, numbers.value(entry));
    if (tag == 41989) fields.focal_35mm_mm = static_cast<int>(value);
    if (tag == 40962) fields.exif_width_px = static_cast<std::int64_t>(value);
    if (tag == 40963) fields.exif_height_px = static_cast<std::int64_t>(value);
  });
  return fields;
}

}  // namespace detail
}  // namespace weft
