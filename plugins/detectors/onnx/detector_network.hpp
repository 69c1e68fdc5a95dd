// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/inference/engine.hpp"
#include "detector_file.hpp"
#include "heat_map.hpp"

namespace weft::onnx {

/// A network of keypoints, and its answer for the last image.
class DetectorNetwork {
 public:
  /// Reads the file NAME.yaml and the ONNX file that it names. Runs the network once on a grey
  /// image and fails unless its outputs have the sizes of the file and are finite.
  static Result<DetectorNetwork> open(const std::string& path, inference::Runtime runtime);

  /// Reads and checks both files without running the network, for checks before a run.
  static Result<void> check(const std::string& path, inference::Runtime runtime);

  const DetectorFile& file() const { return file_; }

  /// `rgb` is f32 [height,width,3], 0 to 255. For the threads see inference::Engine::run().
  Result<void> run(const cv::Mat& rgb, int threads);

  /// Keypoints of at least this score in the last image, px of the network's image. A list without
  /// scores has the score 1. `list` is the place of each in the network's list; empty for a heat
  /// map.
  std::vector<Peak> keypoints(double threshold, std::vector<int>& list) const;

  /// The descriptors f32 or u8 [N,D] of keypoints of the last image. `list` as keypoints() gives
  /// it, for these keypoints.
  cv::Mat descriptors(const std::vector<cv::Point2d>& places_px,
                      const std::vector<int>& list) const;

 private:
  DetectorNetwork(DetectorFile file, std::unique_ptr<inference::Engine> engine);
  Result<void> check_outputs();
  Result<void> check_heat_map();
  Result<void> check_list();
  Error other_size(std::size_t output, const std::string& expected) const;
  Peak listed(int n) const;

  DetectorFile file_;
  std::unique_ptr<inference::Engine> engine_;
  std::vector<cv::Mat> outputs_;  ///< as file_.outputs()
  int step_px_ = 1;               ///< px of the image for each px of the heat map
};

}  // namespace weft::onnx
