// SPDX-License-Identifier: Apache-2.0
#include <opencv2/dnn.hpp>
#include <utility>

#include "common/inference/engines/engines.hpp"

namespace weft::inference {
namespace {

/// Calls `body`, whose OpenCV exceptions become errors.
template <class Body>
Result<void> guarded(const std::string& path, Body&& body) {
  try {
    body();
    return {};
  } catch (const cv::Exception& thrown) {
    // The text of `err` lacks the place in OpenCV's source.
    return Error{Errc::unsupported,
                 path + ": OpenCV cannot run this network: " +
                     one_line(thrown.err.empty() ? thrown.what() : thrown.err) +
                     "; export it with static sizes and opset 11, or use runtime: onnxruntime"};
  } catch (const std::bad_alloc&) {
    return Error{Errc::no_memory, path + ": the memory does not suffice for this network"};
  } catch (const std::exception& thrown) {
    return Error{Errc::unsupported, path + ": OpenCV cannot read this network: " + thrown.what() +
                                        "; export it again"};
  }
}

class OpenCvEngine final : public Engine {
 public:
  OpenCvEngine(OnnxFile file, const std::vector<std::string>& outputs)
      : file_(std::move(file)), outputs_(outputs.begin(), outputs.end()) {}

  Result<void> load(const std::string& bytes) {
    return guarded(file_.onnx_path, [&] {
      net_ = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
      net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
      net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    });
  }

  Result<std::vector<cv::Mat>> run(const cv::Mat& image, int threads) override {
    std::vector<cv::Mat> outputs;
    auto ran = guarded(file_.onnx_path, [&] {
      const auto forward = [&](const cv::Range&) {
        net_.setInput(cv::dnn::blobFromImage(image), file_.input);
        net_.forward(outputs, outputs_);
      };
      // Loops within a parallel loop of OpenCV run on the calling thread. This keeps a grant of
      // fewer threads without a change of the pool that other components use.
      if (threads < cv::getNumThreads()) {
        cv::parallel_for_(cv::Range(0, 1), forward);
      } else {
        forward(cv::Range(0, 1));
      }
    });
    if (!ran) return ran.error();
    if (outputs.size() != outputs_.size()) {
      return Error{Errc::invalid_data,
                   file_.onnx_path + ": OpenCV gives another number of outputs"};
    }
    return outputs;
  }

 private:
  OnnxFile file_;
  std::vector<cv::String> outputs_;
  cv::dnn::Net net_;
};

}  // namespace

Result<std::unique_ptr<Engine>> open_opencv(const OnnxFile& file,
                                            const std::vector<std::string>& outputs,
                                            const std::string& bytes) {
  auto engine = std::make_unique<OpenCvEngine>(file, outputs);
  if (auto loaded = engine->load(bytes); !loaded) return loaded.error();
  return std::unique_ptr<Engine>(std::move(engine));
}

}  // namespace weft::inference
