// SPDX-License-Identifier: Apache-2.0
#include "common/images/jpeg_decoder.hpp"

#include <array>
#include <csetjmp>
#include <opencv2/imgproc.hpp>
#include <weft/core/stop_check.hpp>
// clang-format off: jpeglib.h needs the first
#include <jerror.h>
#include <jpeglib.h>

#include <cstdio>
// clang-format on

namespace weft::image_files {
namespace {

/// Where libjpeg reports to: it neither prints nor ends the process.
struct Reports {
  jpeg_error_mgr manager{};  // first, so that libjpeg's pointer to it points to this
  std::jmp_buf failed{};
  std::array<char, JMSG_LENGTH_MAX> damage{};
  bool takes_short_end = false;  ///< some encoders of films do not fill the last byte of the code

  static Reports& of(j_common_ptr decoder) { return *reinterpret_cast<Reports*>(decoder->err); }
};

/// Other warnings are about headers that other programs wrote, not about the image.
bool is_damage(int code) {
  return code != JWRN_ADOBE_XFORM && code != JWRN_JFIF_MAJOR && code != JWRN_TOO_MUCH_DATA;
}

void note(j_common_ptr decoder) {
  Reports& reports = Reports::of(decoder);
  if (reports.damage.front() == '\0')
    reports.manager.format_message(decoder, reports.damage.data());
}

/// True if the code ended within the last row of blocks. `decoder` is a jpeg_decompress_struct.
bool is_short_end(j_common_ptr decoder) {
  const auto& data = *reinterpret_cast<j_decompress_ptr>(decoder);
  return decoder->err->msg_code == JWRN_HIT_MARKER &&
         data.input_iMCU_row + 1 >= data.total_iMCU_rows;
}

void on_message(j_common_ptr decoder, int level) {
  if (level >= 0 || !is_damage(decoder->err->msg_code)) return;
  if (!Reports::of(decoder).takes_short_end || !is_short_end(decoder)) note(decoder);
}

[[noreturn]] void on_error(j_common_ptr decoder) {
  note(decoder);
  std::longjmp(Reports::of(decoder).failed, 1);
}

class Decoder {
 public:
  Decoder() {
    data_.err = jpeg_std_error(&reports_.manager);
    reports_.manager.error_exit = on_error;
    reports_.manager.emit_message = on_message;
  }
  ~Decoder() { jpeg_destroy_decompress(&data_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  // Between setjmp and longjmp no object may need destruction, so each step is a separate function.
  bool begin(const std::string& bytes, bool grey) {
    if (setjmp(reports_.failed) != 0) return false;  // NOLINT(cert-err52-cpp): libjpeg is C
    jpeg_create_decompress(&data_);
    jpeg_mem_src(&data_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&data_, TRUE);
    const bool one_channel = data_.num_components == 1 || (grey && data_.num_components == 3);
    data_.out_color_space = one_channel                 ? JCS_GRAYSCALE
                            : data_.num_components == 4 ? JCS_CMYK
                                                        : JCS_EXT_BGR;
    jpeg_start_decompress(&data_);
    return true;
  }

  bool read_row(unsigned char* row) {
    if (setjmp(reports_.failed) != 0) return false;  // NOLINT(cert-err52-cpp)
    return jpeg_read_scanlines(&data_, &row, 1) == 1;
  }

  void end() {
    if (setjmp(reports_.failed) != 0) return;  // NOLINT(cert-err52-cpp)
    jpeg_finish_decompress(&data_);
  }

  /// Reads all coded data.
  void read_code(const std::string& bytes) {
    reports_.takes_short_end = true;
    if (setjmp(reports_.failed) != 0) return;  // NOLINT(cert-err52-cpp)
    jpeg_create_decompress(&data_);
    jpeg_mem_src(&data_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&data_, TRUE);
    jpeg_read_coefficients(&data_);
    jpeg_finish_decompress(&data_);
  }

  cv::Size size() const {
    return {static_cast<int>(data_.output_width), static_cast<int>(data_.output_height)};
  }
  int channels() const { return data_.output_components; }
  std::string damage() const { return reports_.damage.data(); }

 private:
  Reports reports_;
  jpeg_decompress_struct data_{};
};

/// As OpenCV does: printers' files store the inks inverted.
cv::Mat bgr_of_inks(const cv::Mat& cmyk) {
  cv::Mat bgr(cmyk.size(), CV_8UC3);
  for (int y = 0; y < cmyk.rows; ++y) {
    for (int x = 0; x < cmyk.cols; ++x) {
      const cv::Vec4b& inks = cmyk.at<cv::Vec4b>(y, x);
      for (int i = 0; i < 3; ++i) {
        const int black = inks[3];
        bgr.at<cv::Vec3b>(y, x)[2 - i] =
            static_cast<std::uint8_t>(black - ((255 - inks[i]) * black >> 8));
      }
    }
  }
  return bgr;
}

}  // namespace

std::string decode_jpeg(const std::string& bytes, bool grey, cv::Mat& pixels) {
  pixels.release();
  Decoder decoder;
  if (!decoder.begin(bytes, grey)) return decoder.damage();
  cv::Mat rows = cv::Mat::zeros(decoder.size(), CV_8UC(decoder.channels()));
  for (int y = 0; y < rows.rows; ++y) {
    worked(rows.cols);
    if (!decoder.read_row(rows.ptr(y))) return decoder.damage();
  }
  decoder.end();  // errors behind the last row cost no pixels, but are damage
  pixels = rows.channels() == 4 ? bgr_of_inks(rows) : rows;
  if (grey && pixels.channels() == 3) cv::cvtColor(pixels, pixels, cv::COLOR_BGR2GRAY);
  return decoder.damage();
}

std::string jpeg_damage(const std::string& bytes) {
  Decoder decoder;
  decoder.read_code(bytes);
  return decoder.damage();
}

}  // namespace weft::image_files
