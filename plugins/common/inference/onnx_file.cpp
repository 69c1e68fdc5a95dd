// SPDX-License-Identifier: Apache-2.0
#include "common/inference/onnx_file.hpp"

#include <weft/core/text_file.hpp>

#include "common/inference/hash.hpp"
#include "common/inference/onnx_scan.hpp"

namespace weft::inference {
namespace {

constexpr std::uint64_t kMostOnnxBytes = std::uint64_t{1} << 29U;

}  // namespace

Result<std::string> read_onnx(const OnnxFile& file, const std::vector<std::string>& outputs,
                              Runtime runtime) {
  auto bytes = read_text_file(file.onnx_path, kMostOnnxBytes);
  if (!bytes) {
    return Error{bytes.error().code, file.onnx_path + ": " + unreadable_text(bytes.error()) +
                                         "; put the ONNX file beside " + file.path};
  }
  if (const std::string hash = hash_of(*bytes); hash != file.onnx_hash) {
    return Error{Errc::invalid_data, file.onnx_path + " is not the file that " + file.path +
                                         " describes: its hash is " + hash + ", not " +
                                         file.onnx_hash +
                                         "; copy both files again, or correct onnx_hash"};
  }
  const auto contents = scan_onnx(*bytes, runtime);
  if (!contents) {
    return Error{contents.error().code, file.onnx_path + ": " + contents.error().message};
  }
  if (auto named = check_names(*contents, file.input, outputs); !named) {
    return Error{named.error().code, file.onnx_path + ": " + named.error().message};
  }
  return bytes;
}

}  // namespace weft::inference
