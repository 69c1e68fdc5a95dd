// SPDX-License-Identifier: Apache-2.0
// Writes a network of blobs with descriptors of 4 x 4 px for the contract checks. Usage:
// onnx_contract_network FOLDER
#include <iostream>

#include "tests/test_detector.hpp"

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: onnx_contract_network FOLDER\n";
    return 2;
  }
  weft::onnx::testing::TestMaps network;
  network.dims = 16;
  for (int d = 0; d < network.dims; ++d) {
    for (int i = 0; i < 16; ++i) network.from_image.push_back(i == d ? 1.0F : -1.0F / 15.0F);
  }
  network.descriptors = "{output: descriptors, metric: l2, normalise: true}";
  const std::string onnx = network.model().bytes(), folder = arguments[1];
  using weft::inference::testing::write_file;
  write_file(folder + "/net.onnx", onnx);
  write_file(folder + "/net.yaml",
             network.image.yaml(weft::inference::hash_of(onnx)) + network.rest());
  return 0;
}
