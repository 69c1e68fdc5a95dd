// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <weft/core/result.hpp>
#include <weft/images/orientation.hpp>

namespace weft {

/// Properties of an image file before its pixels are decoded. Supports PNG, JPEG, BMP, TIFF, WebP
/// and PNM; all values are 0 for other formats.
struct ImageHeader {
  std::int64_t width_px = 0, height_px = 0;
  int bits = 0;            ///< bits per channel; 0: unknown
  bool has_alpha = false;  ///< known only for PNG
  int orientation = 1;  ///< EXIF orientation, 1 to 8: see turns(); sizes are before its application
  bool complete = false;  ///< PNG and JPEG: all parts are present, with valid checksums in PNG
  int focal_35mm_mm = 0;  ///< [mm] EXIF: equivalent focal length on 35 mm film; 0: unknown
  /// [px] EXIF size of the whole image before the orientation is applied; 0: unknown. Programs that
  /// crop an image may leave it uncorrected.
  std::int64_t exif_width_px = 0, exif_height_px = 0;

  /// Width of the upright image, in px.
  std::int64_t upright_width_px() const {
    return turns(orientation).sideways ? height_px : width_px;
  }
  std::int64_t upright_height_px() const {
    return turns(orientation).sideways ? width_px : height_px;
  }
};

namespace detail {

/// Copies values of EXIF data into an image header.
inline void take_exif(std::string_view exif, ImageHeader& header) {
  const TiffFields fields = tiff_fields(exif);
  header.orientation = fields.orientation;
  header.focal_35mm_mm = fields.focal_35mm_mm;
  header.exif_width_px = fields.exif_width_px;
  header.exif_height_px = fields.exif_height_px;
}

using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

/// Table k has the checksum of a byte that k zero bytes follow.
constexpr CrcTables crc_tables() {
  CrcTables tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t& crc = tables[0][i] = i;
    for (int k = 0; k < 8; ++k) crc = (crc & 1U) != 0 ? 0xEDB88320U ^ crc >> 1U : crc >> 1U;
  }
  for (std::size_t k = 1; k < tables.size(); ++k) {
    for (std::size_t i = 0; i < 256; ++i) {
      const std::uint32_t before = tables[k - 1][i];
      tables[k][i] = tables[0][before & 0xFFU] ^ before >> 8U;
    }
  }
  return tables;
}

/// CRC-32 as in PNG and zip, eight bytes at a time: whole images are checked in each frame.
inline std::uint32_t crc32(std::string_view bytes) {
  static constexpr CrcTables kTables = crc_tables();
  std::uint32_t crc = 0xFFFFFFFFU;
  for (; bytes.size() >= 8; bytes.remove_prefix(8)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), sizeof(word));
    word ^= crc;
    crc = 0;
    for (std::size_t k = 0; k < 8; ++k) crc ^= kTables[7 - k][word >> 8 * k & 0xFFU];
  }
  for (const char byte : bytes) {
    crc = kTables[0][(crc ^ static_cast<unsigned char>(byte)) & 0xFFU] ^ crc >> 8U;
  }
  return ~crc;
}

inline Error cut_off() { return {Errc::invalid_data, "it is damaged or cut off", {}}; }

/// Reads chunks of length, type, data and checksum, from IHDR to IEND.
inline Result<ImageHeader> png_header(const Bytes& bytes) {
  ImageHeader header;
  for (std::uint64_t at = 8;;) {
    const std::uint64_t length = bytes.big32(at);
    if (!bytes.has(at + 12 + length)) return cut_off();
    const std::string_view type = bytes.part(at + 4, 4);
    const bool critical = (bytes.at(at + 4) & 0x20U) == 0;
    const bool is_right = (!critical && type != "eXIf") ||
                          crc32(bytes.part(at + 4, length + 4)) == bytes.big32(at + 8 + length);
    if (critical && !is_right) {
      return Error{Errc::invalid_data, "it is damaged: a checksum is wrong"};
    }
    if (type == "IHDR") {
      header.width_px = bytes.big32(at + 8);
      header.height_px = bytes.big32(at + 12);
      header.bits = bytes.at(at + 16) == 16 ? 16 : 8;
      header.has_alpha = (bytes.at(at + 17) & 4U) != 0;
    }
    if (type == "eXIf" && is_right) {
      take_exif(bytes.part(at + 8, length), header);
    }
    if (type == "tRNS") header.has_alpha = true;
    if (type == "IEND") break;
    at += 12 + length;
  }
  header.complete = true;
  return header;
}

/// Reads segments of a marker and a length, up to the coded data, in which only FF D9 ends the
/// image.
inline Result<ImageHeader> jpeg_header(const Bytes& bytes) {
  ImageHeader header;
  header.bits = 8;
  bool has_exif = false;
  for (std::uint64_t at = 2; bytes.has(at + 4); at += 2 + bytes.big16(at + 2)) {
    while (bytes.at(at) == 0xFF && bytes.at(at + 1) == 0xFF) ++at;
    const std::uint32_t marker = bytes.at(at + 1);
    const bool is_frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (bytes.at(at) != 0xFF) return Error{Errc::invalid_data, "it is damaged"};
    if (is_frame) {
      header.height_px = bytes.big16(at + 5);
      header.width_px = bytes.big16(at + 7);
    }
    const std::string_view exif = bytes.part(at + 4, bytes.big16(at + 2) - 2);
    if (marker == 0xE1 && exif.starts_with(std::string_view("Exif\0", 5)) && !has_exif) {
      take_exif(exif.substr(std::min<std::size_t>(exif.size(), 6)), header);
      has_exif = true;
    }
    if (marker != 0xDA) continue;
    const std::string_view rest = bytes.part(at, bytes.size());
    header.complete = rest.find("\xFF\xD9") != std::string_view::npos;
    break;
  }
  if (!header.complete) return cut_off();
  return header;
}

}  // namespace detail
}  // namespace weft
