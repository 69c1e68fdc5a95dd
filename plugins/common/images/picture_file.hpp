// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>

namespace weft::image_files {

/// Decodes an image of 8 bits a channel, grey or BGR; transparency becomes white paper. Fails with
/// a message that names the parameter and the file.
Result<cv::Mat> read_picture(const std::string& parameter, const std::string& path);

/// What read_picture() would refuse; a PNG or JPEG that is whole is not decoded for that.
Result<void> check_picture(const std::string& parameter, const std::string& path);

/// The pixels of an image file as they are stored; fails like read_picture().
Result<cv::Mat> read_pixels(const std::string& parameter, const std::string& path);

/// Says with an error of a file which parameter names it.
Error at_parameter(Error error, const std::string& parameter);

/// Empty for what cannot be decoded; never throws. `flags` are OpenCV's.
cv::Mat decode_image(const std::string& bytes, int flags);

}  // namespace weft::image_files
