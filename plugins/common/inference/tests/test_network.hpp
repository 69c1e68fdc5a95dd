// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdlib.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/camera.hpp>

#include "common/inference/hash.hpp"
#include "common/inference/tests/onnx_writer.hpp"

namespace weft::inference::testing {

/// A folder that lives as long as the object.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "weft_net_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
    path_ = name;
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// Sets an environment variable until the end of a scope.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Variable() {
    if (before_.empty()) {
      unsetenv(name_);
    } else {
      setenv(name_, before_.c_str(), 1);
    }
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::string before_;
};

inline void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A network whose answer is `cells` and `vertices`, whatever it sees, plus `from_rgb` times the
/// mean colour of each cell. A network for any texture takes this colour from the texture's cells.
struct TestNetwork {
  Camera camera{205.0, 205.0, 79.5, 59.5, 160, 120};
  int step_px = 4;
  int grid_columns = 10, grid_rows = 7;
  double width_m = 0.297, height_m = 0.178;
  std::string texture_hash = "0123456789abcdef";
  double uv_error_factor = 1.0;
  int texture_px = 0;                    ///< 0: a network for one template; else the image's height
  std::array<float, 18> from_rgb{};      ///< [6,3] of each channel of the cells
  std::vector<float> cells, vertices{};  ///< [6,R,C] and [3,V]; zeros where empty

  int columns() const { return static_cast<int>(camera.width_px) / step_px; }
  int rows() const { return static_cast<int>(camera.height_px) / step_px; }
  int cell_count() const { return columns() * rows(); }
  int node_count() const { return grid_columns * grid_rows; }
  float& cell(int channel, int row, int column) {
    cells.resize(to_index(6 * cell_count()));
    return cells[to_index((channel * rows() + row) * columns() + column)];
  }
  float& node(int channel, int row, int column) {
    vertices.resize(to_index(3 * node_count()));
    return vertices[to_index((channel * grid_rows + row) * grid_columns + column)];
  }

  OnnxModel model() const {
    const auto size = [](auto count) { return static_cast<std::uint64_t>(count); };
    const std::uint64_t step = size(step_px), nodes = size(3 * node_count());
    std::vector<float> kernel(18 * step * step), all_cells = cells, all_nodes = vertices;
    for (std::size_t i = 0; i < kernel.size(); ++i) {
      kernel[i] = from_rgb[i / (step * step)] / static_cast<float>(step * step);
    }
    all_cells.resize(to_index(6 * cell_count()));
    all_nodes.resize(nodes);
    constexpr std::int64_t kStride = 32;
    const auto sampled = [](std::int64_t px) { return size_t((px - 1) / kStride + 1); };
    const std::uint64_t samples = sampled(camera.width_px) * sampled(camera.height_px);
    OnnxModel made;
    made.inputs = {{"image", {1, 3, size(camera.height_px + texture_px), size(camera.width_px)}}};
    made.outputs = {{"cells", {1, 6, size(rows()), size(columns())}},
                    {"vertices", {1, 3, size(node_count())}}};
    made.tensors = {f32_tensor("kernel", {6, 3, step, step}, kernel),
                    f32_tensor("kernel_bias", {6}, std::vector<float>(6)),
                    f32_tensor("maps", {1, 6, size(rows()), size(columns())}, all_cells),
                    f32_tensor("sampler", {1, 3, 1, 1}, std::vector<float>(3)),
                    f32_tensor("sampler_bias", {1}, {0.0F}),
                    f32_tensor("weights", {nodes, samples}, std::vector<float>(nodes * samples)),
                    f32_tensor("nodes", {nodes}, all_nodes),
                    i64_tensor("shape", {1, 3, node_count()})};
    const std::int64_t s = step_px;
    made.nodes = {{"Conv",
                   {"image", "kernel", "kernel_bias"},
                   {"means"},
                   {{"kernel_shape", {s, s}},
                    {"strides", {s, s}},
                    {"pads", {0, 0, 0, 0}},
                    {"dilations", {1, 1}}},
                   {{"group", 1}}},
                  {"Add", {"means", "maps"}, {"cells"}},
                  {"Conv",
                   {"image", "sampler", "sampler_bias"},
                   {"samples"},
                   {{"kernel_shape", {1, 1}},
                    {"strides", {kStride, kStride}},
                    {"pads", {0, 0, 0, 0}},
                    {"dilations", {1, 1}}},
                   {{"group", 1}}},
                  {"Flatten", {"samples"}, {"flat"}, {}, {{"axis", 1}}},
                  {"Gemm", {"flat", "weights", "nodes"}, {"listed"}, {}, {{"transB", 1}}},
                  {"Reshape", {"listed", "shape"}, {"vertices"}}};
    if (texture_px > 0) {
      made.outputs.pop_back();
      made.nodes.resize(2);  // those of the cells
      made.nodes[1].inputs[0] = "below";
      made.nodes.insert(made.nodes.begin() + 1,
                        {"Slice", {"means", "from", "to", "axis"}, {"below"}});
      for (const auto& [name, value] :
           {std::pair{"from", rows()}, {"to", 2 * rows()}, {"axis", 2}}) {
        made.tensors.push_back(i64_tensor(name, {value}));
      }
    }
    return made;
  }

  std::string yaml(const std::string& onnx_hash) const {
    std::ostringstream text;
    text.precision(17);
    text << "weft_network: 1\nkind: registration\nonnx: net.onnx\nonnx_hash: " << onnx_hash
         << "\nimage: {input: image, width_px: " << camera.width_px
         << ", height_px: " << camera.height_px << ", colours: rgb}\ncamera: {fx: " << camera.fx
         << ", fy: " << camera.fy << ", cx: " << camera.cx << ", cy: " << camera.cy
         << "}\ncells: {output: cells, step_px: " << step_px << ", columns: " << columns()
         << ", rows: " << rows();
    if (texture_px > 0) {
      text << "}\ntexture: {side_px: " << texture_px;
    } else {
      text << "}\nvertices: {output: vertices, columns: " << grid_columns << ", rows: " << grid_rows
           << "}\ntemplate: {width_m: " << width_m << ", height_m: " << height_m
           << ", texture_hash: " << texture_hash;
    }
    text << "}\nuv_error_factor: " << uv_error_factor
         << "\ntraining: {seed: 1}\nlicence: Apache-2.0\n";
    return text.str();
  }

  /// Writes net.onnx and net.yaml; returns the path of the latter.
  std::string write(const TestFolder& folder) const { return write(folder, model().bytes()); }
  std::string write(const TestFolder& folder, const std::string& onnx) const {
    write_file(folder.file("net.onnx"), onnx);
    write_file(folder.file("net.yaml"), yaml(hash_of(onnx)));
    return folder.file("net.yaml");
  }
};

/// A point of a surface, m, camera frame, from the shares of width and height.
using Surface = std::function<Eigen::Vector3d(double u, double v)>;

inline Eigen::Vector2d pixel_of(const Camera& camera, const Eigen::Vector3d& point_m) {
  return {camera.fx * point_m.x() / point_m.z() + camera.cx,
          camera.fy * point_m.y() / point_m.z() + camera.cy};
}

/// The shares (u, v) of the point that a pixel shows, by Newton's method from the nearest of a grid
/// of points. The surface must not fold in the image.
inline Eigen::Vector2d shares_at(const Surface& surface, const Camera& camera,
                                 const Eigen::Vector2d& place_px) {
  const auto pixel = [&](const Eigen::Vector2d& uv) {
    return pixel_of(camera, surface(uv.x(), uv.y()));
  };
  Eigen::Vector2d uv(0.5, 0.5);
  double nearest_px = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 441; ++k) {
    const Eigen::Vector2d tried(k % 21 / 20.0, k / 21 / 20.0);
    const double off_px = (pixel(tried) - place_px).norm();
    if (off_px >= nearest_px) continue;
    nearest_px = off_px;
    uv = tried;
  }
  for (int step = 0; step < 12; ++step) {
    constexpr double kStep = 1e-5;
    Eigen::Matrix2d jacobian;
    jacobian.col(0) = (pixel(uv + Eigen::Vector2d(kStep, 0)) - pixel(uv)) / kStep;
    jacobian.col(1) = (pixel(uv + Eigen::Vector2d(0, kStep)) - pixel(uv)) / kStep;
    uv -= jacobian.fullPivLu().solve(pixel(uv) - place_px);
  }
  return uv;
}

/// Lets the network answer a surface: exact uv and depth where a cell's centre shows it, a mask
/// logit of 6 there and -6 elsewhere, and the exact nodes.
inline void show(const Surface& surface, double error_share, TestNetwork& network) {
  const double centre_px = 0.5 * (network.step_px - 1);
  for (int i = 0; i < network.rows(); ++i) {
    for (int j = 0; j < network.columns(); ++j) {
      const Eigen::Vector2d uv =
          shares_at(surface, network.camera,
                    {network.step_px * j + centre_px, network.step_px * i + centre_px});
      const bool is_seen = uv.minCoeff() >= 0.0 && uv.maxCoeff() <= 1.0;
      const double z_m = is_seen ? surface(uv.x(), uv.y()).z() : 1.0;
      const double values[] = {is_seen ? 6.0 : -6.0,   is_seen ? uv.x() : 0.0,
                               is_seen ? uv.y() : 0.0, std::log(error_share),
                               std::log(z_m),          std::log(0.01)};
      for (int c = 0; c < 6; ++c) network.cell(c, i, j) = static_cast<float>(values[c]);
    }
  }
  for (int r = 0; r < network.grid_rows; ++r) {
    for (int c = 0; c < network.grid_columns; ++c) {
      const Eigen::Vector3d point = surface(static_cast<double>(c) / (network.grid_columns - 1),
                                            static_cast<double>(r) / (network.grid_rows - 1));
      network.node(0, r, c) = static_cast<float>(point.x() / point.z());
      network.node(1, r, c) = static_cast<float>(point.y() / point.z());
      network.node(2, r, c) = static_cast<float>(std::log(point.z()));
    }
  }
}

}  // namespace weft::inference::testing
