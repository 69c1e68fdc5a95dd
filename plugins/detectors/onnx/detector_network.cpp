// SPDX-License-Identifier: Apache-2.0
#include "detector_network.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <weft/core/index.hpp>

#include "descriptors.hpp"

namespace weft::onnx {
namespace {

constexpr double kGrey = 128.0;
// Places in outputs().
constexpr std::size_t kDescriptors = 0, kHeatMap = 1, kKeypoints = 1, kScores = 2;

/// The step of a map over an image, if it is the same whole number along both axes; else 0.
int step_of(cv::Size image_px, int height, int width) {
  if (height < 1 || width < 1) return 0;
  const int step = image_px.width / width;
  return step >= 1 && step * width == image_px.width && step * height == image_px.height ? step : 0;
}

/// The output [1,N,D] or [N,D] as [N,D]; empty if it has another size.
cv::Mat as_rows(const cv::Mat& output) {
  if (output.dims == 2) return output;
  if (output.dims != 3 || output.size[0] != 1) return {};
  if (output.empty()) return cv::Mat(output.size[1], output.size[2], CV_32F);
  return output.reshape(1, output.size[1]);
}

}  // namespace

DetectorNetwork::DetectorNetwork(DetectorFile file, std::unique_ptr<inference::Engine> engine)
    : file_(std::move(file)), engine_(std::move(engine)) {}

Result<void> DetectorNetwork::check(const std::string& path, inference::Runtime runtime) {
  const auto file = read_detector_file(path);
  if (!file) return file.error();
  const auto bytes = inference::read_onnx(*file, file->outputs(), runtime);
  return bytes ? Result<void>() : bytes.error();
}

Result<DetectorNetwork> DetectorNetwork::open(const std::string& path, inference::Runtime runtime) {
  auto file = read_detector_file(path);
  if (!file) return file.error();
  auto engine = inference::Engine::open(*file, file->outputs(), runtime);
  if (!engine) return engine.error();
  DetectorNetwork network(*std::move(file), *std::move(engine));
  const cv::Mat grey(network.file_.image.size_px, CV_32FC3, cv::Scalar::all(kGrey));
  if (auto tried = network.run(grey, 1); !tried) return tried.error();
  return network;
}

Result<void> DetectorNetwork::run(const cv::Mat& rgb, int threads) {
  cv::Mat image = rgb;
  if (file_.image.is_grey) cv::cvtColor(rgb, image, cv::COLOR_RGB2GRAY);
  cv::Mat values;
  image.convertTo(values, CV_32F, file_.image.scale, file_.image.offset);
  auto outputs = engine_->run(values, threads);
  if (!outputs) return outputs.error();
  outputs_ = *std::move(outputs);
  return check_outputs();
}

Error DetectorNetwork::other_size(std::size_t output, const std::string& expected) const {
  return {Errc::invalid_data, file_.onnx_path + ": the output '" + file_.outputs()[output] +
                                  "' has the size " + inference::size_text(outputs_[output]) +
                                  ", but " + file_.path + " describes " + expected +
                                  ": correct the yaml file, or export the network with this size"};
}

Result<void> DetectorNetwork::check_outputs() {
  const std::vector<std::string> names = file_.outputs();
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    if (outputs_[i].type() != CV_32F) {
      return Error{Errc::unsupported, file_.onnx_path + ": the output '" + names[i] +
                                          "' is not of type float32: export it as float32"};
    }
  }
  auto sized = file_.heat_map ? check_heat_map() : check_list();
  if (!sized) return sized;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    if (auto finite = inference::check_finite(file_, outputs_[i], names[i]); !finite) return finite;
  }
  return {};
}

Result<void> DetectorNetwork::check_heat_map() {
  const cv::Size image_px = file_.image.size_px;
  cv::Mat& scores = outputs_[kHeatMap];
  const bool has_channel = scores.dims == 4 && scores.size[1] == 1;
  if (!(has_channel || scores.dims == 3) || scores.size[0] != 1) {
    return other_size(kHeatMap, "a map of 1 x 1 x h x w scores");
  }
  const int height = scores.size[scores.dims - 2], width = scores.size[scores.dims - 1];
  step_px_ = step_of(image_px, height, width);
  const std::string parts = "h x w that divide the image of " + std::to_string(image_px.height) +
                            " x " + std::to_string(image_px.width) + " px alike";
  if (step_px_ == 0) return other_size(kHeatMap, "a map 1 x 1 x h x w, " + parts);
  const cv::Mat& map = outputs_[kDescriptors];
  if (map.dims != 4 || map.size[0] != 1 || map.size[1] < 1 ||
      step_of(image_px, map.size[2], map.size[3]) == 0) {
    return other_size(kDescriptors, "a map 1 x D x h x w of descriptors, " + parts);
  }
  scores = scores.reshape(1, height);
  return {};
}

Result<void> DetectorNetwork::check_list() {
  const cv::Mat keypoints = as_rows(outputs_[kKeypoints]);
  if (keypoints.cols != 2) return other_size(kKeypoints, "1 x N x 2 keypoints");
  const std::string count = std::to_string(keypoints.rows);
  const cv::Mat descriptors = as_rows(outputs_[kDescriptors]);
  if (descriptors.rows != keypoints.rows || descriptors.cols < 1) {
    return other_size(kDescriptors, "1 x " + count + " x D descriptors of as many keypoints");
  }
  if (outputs_.size() > kScores) {
    cv::Mat& scores = outputs_[kScores];
    const bool is_list = scores.dims == 2 && std::min(scores.rows, scores.cols) <= 1;
    if (!is_list || static_cast<int>(scores.total()) != keypoints.rows) {
      return other_size(kScores, "1 x " + count + " scores of as many keypoints");
    }
    if (!scores.empty()) scores = scores.reshape(1, keypoints.rows);
  }
  outputs_[kKeypoints] = keypoints;
  outputs_[kDescriptors] = descriptors;
  return {};
}

Peak DetectorNetwork::listed(int n) const {
  const KeypointsOutput& list = file_.keypoints;
  const auto* pair = outputs_[kKeypoints].ptr<float>(n);
  double place[] = {pair[list.is_yx ? 1 : 0], pair[list.is_yx ? 0 : 1]};
  const int size_px[] = {file_.image.size_px.width, file_.image.size_px.height};
  for (int axis = 0; axis < 2; ++axis) {
    if (list.is_normalised) {
      const int span_px = size_px[axis] - (list.is_at_halves ? 0 : 1);
      place[axis] = 0.5 * (place[axis] + 1.0) * span_px;
    }
    if (list.is_at_halves) place[axis] -= 0.5;
  }
  const bool has_scores = !list.scores.empty();
  return {place[0], place[1], has_scores ? outputs_[kScores].at<float>(n) : 1.0F};
}

std::vector<Peak> DetectorNetwork::keypoints(double threshold, std::vector<int>& list) const {
  list.clear();
  if (file_.heat_map) {
    auto peaks = find_peaks(outputs_[kHeatMap], threshold, file_.heat_map->nms_px,
                            file_.heat_map->border_px);
    const double centre_px = 0.5 * (step_px_ - 1);
    for (Peak& peak : peaks) {
      peak.x_px = step_px_ * peak.x_px + centre_px;
      peak.y_px = step_px_ * peak.y_px + centre_px;
    }
    return peaks;
  }
  std::vector<Peak> peaks;
  for (int n = 0; n < outputs_[kKeypoints].rows; ++n) {
    const Peak peak = listed(n);
    const bool is_kept =
        file_.keypoints.scores.empty() || static_cast<double>(peak.score) >= threshold;
    if (!is_kept) continue;
    peaks.push_back(peak);
    list.push_back(n);
  }
  return peaks;
}

cv::Mat DetectorNetwork::descriptors(const std::vector<cv::Point2d>& places_px,
                                     const std::vector<int>& list) const {
  const DescriptorsOutput& kind = file_.descriptors;
  const cv::Mat& output = outputs_[kDescriptors];
  cv::Mat found;
  if (file_.heat_map) {
    found = sample(output, places_px, file_.image.size_px, kind.align_corners);
  } else {
    found.create(static_cast<int>(list.size()), output.cols, CV_32F);
    for (int n = 0; n < found.rows; ++n) output.row(list[to_index(n)]).copyTo(found.row(n));
  }
  if (kind.is_normalised) normalise_rows(found);
  return kind.is_binary ? signs(found) : found;
}

}  // namespace weft::onnx
