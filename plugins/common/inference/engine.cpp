// SPDX-License-Identifier: Apache-2.0
#include "common/inference/engine.hpp"

#include <utility>

#include "common/inference/engines/engines.hpp"

namespace weft::inference {

std::string one_line(std::string_view text) {
  constexpr std::size_t kLongest = 300;
  std::string line(text.substr(0, kLongest));
  for (char& c : line) {
    const auto code = static_cast<unsigned char>(c);
    if (code < ' ' || code > '~') c = code < ' ' ? ' ' : '?';
  }
  return line;
}

std::string size_text(const cv::Mat& output) {
  std::string text;
  for (int axis = 0; axis < output.dims; ++axis) {
    text += (axis == 0 ? "" : " x ") + std::to_string(output.size[axis]);
  }
  return text;
}

Result<void> check_finite(const OnnxFile& file, const cv::Mat& output, const std::string& name) {
  if (output.empty() || cv::checkRange(output.reshape(1, 1))) return {};
  return Error{Errc::invalid_data, file.onnx_path + ": the output '" + name +
                                       "' is not finite: train or export the network again"};
}

Result<void> Engine::check(Runtime runtime) {
  return runtime == Runtime::onnxruntime ? check_onnxruntime() : Result<void>();
}

Result<std::unique_ptr<Engine>> Engine::open(const OnnxFile& file,
                                             const std::vector<std::string>& outputs,
                                             Runtime runtime) {
  auto bytes = read_onnx(file, outputs, runtime);
  if (!bytes) return bytes.error();
  return runtime == Runtime::onnxruntime ? open_onnxruntime(file, outputs, *std::move(bytes))
                                         : open_opencv(file, outputs, *bytes);
}

}  // namespace weft::inference
