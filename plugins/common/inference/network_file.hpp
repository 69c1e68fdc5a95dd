// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>

#include "common/inference/onnx_file.hpp"

/// Networks that find a template in an image: files, checks and the forward pass.
namespace weft::inference {

/// Grid of cells over the network's image. Cell (i, j), row and column, has its centre at
/// x = step_px j + (step_px - 1) / 2, y likewise, in px of the network's image.
struct CellGrid {
  std::string output;  ///< name of the network's output
  int step_px = 0;     ///< [] px of the network's image, side of a cell
  int columns = 0, rows = 0;
};

/// Grid of points over the template. Node (r, c) lies at x = c / (columns - 1) width_m, y likewise.
struct VertexGrid {
  std::string output;  ///< name of the network's output
  int columns = 0, rows = 0;
};

/// The template that a network was trained for.
struct TrainedTemplate {
  double width_m = 0.0, height_m = 0.0;
  std::string texture_hash;  ///< 16 hexadecimal digits, see texture_hash()
};

/// The contents of a network file NAME.yaml.
struct NetworkFile : OnnxFile {
  Camera camera;  ///< camera and size of the network's image
  CellGrid cells;
  VertexGrid vertices;    ///< if the network is for one template
  TrainedTemplate templ;  ///< if the network is for one template
  int texture_px = 0;     ///< side of the square with the texture below the image; 0: one template
  double uv_error_factor = 1.0;  ///< expected error of uv = factor * exp(log error)

  bool is_for_any_texture() const { return texture_px > 0; }
  std::vector<std::string> outputs() const {
    if (is_for_any_texture()) return {cells.output};
    return {cells.output, vertices.output};
  }
};

/// Reads and checks a network file. An error has the place in the file and the correction.
Result<NetworkFile> read_network_file(const std::string& path);

}  // namespace weft::inference
