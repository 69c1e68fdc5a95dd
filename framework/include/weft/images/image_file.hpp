// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <weft/core/text_file.hpp>
#include <weft/images/image_header.hpp>

namespace weft {

inline constexpr std::uint64_t kMostImageBytes = 1ULL
                                                 << 29U;  ///< [bytes] size limit of an image file
inline constexpr std::int64_t kMostImagePixels = 1LL << 28U;  ///< [px] limit of width times height

/// The bytes of an image file for a decoder of the caller's choice.
struct ImageFile {
  std::string bytes;
  ImageHeader header;
};

namespace detail {

inline ImageHeader bmp_header(const Bytes& bytes) {
  ImageHeader header;
  const auto i32 = [&](std::uint64_t i) { return static_cast<std::int32_t>(bytes.little32(i)); };
  const bool old = bytes.little32(14) == 12;
  header.width_px = old ? std::int64_t{bytes.little16(18)} : std::int64_t{i32(18)};
  header.height_px = old ? std::int64_t{bytes.little16(20)} : std::int64_t{i32(22)};
  header.height_px = std::abs(header.height_px);  // negative: rows from top to bottom
  return header;
}

inline ImageHeader tiff_header(std::string_view text) {
  const TiffFields fields = tiff_fields(text);
  ImageHeader header;
  header.width_px = fields.width_px;
  header.height_px = fields.height_px;
  header.bits = fields.bits == 0 || fields.bits > 8 ? fields.bits : 8;
  take_exif(text, header);
  return header;
}

/// Reads the EXIF data of a WebP file: a separate chunk, usually after the image.
inline void take_webp_exif(const Bytes& bytes, ImageHeader& header) {
  for (std::uint64_t at = 12; bytes.has(at + 8);) {
    const std::uint64_t length = bytes.little32(at + 4);
    if (bytes.part(at, 4) == "EXIF") {
      std::string_view exif = bytes.part(at + 8, length);
      if (exif.starts_with("Exif")) exif.remove_prefix(std::min<std::size_t>(exif.size(), 6));
      return take_exif(exif, header);
    }
    at += 8 + length + length % 2;
  }
}

inline ImageHeader webp_header(const Bytes& bytes) {
  ImageHeader header;
  header.bits = 8;
  const std::string_view form = bytes.part(12, 4);
  if (form == "VP8X") take_webp_exif(bytes, header);
  if (form == "VP8X") {
    header.width_px = 1 + (bytes.little32(24) & 0xFFFFFFU);
    header.height_px = 1 + (bytes.little32(27) & 0xFFFFFFU);
  } else if (form == "VP8L") {
    const std::uint32_t packed = bytes.little32(21);
    header.width_px = 1 + (packed & 0x3FFFU);
    header.height_px = 1 + (packed >> 14U & 0x3FFFU);
  } else {
    header.width_px = bytes.little16(26) & 0x3FFFU;
    header.height_px = bytes.little16(28) & 0x3FFFU;
  }
  return header;
}

/// Reads "P5" or a variant, then width, height and, except for bitmaps, the largest value. Blanks
/// and comments separate them.
inline ImageHeader pnm_header(const Bytes& bytes) {
  ImageHeader header;
  std::uint64_t at = 2;
  std::int64_t largest = 0;
  const bool is_binary_picture = bytes.at(1) == '1' || bytes.at(1) == '4';
  for (std::int64_t* length : {&header.width_px, &header.height_px, &largest}) {
    if (length == &largest && is_binary_picture) break;
    while (bytes.has(at + 1) && !std::isdigit(static_cast<int>(bytes.at(at)))) {
      const bool comment = bytes.at(at) == '#';
      while (comment && bytes.has(at + 1) && bytes.at(at) != '\n') ++at;
      ++at;
    }
    for (; std::isdigit(static_cast<int>(bytes.at(at))) && *length <= kMostImagePixels; ++at) {
      *length = 10 * *length + bytes.at(at) - '0';
    }
  }
  if (largest > 0 || is_binary_picture) header.bits = largest > 255 ? 16 : 8;
  return header;
}

inline Result<ImageHeader> header_of_any(std::string_view text) {
  const Bytes bytes(text);
  if (text.starts_with("\x89PNG\r\n\x1A\n")) return png_header(bytes);
  if (text.starts_with("\xFF\xD8\xFF")) return jpeg_header(bytes);
  if (text.starts_with("BM")) return bmp_header(bytes);
  if (TiffNumbers(text).is_tiff()) return tiff_header(text);
  if (text.starts_with("RIFF") && text.substr(0, 12).ends_with("WEBP")) return webp_header(bytes);
  if (text.size() > 2 && text[0] == 'P' && text[1] >= '1' && text[1] <= '6') {
    return pnm_header(bytes);
  }
  return ImageHeader{};
}

}  // namespace detail

/// Reads the header of an image in memory. Fails with Errc::invalid_data for an empty, truncated or
/// damaged image, and for one with too many pixels, whose decoding would need too much memory.
inline Result<ImageHeader> read_image_header(std::string_view bytes) {
  if (bytes.empty()) return Error{Errc::invalid_data, "it is empty"};
  auto header = detail::header_of_any(bytes);
  if (!header) return header;
  const std::int64_t width = header->width_px, height = header->height_px;
  const bool known = width != 0 || height != 0 || header->complete;
  if (known && (width < 1 || height < 1)) return Error{Errc::invalid_data, "it has no pixels"};
  if (known && width > kMostImagePixels / height) {
    return Error{Errc::invalid_data, "it has " + std::to_string(width) + " x " +
                                         std::to_string(height) + " px, which is more than 2^28"};
  }
  return header;
}

/// Reads the bytes and the header of a regular file. Messages contain the file's path.
inline Result<ImageFile> read_image_bytes(const std::string& path) {
  auto bytes = read_text_file(path, kMostImageBytes);
  if (!bytes) {
    return Error{bytes.error().code, path + ": cannot be read: " + bytes.error().message};
  }
  auto header = read_image_header(*bytes);
  if (header) return ImageFile{*std::move(bytes), *header};
  return Error{header.error().code,
               path + ": is no image that can be decoded: " + header.error().message};
}

/// The error of a file whose bytes the decoder rejects.
inline Error no_image(const std::string& path) {
  return {Errc::invalid_data,
          path + ": is no image that can be decoded (damaged or of an unknown format)",
          {}};
}

}  // namespace weft
