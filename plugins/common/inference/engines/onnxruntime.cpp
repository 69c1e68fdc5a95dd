// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <limits>
#include <opencv2/dnn.hpp>
#include <utility>

#include "common/inference/engines/engines.hpp"
#include "common/inference/engines/onnxruntime_api.hpp"

namespace weft::inference {
namespace {

constexpr std::size_t kMostOutputAxes = 32;  // cv::Mat has no more

class OnnxRuntimeEngine final : public Engine {
 public:
  OnnxRuntimeEngine(ort::Api api, OnnxFile file, const std::vector<std::string>& outputs,
                    std::string bytes)
      : api_(api), file_(std::move(file)), outputs_(outputs), bytes_(std::move(bytes)) {}

  /// Loads the network unless it is loaded for this number of threads.
  Result<void> load(int threads) {
    threads = std::max(threads, 1);
    if (session_ && threads == threads_) return {};
    session_.reset();
    if (!env_) {
      // The log is silent, because each failed call has a message.
      if (auto made = make(env_, ort::kReleaseEnv, ort::kCreateEnv, ort::kFatal, "weft"); !made) {
        return made;
      }
      if (auto off = call(ort::kDisableTelemetry, env_.get()); !off) return off;
    }
    ort::Owned<ort::Options> options;
    if (auto made = make(options, ort::kReleaseOptions, ort::kCreateOptions); !made) return made;
    if (auto set = call(ort::kSetThreads, options.get(), threads); !set) return set;
    // Waiting threads do not spin, because the host grants the cores to other components.
    if (auto set = call(ort::kAddOption, options.get(), "session.intra_op.allow_spinning", "0");
        !set) {
      return set;
    }
    threads_ = threads;
    return make(session_, ort::kReleaseSession, ort::kCreateSession, env_.get(), bytes_.data(),
                bytes_.size(), options.get());
  }

  Result<std::vector<cv::Mat>> run(const cv::Mat& image, int threads) override {
    if (auto loaded = load(threads); !loaded) return loaded.error();
    cv::Mat blob = cv::dnn::blobFromImage(image);
    const std::vector<std::int64_t> shape(blob.size.p, blob.size.p + blob.dims);
    ort::Owned<ort::MemoryInfo> memory;
    if (auto made = make(memory, ort::kReleaseMemoryInfo, ort::kCreateMemoryInfo, ort::kArena,
                         ort::kDefaultMemory);
        !made) {
      return made.error();
    }
    ort::Owned<ort::Value> input;
    if (auto made = make(input, ort::kReleaseValue, ort::kCreateTensor, memory.get(), blob.data,
                         blob.total() * blob.elemSize(), shape.data(), shape.size(), ort::kFloat);
        !made) {
      return made.error();
    }
    const char* input_name = file_.input.c_str();
    const ort::Value* inputs = input.get();
    std::vector<const char*> names;
    for (const std::string& name : outputs_) names.push_back(name.c_str());
    std::vector<ort::Value*> values(names.size(), nullptr);
    auto ran = call(ort::kRun, session_.get(), nullptr, &input_name, &inputs, std::size_t{1},
                    names.data(), names.size(), values.data());
    std::vector<ort::Owned<ort::Value>> owned;
    for (ort::Value* value : values) owned.push_back(api_.own(value, ort::kReleaseValue));
    if (!ran) return ran.error();
    std::vector<cv::Mat> outputs;
    for (std::size_t i = 0; i < values.size(); ++i) {
      auto output = copy(values[i], outputs_[i]);
      if (!output) return output.error();
      outputs.push_back(*std::move(output));
    }
    return outputs;
  }

 private:
  template <class Function, class... Arguments>
  Result<void> call(ort::Slot<Function> slot, Arguments... arguments) const {
    const std::string problem = api_.failure(api_[slot](arguments...));
    if (problem.empty()) return {};
    return Error{Errc::unsupported,
                 file_.onnx_path + ": ONNX Runtime cannot run this network: " + problem};
  }

  /// Calls a function whose last argument receives a new object.
  template <class Object, class Function, class... Arguments>
  Result<void> make(ort::Owned<Object>& object, ort::Slot<void(Object*)> release,
                    ort::Slot<Function> slot, Arguments... arguments) const {
    Object* made = nullptr;
    auto called = call(slot, arguments..., &made);
    if (called) object = api_.own(made, release);
    return called;
  }

  Result<cv::Mat> copy(ort::Value* value, const std::string& name) const {
    ort::Owned<ort::TensorInfo> info;
    if (auto made = make(info, ort::kReleaseTensorInfo, ort::kTensorInfo, value); !made) {
      return made.error();
    }
    int type = 0;
    std::size_t axes = 0;
    void* data = nullptr;
    if (auto got = call(ort::kElementType, info.get(), &type); !got) return got.error();
    if (auto got = call(ort::kAxisCount, info.get(), &axes); !got) return got.error();
    const std::string which = file_.onnx_path + ": the output '" + name + "' ";
    if (type != ort::kFloat) {
      return Error{Errc::unsupported, which + "is not of type float32: export it as float32"};
    }
    if (axes > kMostOutputAxes) return Error{Errc::unsupported, which + "has too many axes"};
    std::vector<std::int64_t> shape(axes);
    if (auto got = call(ort::kShape, info.get(), shape.data(), axes); !got) return got.error();
    if (auto got = call(ort::kTensorData, value, &data); !got) return got.error();
    std::vector<int> sizes;
    for (const std::int64_t size : shape) {
      if (size < 0 || size > std::numeric_limits<int>::max()) {
        return Error{Errc::unsupported, which + "is too large"};
      }
      sizes.push_back(static_cast<int>(size));
    }
    sizes.resize(std::max<std::size_t>(axes, 2), 1);  // OpenCV has no matrices of fewer axes
    cv::Mat output(sizes, CV_32F);
    if (!output.empty()) std::memcpy(output.data, data, output.total() * output.elemSize());
    return output;
  }

  ort::Api api_;
  OnnxFile file_;
  std::vector<std::string> outputs_;
  std::string bytes_;
  int threads_ = 0;
  ort::Owned<ort::Env> env_;
  ort::Owned<ort::Session> session_;  // released before env_
};

}  // namespace

Result<void> check_onnxruntime() {
  const auto api = ort::Api::open();
  return api ? Result<void>() : api.error();
}

Result<std::unique_ptr<Engine>> open_onnxruntime(const OnnxFile& file,
                                                 const std::vector<std::string>& outputs,
                                                 std::string bytes) {
  const auto api = ort::Api::open();
  if (!api) return api.error();
  auto engine = std::make_unique<OnnxRuntimeEngine>(*api, file, outputs, std::move(bytes));
  if (auto loaded = engine->load(1); !loaded) return loaded.error();
  return std::unique_ptr<Engine>(std::move(engine));
}

}  // namespace weft::inference
