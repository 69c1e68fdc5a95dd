// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

#include "common/inference/runtime.hpp"

namespace weft::inference {

/// The contents of an ONNX file.
struct OnnxContents {
  std::int64_t weights = 0;  ///< number of elements of all tensors
  std::vector<std::string> operators{}, inputs{}, outputs{};
};

/// Walks the bytes of an ONNX file before a library parses them; safe on any bytes. Fails on
/// truncated files, nested graphs and functions, and operators that were not tried with OpenCV.
/// With ONNX Runtime, all operators of ONNX are accepted except those that draw random numbers. The
/// weights must fulfil check_tensor() in onnx_tensor.hpp.
Result<OnnxContents> scan_onnx(std::string_view bytes, Runtime runtime = Runtime::opencv);

/// Fails unless the network has this input and these outputs.
Result<void> check_names(const OnnxContents& contents, const std::string& input,
                         const std::vector<std::string>& outputs);

}  // namespace weft::inference
