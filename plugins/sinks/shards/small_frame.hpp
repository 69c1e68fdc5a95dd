// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>

namespace weft::shards {

/// The images and cells of a sample. A cell is a square of the small image.
struct SampleFormat {
  int width_px = 160, height_px = 120;  ///< size of the small image
  int cell_px = 4;                      ///< side of a cell

  int columns() const { return width_px / cell_px; }
  int rows() const { return height_px / cell_px; }

  /// How many pixels of the camera's image, along each side, a pixel of the small image is the mean
  /// of. Fails if that is no whole number, or if cells do not fill the small image.
  Result<int> reduction(const Camera& camera) const;
  /// The camera of the small image.
  Camera reduced(const Camera& camera) const;
};

/// The small image [H,W,3], red, green and blue.
std::vector<std::uint8_t> small_image(const SampleFormat& format, const Image& image);

/// Labels of the cells [R,C], row by row.
struct CellLabels {
  std::vector<std::uint16_t> uv;     ///< [R,C,2] 65534 (x / width, y / height), 65535 for none
  std::vector<std::uint16_t> depth;  ///< [R,C] 0.1 mm, 0 for none
  std::vector<std::uint8_t> mask;    ///< [R,C] share of the cell that shows the texture, 0 to 255
};

/// The template point and the depth at the centre of each cell: the mean of the four pixels around
/// it, none where one of them does not see the texture. `pitch_m` [2] and `texels` [2] describe the
/// texture.
CellLabels cell_labels(const SampleFormat& format, const GroundTruth& truth,
                       const Eigen::Vector2d& pitch_m, const Eigen::Vector2d& texels);

}  // namespace weft::shards
