// SPDX-License-Identifier: Apache-2.0
#include "common/inference/network.hpp"

#include <utility>
#include <vector>

namespace weft::inference {
namespace {

constexpr double kGrey = 128.0;

}  // namespace

Network::Network(NetworkFile file, std::unique_ptr<Engine> engine)
    : file_(std::move(file)), engine_(std::move(engine)) {}

Result<void> Network::check(const std::string& path, Runtime runtime) {
  const auto file = read_network_file(path);
  if (!file) return file.error();
  const auto bytes = read_onnx(*file, file->outputs(), runtime);
  return bytes ? Result<void>() : bytes.error();
}

Result<Network> Network::open(const std::string& path, Runtime runtime) {
  auto file = read_network_file(path);
  if (!file) return file.error();
  auto engine = Engine::open(*file, file->outputs(), runtime);
  if (!engine) return engine.error();
  Network network(*std::move(file), *std::move(engine));
  const cv::Mat grey(static_cast<int>(network.file_.camera.height_px) + network.file_.texture_px,
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
  if (auto finite = check_finite(file_, output, name); !finite) return finite.error();
  // A copy: OpenCV does not document that later calls leave earlier outputs as they are.
  return output.reshape(1, channels).clone();
}

Result<NetworkMaps> Network::run(const cv::Mat& rgb, int threads) {
  const auto outputs = engine_->run(rgb, threads);
  if (!outputs) return outputs.error();
  const auto cells = flattened(outputs->at(0), file_.cells.output, NetworkMaps::kCellChannels,
                               file_.cells.rows, file_.cells.columns, true);
  if (!cells) return cells.error();
  if (file_.is_for_any_texture()) return NetworkMaps{*cells, {}};
  const auto vertices =
      flattened(outputs->at(1), file_.vertices.output, NetworkMaps::kVertexChannels,
                file_.vertices.rows, file_.vertices.columns, false);
  if (!vertices) return vertices.error();
  return NetworkMaps{*cells, *vertices};
}

}  // namespace weft::inference
