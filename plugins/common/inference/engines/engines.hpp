// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/inference/engine.hpp"

/// The implementations of Engine. `bytes` are those of a file that read_onnx() accepted.
namespace weft::inference {

Result<std::unique_ptr<Engine>> open_opencv(const OnnxFile& file,
                                            const std::vector<std::string>& outputs,
                                            const std::string& bytes);

Result<std::unique_ptr<Engine>> open_onnxruntime(const OnnxFile& file,
                                                 const std::vector<std::string>& outputs,
                                                 std::string bytes);

/// Fails if ONNX Runtime cannot be opened.
Result<void> check_onnxruntime();

/// A message of a library, which may quote any bytes of the file: printable, in one line, of 300
/// characters at most.
std::string one_line(std::string_view text);

}  // namespace weft::inference
