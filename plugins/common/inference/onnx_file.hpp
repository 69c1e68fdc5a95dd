// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "common/inference/runtime.hpp"

namespace weft::inference {

/// An ONNX file and the yaml file that describes it.
struct OnnxFile {
  std::string path{};       ///< path of the yaml file
  std::string onnx_path{};  ///< path of the ONNX file beside it
  std::string onnx_hash{};  ///< XXH3-64 of the ONNX file's bytes, 16 hexadecimal digits
  std::string input{};      ///< name of the network's input
};

/// Reads the ONNX file. Fails unless its hash is that of the yaml file and it has these outputs.
/// scan_onnx() must find its contents safe to hand to the library.
Result<std::string> read_onnx(const OnnxFile& file, const std::vector<std::string>& outputs,
                              Runtime runtime = Runtime::opencv);

}  // namespace weft::inference
