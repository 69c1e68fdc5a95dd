// SPDX-License-Identifier: Apache-2.0
#include "image_file.hpp"

#include <opencv2/imgproc.hpp>
#include <optional>
#include <weft/images/image_file.hpp>

namespace weft::images {
namespace {

constexpr std::uint64_t kMostBytes = 1U << 26U;  ///< size of files, before the rest is trusted

Error more_than_8_bits(const std::string& path) {
  return {Errc::unsupported,
          path +
              ": has more than 8 bits a channel; convert the images to 8 bits, since only "
              "you know which values are black and white",
          {}};
}

Result<cameras::CalibratedCamera> camera_of(const ImageFile& file, const std::string& path,
                                            const cameras::CalibratedCamera& camera) {
  const ImageHeader& header = file.header;
  int bits = header.bits;
  cv::Size size(static_cast<int>(header.width_px), static_cast<int>(header.height_px));
  if (bits == 0 || size.width == 0) {  // a format whose header is not read here
    const cv::Mat pixels = image_files::decode_stored(file).pixels;
    if (pixels.empty()) return no_image(path);
    bits = pixels.depth() == CV_8U ? 8 : 16;
    size = pixels.size();
  }
  auto fits = camera.of_images({size, header.orientation}, path);
  return fits && bits > 8 ? more_than_8_bits(path) : fits;
}

}  // namespace

Result<image_files::Decoded> of_8_bits(image_files::Decoded image, const std::string& path) {
  cv::Mat& pixels = image.pixels;
  if (pixels.empty()) return image_files::whole_pixels(image, path).error();
  if (pixels.depth() != CV_8U) return more_than_8_bits(path);
  if (pixels.channels() == 2) cv::extractChannel(pixels, pixels, 0);
  if (pixels.channels() == 4) cv::cvtColor(pixels, pixels, cv::COLOR_BGRA2BGR);
  return image;
}

Result<image_files::Decoded> read_image_file(const std::string& path,
                                             const cameras::CalibratedCamera& camera) {
  auto image = cameras::read_image_of(path, camera);
  return image ? of_8_bits(*std::move(image), path) : image;
}

Result<cameras::CalibratedCamera> camera_of_files(const std::vector<std::string>& paths,
                                                  const cameras::CalibratedCamera& camera) {
  std::optional<cameras::CalibratedCamera> found;
  std::optional<Error> mistake;
  std::optional<std::pair<std::string, int>> first;  // path and orientation
  std::uint64_t bytes = 0;
  for (const std::string& path : paths) {
    const auto file = read_image_bytes(path);
    if (!file) continue;
    if (!first) first = {path, file->header.orientation};
    if (file->header.orientation != first->second) {
      return Error{Errc::unsupported,
                   path + ": " + orientation_text(file->header.orientation) +
                       " to be upright, but " + first->first + " " +
                       orientation_text(first->second) +
                       ": all images of a source have one camera; read those of each orientation "
                       "by themselves, or save all upright"};
    }
    if (!found) {
      if (auto fits = camera_of(*file, path, camera)) {
        found = *std::move(fits);
      } else if (!mistake) {
        mistake = fits.error();
      }
    }
    bytes += file->bytes.size();
    if (found && bytes > kMostBytes) break;
  }
  if (found || !mistake) return found ? *std::move(found) : camera;
  return *mistake;
}

}  // namespace weft::images
