// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/inference/onnx_file.hpp"

namespace weft::inference {

/// The forward pass of an ONNX file with OpenCV's module dnn on the processor.
class Engine {
 public:
  /// Reads and checks the file with read_onnx(), and hands it to OpenCV.
  static Result<Engine> open(const OnnxFile& file, const std::vector<std::string>& outputs);

  Engine(Engine&&) noexcept;
  Engine& operator=(Engine&&) noexcept;
  ~Engine();

  /// The outputs, in the order of open(), for an image f32 [height,width,channels]; the next call
  /// overwrites them. The network runs on OpenCV's pool if `threads` is at least its size, else on
  /// the calling thread. The size of the pool stays as it is.
  Result<std::vector<cv::Mat>> run(const cv::Mat& image, int threads);

  /// Fails if the output `name` has a number that is not finite.
  Result<void> check_finite(const cv::Mat& output, const std::string& name) const;

 private:
  struct Net;
  Engine(OnnxFile file, std::vector<std::string> outputs);

  OnnxFile file_;
  std::vector<std::string> outputs_;
  std::unique_ptr<Net> net_;
};

/// The length of each axis, as "1 x 6 x 30 x 40".
std::string size_text(const cv::Mat& output);

}  // namespace weft::inference
