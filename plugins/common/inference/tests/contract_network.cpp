// SPDX-License-Identifier: Apache-2.0
// Writes a network for the template of the contract checks: it answers the surface of the usual
// scene, whatever it sees. Usage: inference_contract_network FOLDER
#include <algorithm>
#include <iostream>
#include <weft/data/matrix.hpp>

#include "common/inference/same_template.hpp"
#include "common/inference/tests/test_network.hpp"
#include "kit/testing/contract_scene.hpp"

namespace weft::inference {
namespace {

/// The mesh of a surface of columns x rows vertices, interpolated bilinearly.
testing::Surface mesh_of(const Points3& vertices_m, int columns, int rows) {
  return [=](double u, double v) -> Eigen::Vector3d {
    const double x = u * (columns - 1), y = v * (rows - 1);
    const int c = std::clamp(static_cast<int>(x), 0, columns - 2);
    const int r = std::clamp(static_cast<int>(y), 0, rows - 2);
    const auto at = [&](int i, int j) -> Eigen::Vector3d {
      return vertices_m.row(Eigen::Index{i} * columns + j).transpose();
    };
    return (1 - y + r) * ((1 - x + c) * at(r, c) + (x - c) * at(r, c + 1)) +
           (y - r) * ((1 - x + c) * at(r + 1, c) + (x - c) * at(r + 1, c + 1));
  };
}

int write_contract_network(const std::string& folder) {
  const weft::testing::Scene scene = weft::testing::make_scene(0);
  const auto sheet = flat_sheet(scene.templ);
  if (!sheet) {
    std::cerr << sheet.error().message << "\n";
    return 1;
  }
  testing::TestNetwork network;
  network.grid_columns = 9;  // those of the mesh of the scenes
  network.grid_rows = 6;
  network.width_m = sheet->size_m.x();
  network.height_m = sheet->size_m.y();
  network.texture_hash = texture_hash(scene.templ.texture);
  const Points3 vertices_m = scene.shape.vertices_m.matrix<3>();
  if (vertices_m.rows() != network.node_count()) {
    std::cerr << "the mesh of the contract's scenes has other columns and rows\n";
    return 1;
  }
  testing::show(mesh_of(vertices_m, network.grid_columns, network.grid_rows), 0.004, network);
  const std::string onnx = network.model().bytes();
  testing::write_file(folder + "/net.onnx", onnx);
  testing::write_file(folder + "/net.yaml", network.yaml(hash_of(onnx)));
  return 0;
}

}  // namespace
}  // namespace weft::inference

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: inference_contract_network FOLDER\n";
    return 2;
  }
  return weft::inference::write_contract_network(arguments[1]);
}
