// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/core/result.hpp>

namespace weft::sources {

/// Decodes an image of 8 bits a channel, grey or BGR; transparency becomes white paper. Fails with
/// a message that names the parameter and the file.
Result<cv::Mat> read_picture(const std::string& parameter, const std::string& path);

}  // namespace weft::sources
