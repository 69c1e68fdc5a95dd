// SPDX-License-Identifier: Apache-2.0
#include "common/inference/network.hpp"

#include <opencv2/dnn.hpp>
#include <utility>
#include <vector>

namespace weft::inference {
namespace {

constexpr double kGrey = 128.0;

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

/// The length of each axis, as "1 x 6 x 30 x 40".
std::string size_text(const cv::Mat& output) {
  std::string text;
  for (int axis = 0; axis < output.dims; ++axis) {
    text += (axis == 0 ? "" : " x ") + std::to_string(output.size[axis]);
  }
  return text;
}

}  // namespace

struct Network::Engine {
  cv::dnn::Net net;

  std::vector<cv::Mat> forward(const cv::Mat& rgb, const NetworkFile& file) {
    net.setInput(cv::dnn::blobFromImage(rgb), file.input);
    std::vector<cv::Mat> outputs;
    net.forward(outputs, std::vector<cv::String>{file.cells.output, file.vertices.output});
    return outputs;
  }
};

Network::Network(NetworkFile file, std::unique_ptr<Engine> engine)
    : file_(std::move(file)), engine_(std::move(engine)) {}
Network::Network(Network&&) noexcept = default;
Network& Network::operator=(Network&&) noexcept = default;
Network::~Network() = default;

Result<void> Network::check(const std::string& path) {
  const auto file = read_network_file(path);
  if (!file) return file.error();
  const auto bytes = read_onnx(*file);
  return bytes ? Result<void>() : bytes.error();
}

Result<Network> Network::open(const std::string& path) {
  auto file = read_network_file(path);
  if (!file) return file.error();
  const auto bytes = read_onnx(*file);
  if (!bytes) return bytes.error();
  auto engine = std::make_unique<Engine>();
  auto read = guarded(file->onnx_path, [&] {
    engine->net = cv::dnn::readNetFromONNX(bytes->data(), bytes->size());
    engine->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    engine->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  });
  if (!read) return read.error();
  Network network(*std::move(file), std::move(engine));
  const cv::Mat grey(static_cast<int>(network.file_.camera.height_px),
                     static_cast<int>(network.file_.camera.width_px), CV_32FC3,
                     cv::Scalar::all(kGrey));
  if (const auto tried = network.run(grey, 1); !tried) return tried.error();
  return network;
}

Result<cv::Mat> Network::flattened(const cv::Mat& output, const std::string& name, int channels,
                                   int rows, int columns, bool is_grid) const {
  const bool fits = is_grid
                        ? output.dims == 4 && output.size[0] == 1 && output.size[1] == channels &&
                              output.size[2] == rows && output.size[3] == columns
                        : output.dims == 3 && output.size[0] == 1 && output.size[1] == channels &&
                              output.size[2] == rows * columns;
  if (!fits || output.type() != CV_32F) {
    const std::string expected = is_grid ? std::to_string(rows) + " x " + std::to_string(columns)
                                         : std::to_string(rows * columns);
    return Error{Errc::invalid_data, file_.onnx_path + ": the output '" + name + "' has the size " +
                                         size_text(output) + ", but " + file_.path +
                                         " describes 1 x " + std::to_string(channels) + " x " +
                                         expected + ": correct the yaml file"};
  }
  // A copy: OpenCV does not document that later calls leave earlier outputs as they are.
  const cv::Mat flat = output.reshape(1, channels).clone();
  if (!cv::checkRange(flat)) {
    return Error{Errc::invalid_data, file_.onnx_path + ": the output '" + name +
                                         "' is not finite: train the network again"};
  }
  return flat;
}

Result<NetworkMaps> Network::run(const cv::Mat& rgb, int threads) {
  std::vector<cv::Mat> outputs;
  auto ran = guarded(file_.onnx_path, [&] {
    const auto forward = [&](const cv::Range&) { outputs = engine_->forward(rgb, file_); };
    // Loops within a parallel loop of OpenCV run on the calling thread. This keeps a grant of fewer
    // threads without a change of the pool that other components use.
    if (threads < cv::getNumThreads()) {
      cv::parallel_for_(cv::Range(0, 1), forward);
    } else {
      forward(cv::Range(0, 1));
    }
  });
  if (!ran) return ran.error();
  const auto cells = flattened(outputs.at(0), file_.cells.output, NetworkMaps::kCellChannels,
                               file_.cells.rows, file_.cells.columns, true);
  if (!cells) return cells.error();
  const auto vertices =
      flattened(outputs.at(1), file_.vertices.output, NetworkMaps::kVertexChannels,
                file_.vertices.rows, file_.vertices.columns, false);
  if (!vertices) return vertices.error();
  return NetworkMaps{*cells, *vertices};
}

}  // namespace weft::inference
