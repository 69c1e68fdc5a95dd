// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "common/inference/engine.hpp"
#include "common/inference/network_file.hpp"

namespace weft::inference {

/// The output of a network for one image.
///
/// Channels of `cells`:
/// - 0: logit of the mask
/// - 1, 2: u = x / width_m and v = y / height_m of the template
/// - 3: natural logarithm of the expected error of (x, y) as a share of width_m
/// - 4: logarithm of the depth in m
/// - 5: logarithm of the expected error of channel 4
///
/// A network for any texture has the side of the texture's square as its unit of x, y and depth.
///
/// Channels of `vertices`: X/Z, Y/Z and ln Z (Z in m) in the camera frame. A network for any
/// texture has none.
struct NetworkMaps {
  static constexpr int kCellChannels = 6, kVertexChannels = 3;
  cv::Mat cells;     ///< f32 [6, rows * columns], cells row by row
  cv::Mat vertices;  ///< f32 [3, rows * columns], nodes row by row
};

/// A network that runs on the processor.
class Network {
 public:
  /// Reads the file NAME.yaml and the ONNX file that it names. Runs the network once on a grey
  /// image and fails unless its outputs have the sizes of the file and are finite.
  static Result<Network> open(const std::string& path, Runtime runtime = Runtime::opencv);

  /// Reads and checks both files without running the network, for checks before a run.
  static Result<void> check(const std::string& path, Runtime runtime = Runtime::opencv);

  const NetworkFile& file() const { return file_; }

  /// `rgb` is f32 [height + texture_px,width,3], 0 to 255. For the threads see Engine::run().
  Result<NetworkMaps> run(const cv::Mat& rgb, int threads);

 private:
  Network(NetworkFile file, std::unique_ptr<Engine> engine);
  Result<cv::Mat> flattened(const cv::Mat& output, const std::string& name, int channels, int rows,
                            int columns, bool is_grid) const;

  NetworkFile file_;
  std::unique_ptr<Engine> engine_;
};

}  // namespace weft::inference
