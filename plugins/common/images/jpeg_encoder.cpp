// SPDX-License-Identifier: Apache-2.0
#include "common/images/jpeg_encoder.hpp"

#include <csetjmp>
#include <cstdlib>
// clang-format off: jpeglib.h needs the first
#include <jpeglib.h>

#include <cstdio>
// clang-format on

namespace weft::image_files {
namespace {

class Encoder {
 public:
  Encoder() {
    data_.err = jpeg_std_error(&errors_);
    data_.client_data = this;
    errors_.error_exit = [](j_common_ptr data) {
      std::longjmp(static_cast<Encoder*>(data->client_data)->failed_, 1);
    };
    errors_.output_message = [](j_common_ptr) {};
  }
  ~Encoder() {
    jpeg_destroy_compress(&data_);
    std::free(bytes_);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  // Between setjmp and longjmp no object may need destruction.
  bool encode(const cv::Mat& image, int quality) {
    if (setjmp(failed_) != 0) return false;  // NOLINT(cert-err52-cpp): libjpeg is C
    jpeg_create_compress(&data_);
    jpeg_mem_dest(&data_, &bytes_, &size_);
    data_.image_width = static_cast<JDIMENSION>(image.cols);
    data_.image_height = static_cast<JDIMENSION>(image.rows);
    data_.input_components = image.channels();
    data_.in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
    jpeg_set_defaults(&data_);
    jpeg_set_quality(&data_, quality, TRUE);
    jpeg_start_compress(&data_, TRUE);
    while (data_.next_scanline < data_.image_height) {
      auto* row = const_cast<JSAMPROW>(image.ptr(static_cast<int>(data_.next_scanline)));
      jpeg_write_scanlines(&data_, &row, 1);
    }
    jpeg_finish_compress(&data_);
    return true;
  }

  std::vector<std::uint8_t> bytes() const { return {bytes_, bytes_ + size_}; }

 private:
  jpeg_compress_struct data_{};
  jpeg_error_mgr errors_{};
  std::jmp_buf failed_{};
  unsigned char* bytes_ = nullptr;
  unsigned long size_ = 0;
};

}  // namespace

std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality) {
  if (image.type() != CV_8UC1 && image.type() != CV_8UC3) return {};
  Encoder encoder;
  return encoder.encode(image, quality) ? encoder.bytes() : std::vector<std::uint8_t>();
}

}  // namespace weft::image_files
