// SPDX-License-Identifier: Apache-2.0
#include "common/images/png_decoder.hpp"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <string_view>
#include <vector>
#include <weft/core/stop_check.hpp>

namespace weft::image_files {
namespace {

[[noreturn]] void on_png_error(png_structp reader, png_const_charp /*message*/) {
  png_longjmp(reader, 1);
}

void on_png_warning(png_structp /*reader*/, png_const_charp /*message*/) {}

void take_bytes(png_structp reader, png_bytep to, std::size_t count) {
  auto& left = *static_cast<std::string_view*>(png_get_io_ptr(reader));
  if (count > left.size()) png_error(reader, "the file is cut off");
  std::memcpy(to, left.data(), count);
  left.remove_prefix(count);
}

class PngReader {
 public:
  explicit PngReader(std::string_view bytes)
      : left_(bytes),
        reader_(
            png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, on_png_error, on_png_warning)),
        info_(reader_ != nullptr ? png_create_info_struct(reader_) : nullptr) {}
  ~PngReader() { png_destroy_read_struct(&reader_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  // Between setjmp and longjmp no object may need destruction, so each step is a separate function.
  bool begin(bool grey) {
    if (info_ == nullptr) return false;
    if (setjmp(png_jmpbuf(reader_)) != 0) return false;  // NOLINT(cert-err52-cpp): libpng is C
    png_set_read_fn(reader_, &left_, take_bytes);
    png_read_info(reader_, info_);
    const int colours = png_get_color_type(reader_, info_);
    const bool is_palette = colours == PNG_COLOR_TYPE_PALETTE;
    const bool is_deep = png_get_bit_depth(reader_, info_) == 16;
    const bool is_coloured = (colours & PNG_COLOR_MASK_COLOR) != 0;
    const bool has_alpha = (colours & PNG_COLOR_MASK_ALPHA) != 0 ||
                           (is_coloured && png_get_valid(reader_, info_, PNG_INFO_tRNS) != 0);
    if (is_deep && grey) png_set_strip_16(reader_);
    if (is_deep && !grey && !kIsBigEndian) png_set_swap(reader_);
    if (is_palette) png_set_palette_to_rgb(reader_);
    if (!is_coloured) png_set_expand_gray_1_2_4_to_8(reader_);
    if (grey || !has_alpha) png_set_strip_alpha(reader_);
    if (!grey && has_alpha) png_set_tRNS_to_alpha(reader_);
    if (!grey && is_coloured) png_set_bgr(reader_);
    if (!grey && has_alpha && !is_coloured) png_set_gray_to_rgb(reader_);
    constexpr int kSilently = 1;
    constexpr double kRed = 0.299, kGreen = 0.587;  // weights of ITU-R BT.601
    if (grey && is_coloured) png_set_rgb_to_gray(reader_, kSilently, kRed, kGreen);
    png_set_interlace_handling(reader_);
    png_read_update_info(reader_, info_);
    channels_ = png_get_channels(reader_, info_);
    depth_ = png_get_bit_depth(reader_, info_) == 16 ? CV_16U : CV_8U;
    size_ = {static_cast<int>(png_get_image_width(reader_, info_)),
             static_cast<int>(png_get_image_height(reader_, info_))};
    return true;
  }

  bool read(png_bytepp rows) {
    if (setjmp(png_jmpbuf(reader_)) != 0) return false;  // NOLINT(cert-err52-cpp)
    png_read_image(reader_, rows);
    png_read_end(reader_, info_);
    return true;
  }

  cv::Size size() const { return size_; }
  int type() const { return CV_MAKETYPE(depth_, channels_); }

 private:
  static constexpr bool kIsBigEndian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;

  std::string_view left_;
  png_structp reader_;
  png_infop info_;
  cv::Size size_;
  int depth_ = CV_8U, channels_ = 1;
};

}  // namespace

cv::Mat decode_png(const std::string& bytes, bool grey) {
  PngReader reader(bytes);
  if (!reader.begin(grey)) return {};
  cv::Mat pixels(reader.size(), reader.type());
  std::vector<png_bytep> rows(static_cast<std::size_t>(pixels.rows));
  for (int y = 0; y < pixels.rows; ++y) rows[static_cast<std::size_t>(y)] = pixels.ptr(y);
  worked(static_cast<std::int64_t>(pixels.total()));
  if (!reader.read(rows.data())) return {};
  return pixels;
}

}  // namespace weft::image_files
