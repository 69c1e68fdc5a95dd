// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::inference {

/// An ONNX file and the yaml file that describes it.
struct OnnxFile {
  std::string path{};       ///< path of the yaml file
  std::string onnx_path{};  ///< path of the ONNX file beside it
  std::string onnx_hash{};  ///< XXH3-64 of the ONNX file's bytes, 16 hexadecimal digits
  std::string input{};      ///< name of the network's input
};

/// Reads the ONNX file and checks that its hash is that of the yaml file, that its contents are
/// safe to hand to OpenCV (see onnx_scan.hpp), and that it has these outputs.
Result<std::string> read_onnx(const OnnxFile& file, const std::vector<std::string>& outputs);

}  // namespace weft::inference
