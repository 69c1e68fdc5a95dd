// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/inference/onnx_file.hpp"

namespace weft::inference {

/// The forward pass of an ONNX file on the processor.
class Engine {
 public:
  /// Reads and checks the file with read_onnx(), and loads it into the library.
  static Result<std::unique_ptr<Engine>> open(const OnnxFile& file,
                                              const std::vector<std::string>& outputs,
                                              Runtime runtime);

  /// Fails if the library cannot be opened.
  static Result<void> check(Runtime runtime);

  virtual ~Engine() = default;

  /// The outputs, in the order of open(), for an image f32 [height,width,channels]; the next call
  /// overwrites them. OpenCV runs the network on its pool if `threads` is at least the size of the
  /// pool, else on the calling thread. The size of the pool stays as it is. ONNX Runtime uses up to
  /// `threads` threads; a call with another number than the call before loads the network again.
  virtual Result<std::vector<cv::Mat>> run(const cv::Mat& image, int threads) = 0;
};

/// Fails if the output `name` has a number that is not finite.
Result<void> check_finite(const OnnxFile& file, const cv::Mat& output, const std::string& name);

/// The length of each axis, as "1 x 6 x 30 x 40".
std::string size_text(const cv::Mat& output);

}  // namespace weft::inference
