// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/inference/onnx_file.hpp"

namespace weft::onnx {

/// The image that a network of keypoints takes: [1,C,height,width], each value
/// scale * grey level + offset.
struct NetworkImage {
  cv::Size size_px{};
  bool is_grey = false;  ///< one channel, else red, green and blue
  double scale = 1.0, offset = 0.0;
};

/// A score for each pixel of a map; its maxima are the keypoints.
struct HeatMapOutput {
  std::string name{};
  int nms_px = 2;     ///< px of the map, radius in which only the largest score is kept
  int border_px = 4;  ///< px of the map, width of the border without keypoints
};

/// A list of keypoints.
struct KeypointsOutput {
  std::string name{};
  std::string scores{};        ///< name of the output of the scores; empty if there is none
  bool is_normalised = false;  ///< from -1 to 1 over the image, else px
  bool is_yx = false;          ///< y before x
  bool is_at_halves = false;   ///< the centre of the first pixel is (0.5, 0.5), else (0, 0)
};

/// Descriptors of the keypoints of a list, or a map of them over the image.
struct DescriptorsOutput {
  std::string name{};
  bool is_binary = false;      ///< bits are the signs of the numbers
  bool is_normalised = false;  ///< each descriptor is divided by its length
  bool align_corners = false;  ///< the corner pixels of map and image coincide, else their edges
};

/// The contents of a network file of kind detector.
struct DetectorFile : inference::OnnxFile {
  NetworkImage image{};
  std::optional<HeatMapOutput> heat_map{};  ///< either this
  KeypointsOutput keypoints{};              ///< or this is used
  DescriptorsOutput descriptors{};

  /// The descriptors, the heat map or the keypoints, and the scores of a list where it has them.
  std::vector<std::string> outputs() const;
};

/// Reads and checks a network file. An error has the place in the file and the correction.
Result<DetectorFile> read_detector_file(const std::string& path);

}  // namespace weft::onnx
