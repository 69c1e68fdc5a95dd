// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

namespace weft::video {

/// True if an address is a pipeline of GStreamer: elements with a ! between.
bool is_pipeline(const std::string& address);

/// A pipeline gives its frames to `appsink` and writes nowhere: an error that names the element or
/// property that would, and where there is no appsink.
Result<void> check_pipeline(const std::string& pipeline);

}  // namespace weft::video
