// SPDX-License-Identifier: Apache-2.0
#include "common/images/decoder.hpp"

#include <opencv2/imgcodecs.hpp>

#include "common/images/jpeg_decoder.hpp"
#include "common/images/opencv_codecs.hpp"
#include "common/images/png_decoder.hpp"

namespace weft::image_files {
namespace {

/// A TIFF with the orientation 1: OpenCV applies others in part, even with the option that disables
/// it.
std::string without_orientation(const std::string& tiff) {
  const detail::TiffFields fields = detail::tiff_fields(tiff);
  std::string plain = tiff;
  if (fields.orientation_at == 0 || fields.orientation_at + 4 > tiff.size()) return plain;
  const auto at = plain.begin() + static_cast<std::ptrdiff_t>(fields.orientation_at);
  std::fill_n(at, 4, '\0');
  // For one byte, two and four it is the same number in the order of Intel; else for two alone.
  *(at + (fields.big_endian ? 1 : 0)) = 1;
  return plain;
}

}  // namespace

Decoded decode_stored(const ImageFile& file, Channels channels) {
  const std::string& bytes = file.bytes;
  if (bytes.starts_with("\xFF\xD8\xFF")) {
    Decoded decoded;
    decoded.damage = decode_jpeg(bytes, channels == Channels::grey, decoded.pixels);
    return decoded;
  }
  if (bytes.starts_with("\x89PNG")) return {decode_png(bytes, channels == Channels::grey), {}};
  const bool turned = file.header.orientation != 1;
  const int flags = channels == Channels::grey
                        ? cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION
                        : cv::IMREAD_UNCHANGED;
  return {decode_by_opencv(turned ? without_orientation(bytes) : bytes, flags), {}};
}

Decoded decode_upright(const ImageFile& file, Channels channels) {
  Decoded decoded = decode_stored(file, channels);
  if (!decoded.pixels.empty()) decoded.pixels = upright(decoded.pixels, file.header.orientation);
  return decoded;
}

cv::Mat upright(const cv::Mat& stored, int orientation) {
  const Turns turned = turns(orientation);
  cv::Mat image = stored;
  if (turned.sideways) {
    cv::Mat transposed;
    cv::transpose(stored, transposed);
    image = transposed;
  }
  if (turned.columns || turned.rows) {
    constexpr int kRows = 0, kColumns = 1, kBoth = -1;
    const int what = turned.columns && turned.rows ? kBoth : turned.columns ? kColumns : kRows;
    cv::Mat flipped;
    cv::flip(image, flipped, what);
    image = flipped;
  }
  return image;
}

void report_orientation(const Call& call, const std::string& path, int orientation) {
  if (orientation == 1) return;
  call.log_info(path + ": " + orientation_text(orientation) + " to be upright");
}

bool is_surely_whole(const ImageFile& file) {
  return file.header.complete && file.header.bits == 8 && file.bytes.starts_with("\x89PNG");
}

Result<cv::Mat> upright_beside(const Main& main, const cv::Mat& stored, int orientation,
                               const std::string& path) {
  if (orientation == main.orientation) return upright(stored, orientation);
  const cv::Size upright_px = turns(main.orientation).sideways
                                  ? cv::Size(main.stored_px.height, main.stored_px.width)
                                  : main.stored_px;
  if (orientation == 1 && upright_px != main.stored_px) {
    return stored.size() == main.stored_px ? upright(stored, main.orientation) : stored;
  }
  return Error{Errc::invalid_data, path + ": " + orientation_text(orientation) +
                                       " to be upright, but " + main.path + " " +
                                       orientation_text(main.orientation) +
                                       ": save both with the same orientation"};
}

Result<cv::Mat> whole_pixels(const Decoded& decoded, const std::string& path) {
  if (!decoded.damage.empty()) {
    return Error{Errc::invalid_data,
                 path + ": is damaged (" + decoded.damage +
                     "): get the file again, or repair it with another program"};
  }
  if (decoded.pixels.empty()) return no_image(path);
  return decoded.pixels;
}

}  // namespace weft::image_files
