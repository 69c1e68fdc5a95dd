// SPDX-License-Identifier: Apache-2.0
#include "common/inference/engine.hpp"

#include <opencv2/dnn.hpp>
#include <utility>

namespace weft::inference {
namespace {

/// OpenCV's text without its line breaks and the place in its source.
std::string text_of(const cv::Exception& thrown) {
  std::string text = thrown.err.empty() ? thrown.what() : thrown.err;
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  constexpr std::size_t kLongest = 300;
  return text.substr(0, kLongest);
}

/// Calls `body`, whose OpenCV exceptions become errors.
template <class Body>
Result<void> guarded(const std::string& path, Body&& body) {
  try {
    body();
    return {};
  } catch (const cv::Exception& thrown) {
    return Error{Errc::unsupported, path + ": OpenCV cannot run this network: " + text_of(thrown) +
                                        "; export it with static sizes and opset 11"};
  } catch (const std::bad_alloc&) {
    return Error{Errc::no_memory, path + ": the memory does not suffice for this network"};
  } catch (const std::exception& thrown) {
    return Error{Errc::unsupported, path + ": OpenCV cannot read this network: " + thrown.what() +
                                        "; export it again"};
  }
}

}  // namespace

std::string size_text(const cv::Mat& output) {
  std::string text;
  for (int axis = 0; axis < output.dims; ++axis) {
    text += (axis == 0 ? "" : " x ") + std::to_string(output.size[axis]);
  }
  return text;
}

struct Engine::Net {
  cv::dnn::Net net;
};

Engine::Engine(OnnxFile file, std::vector<std::string> outputs)
    : file_(std::move(file)), outputs_(std::move(outputs)), net_(std::make_unique<Net>()) {}
Engine::Engine(Engine&&) noexcept = default;
Engine& Engine::operator=(Engine&&) noexcept = default;
Engine::~Engine() = default;

Result<Engine> Engine::open(const OnnxFile& file, const std::vector<std::string>& outputs) {
  const auto bytes = read_onnx(file, outputs);
  if (!bytes) return bytes.error();
  Engine engine(file, outputs);
  cv::dnn::Net& net = engine.net_->net;
  auto read = guarded(file.onnx_path, [&] {
    net = cv::dnn::readNetFromONNX(bytes->data(), bytes->size());
    net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  });
  if (!read) return read.error();
  return engine;
}

Result<std::vector<cv::Mat>> Engine::run(const cv::Mat& image, int threads) {
  std::vector<cv::Mat> outputs;
  auto ran = guarded(file_.onnx_path, [&] {
    const auto forward = [&](const cv::Range&) {
      net_->net.setInput(cv::dnn::blobFromImage(image), file_.input);
      net_->net.forward(outputs, std::vector<cv::String>(outputs_.begin(), outputs_.end()));
    };
    // Loops within a parallel loop of OpenCV run on the calling thread. This keeps a grant of fewer
    // threads without a change of the pool that other components use.
    if (threads < cv::getNumThreads()) {
      cv::parallel_for_(cv::Range(0, 1), forward);
    } else {
      forward(cv::Range(0, 1));
    }
  });
  if (!ran) return ran.error();
  if (outputs.size() != outputs_.size()) {
    return Error{Errc::invalid_data, file_.onnx_path + ": OpenCV gives another number of outputs"};
  }
  return outputs;
}

Result<void> Engine::check_finite(const cv::Mat& output, const std::string& name) const {
  if (cv::checkRange(output.reshape(1, 1))) return {};
  return Error{Errc::invalid_data, file_.onnx_path + ": the output '" + name +
                                       "' is not finite: train or export the network again"};
}

}  // namespace weft::inference
