// SPDX-License-Identifier: Apache-2.0
#include "image_file.hpp"

#include <opencv2/imgproc.hpp>

namespace weft::images {

Result<cv::Mat> read_image_file(const std::string& path, const cameras::CalibratedCamera& camera) {
  auto image = cameras::read_image_of(path, camera);
  if (!image) return image;
  if (image->depth() != CV_8U) {
    return Error{Errc::unsupported,
                 path +
                     ": has more than 8 bits a channel; convert the images to 8 bits, since only "
                     "you know which values are black and white"};
  }
  if (image->channels() == 2) cv::extractChannel(*image, *image, 0);
  if (image->channels() == 4) cv::cvtColor(*image, *image, cv::COLOR_BGRA2BGR);
  return image;
}

}  // namespace weft::images
