// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <sstream>
#include <string>
#include <vector>
#include <weft/core/index.hpp>

#include "common/inference/hash.hpp"
#include "common/inference/tests/onnx_writer.hpp"
#include "common/inference/tests/test_network.hpp"

/// Networks of keypoints whose answer is known by construction.
namespace weft::onnx::testing {

using inference::testing::f32_tensor;
using inference::testing::OnnxModel;
using inference::testing::OnnxNode;
using inference::testing::TestFolder;

inline std::uint64_t length(auto count) { return static_cast<std::uint64_t>(count); }

inline OnnxNode convolution(const std::string& name, const std::string& to, std::int64_t side,
                            std::int64_t stride, std::int64_t pad) {
  return {"Conv",
          {"image", name, name + "_bias"},
          {to},
          {{"kernel_shape", {side, side}},
           {"strides", {stride, stride}},
           {"pads", {pad, pad, pad, pad}},
           {"dilations", {1, 1}}},
          {{"group", 1}}};
}

/// The part of the yaml file that all kinds share.
struct TestImage {
  int width_px = 160, height_px = 120, channels = 1;
  double scale = 1.0 / 255.0, offset = 0.0;

  inference::testing::OnnxValue input() const {
    return {"image", {1, length(channels), length(height_px), length(width_px)}};
  }
  std::string yaml(const std::string& onnx_hash) const {
    std::ostringstream text;
    text.precision(17);
    text << "weft_network: 1\nkind: detector\nonnx: net.onnx\nonnx_hash: " << onnx_hash
         << "\nimage: {input: image, width_px: " << width_px << ", height_px: " << height_px
         << ", colours: " << (channels == 1 ? "grey" : "rgb") << ", scale: " << scale
         << ", offset: " << offset << "}\n";
    return text.str();
  }
};

/// Writes net.onnx and net.yaml; returns the path of the latter.
inline std::string write(const TestFolder& folder, const TestImage& image, const std::string& rest,
                         const std::string& onnx) {
  using inference::testing::write_file;
  write_file(folder.file("net.onnx"), onnx);
  write_file(folder.file("net.yaml"), image.yaml(inference::hash_of(onnx)) + rest);
  return folder.file("net.yaml");
}

/// A network with maps. The scores are a convolution with a kernel of 5 x 5, by default
/// 0.8 - 0.2 r^2 at the distance r from its centre. A white pixel on black then has the score 0.8,
/// and its neighbours lie on a paraboloid. The descriptors are `maps` plus a convolution of cells
/// of 4 px with `from_image`.
struct TestMaps {
  static constexpr int kSide = 5, kStep = 4;
  TestImage image{};
  std::vector<float> kernel{};      ///< [C,5,5]; the default for all channels where empty
  int dims = 3;                     ///< D of the descriptors
  std::vector<float> from_image{};  ///< [D,C,4,4]; zeros where empty
  std::vector<float> maps{};        ///< [D,rows,columns]; zeros where empty
  std::string heat_map = "{output: scores, nms_px: 2, border_px: 4}";
  std::string descriptors = "{output: descriptors, metric: l2, normalise: false}";

  int columns() const { return image.width_px / kStep; }
  int rows() const { return image.height_px / kStep; }
  float& map(int channel, int row, int column) {
    maps.resize(to_index(dims * rows() * columns()));
    return maps[to_index((channel * rows() + row) * columns() + column)];
  }
  /// Lets the channels 0 and 1 of the descriptors be the column and the row of their cell, and 2 a
  /// constant.
  void describe_places() {
    for (int i = 0; i < rows(); ++i) {
      for (int j = 0; j < columns(); ++j) {
        map(0, i, j) = static_cast<float>(j);
        map(1, i, j) = static_cast<float>(i);
        map(2, i, j) = -5.0F;
      }
    }
  }

  std::vector<float> full_kernel() const {
    if (!kernel.empty()) return kernel;
    std::vector<float> full;
    for (int i = 0; i < image.channels * kSide * kSide; ++i) {
      const int x = i % kSide - 2, y = i / kSide % kSide - 2;
      full.push_back(0.8F - 0.2F * static_cast<float>(x * x + y * y));
    }
    return full;
  }

  OnnxModel model() const {
    const std::uint64_t c = length(image.channels), d = length(dims);
    std::vector<float> weights = from_image, all_maps = maps;
    weights.resize(to_index(dims * image.channels * kStep * kStep));
    all_maps.resize(to_index(dims * rows() * columns()));
    OnnxModel made;
    made.inputs = {image.input()};
    made.outputs = {{"scores", {1, 1, length(image.height_px), length(image.width_px)}},
                    {"descriptors", {1, d, length(rows()), length(columns())}}};
    made.tensors = {f32_tensor("kernel", {1, c, kSide, kSide}, full_kernel()),
                    f32_tensor("kernel_bias", {1}, {0.0F}),
                    f32_tensor("weights", {d, c, kStep, kStep}, weights),
                    f32_tensor("weights_bias", {d}, std::vector<float>(d)),
                    f32_tensor("maps", {1, d, length(rows()), length(columns())}, all_maps)};
    made.nodes = {convolution("kernel", "scores", kSide, 1, kSide / 2),
                  convolution("weights", "means", kStep, kStep, 0),
                  {"Add", {"means", "maps"}, {"descriptors"}}};
    return made;
  }
  std::string rest() const {
    return "heat_map: " + heat_map + "\ndescriptors: " + descriptors + "\nlicence: Apache-2.0\n";
  }
  std::string write(const TestFolder& folder) const { return write(folder, model()); }
  std::string write(const TestFolder& folder, const OnnxModel& other) const {
    return testing::write(folder, image, rest(), other.bytes());
  }
};

/// A network that answers a list whatever it sees: keypoints [1,N,2], scores [1,N] and descriptors
/// [1,N,D].
struct TestList {
  TestImage image{};
  std::vector<float> keypoints{}, scores{}, descriptors{};
  std::string kind = "units: px, order: xy, centres: integers";
  std::string metric = "l2, normalise: false";
  bool has_scores = true;

  int count() const { return static_cast<int>(scores.size()); }

  OnnxModel model() const {
    constexpr std::int64_t kStride = 32;
    const auto sampled = [](int px) { return length((px - 1) / kStride + 1); };
    const std::uint64_t samples = sampled(image.width_px) * sampled(image.height_px);
    const std::int64_t n = count(), d = static_cast<std::int64_t>(descriptors.size()) / n;
    OnnxModel made;
    made.inputs = {image.input()};
    made.tensors = {f32_tensor("sampler", {1, length(image.channels), 1, 1},
                               std::vector<float>(to_index(image.channels))),
                    f32_tensor("sampler_bias", {1}, {0.0F})};
    made.nodes = {convolution("sampler", "samples", 1, kStride, 0),
                  {"Flatten", {"samples"}, {"flat"}, {}, {{"axis", 1}}}};
    const auto add = [&](const std::string& name, const std::vector<float>& values,
                         const std::vector<std::int64_t>& shape) {
      const std::uint64_t size = values.size();
      made.outputs.push_back({name, std::vector<std::uint64_t>(shape.begin(), shape.end())});
      made.tensors.push_back(
          f32_tensor(name + "_weights", {size, samples}, std::vector<float>(size * samples)));
      made.tensors.push_back(f32_tensor(name + "_values", {size}, values));
      made.tensors.push_back(inference::testing::i64_tensor(name + "_shape", shape));
      made.nodes.push_back({"Gemm",
                            {"flat", name + "_weights", name + "_values"},
                            {name + "_row"},
                            {},
                            {{"transB", 1}}});
      made.nodes.push_back({"Reshape", {name + "_row", name + "_shape"}, {name}});
    };
    add("keypoints", keypoints, {1, n, 2});
    add("scores", scores, {1, n});
    add("descriptors", descriptors, {1, n, d});
    return made;
  }
  std::string rest() const {
    return "keypoints: {output: keypoints, " + kind + "}\n" +
           (has_scores ? "scores: {output: scores}\n" : "") +
           "descriptors: {output: descriptors, metric: " + metric + "}\n";
  }
  std::string write(const TestFolder& folder) const { return write(folder, model()); }
  std::string write(const TestFolder& folder, const OnnxModel& other) const {
    return testing::write(folder, image, rest(), other.bytes());
  }
};

}  // namespace weft::onnx::testing
