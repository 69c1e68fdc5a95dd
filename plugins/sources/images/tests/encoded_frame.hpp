// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace weft::testing {

/// The bytes of a colour image of 8 x 6 px with this blue value everywhere, in the format of the
/// extension of `name`.
inline std::string encoded_frame(const std::string& name, int blue) {
  std::vector<std::uint8_t> bytes;
  const cv::Mat image(6, 8, CV_8UC3, cv::Scalar(blue, 20, 30));
  if (!cv::imencode(name.substr(name.rfind('.')), image, bytes)) {
    throw std::runtime_error("cannot encode " + name);
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace weft::testing
