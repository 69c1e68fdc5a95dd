// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>

#include "common/images/decoder.hpp"

namespace weft::image_files {

/// Decodes an image of 8 bits a channel, grey or BGR, upright; transparency becomes white paper.
/// Fails with a message that names the parameter and the file, also on one that is damaged.
Result<cv::Mat> read_picture(const std::string& parameter, const std::string& path);

/// Fails where read_picture() would fail, but does not decode a PNG.
Result<void> check_picture(const std::string& parameter, const std::string& path);

/// The pixels of an image file, upright, with the channels that it stores or grey; fails like
/// read_picture().
Result<cv::Mat> read_pixels(const std::string& parameter, const std::string& path,
                            Channels channels = Channels::as_stored);

/// Adds to an error of a file the parameter that names the file.
Error at_parameter(Error error, const std::string& parameter);

}  // namespace weft::image_files
