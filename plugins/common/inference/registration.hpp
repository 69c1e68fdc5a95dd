// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/data/template.hpp>

#include "common/inference/input_map.hpp"
#include "common/inference/network_choice.hpp"
#include "common/inference/same_template.hpp"

namespace weft::inference {

/// A cell of the image in which a network sees the template.
struct SeenCell {
  int row = 0, column = 0;
  Eigen::Array2d image_px = Eigen::Array2d::Zero();  ///< centre, px of the frame
  Eigen::Array2d uv = Eigen::Array2d::Zero();  ///< shares of width and height; may leave [0, 1]
  double probability = 0.0;                    ///< [] of the mask
  double error_m = 0.0;                        ///< expected error of the template point
  double depth_m = 0.0;
  double depth_error_m = 0.0;     ///< expected error of the depth
  double stretch_m_per_px = 0.0;  ///< template m for each px of the frame; see set_stretch()
};

/// A network with the template and the camera of a run.
class Registration {
 public:
  /// Opens the network on the first call. Checks template and camera whenever they change. A
  /// network for any texture takes every flat template with a texture, and every camera.
  Result<void> prepare(const NetworkChoice& choice, const Template& templ, const Camera& camera);

  /// The output for a frame of this camera; requires prepare().
  Result<NetworkMaps> run(const Image& image, int threads);

  /// The cells of at least this mask probability whose centre is in the frame, row by row.
  std::vector<SeenCell> seen_cells(const NetworkMaps& maps, double least_probability) const;

  const NetworkFile& file() const { return network_->file(); }
  const FlatSheet& sheet() const { return sheet_; }
  const InputMap& map() const { return *map_; }
  const Camera& camera() const { return camera_; }
  int cell_count() const { return file().cells.columns * file().cells.rows; }
  double share_of(const std::vector<SeenCell>& cells) const {
    return static_cast<double>(cells.size()) / cell_count();
  }
  /// No result if the cells are less than 1 % of all: so few are those of an image without the
  /// object.
  Result<void> check_share(const std::vector<SeenCell>& cells) const;
  /// Probability that a shape from these cells is right within 2 % of its diagonal. The errors of
  /// neighbouring cells are alike, so that their number does not help. `excess` is the factor by
  /// which the errors of the shape exceed those of a solver that uses the points of the cells.
  double confidence(const std::vector<SeenCell>& cells, double excess = 1.0) const;
  /// True if a cell's point is beyond the template by more than its expected error.
  bool is_beyond(const SeenCell& cell) const;
  /// Sides of a cell in px of the frame.
  Eigen::Array2d cell_px() const;

 private:
  Result<void> take_template(const Template& templ);
  Result<InputMap> map_of(const Camera& camera) const;
  /// Shares of width and height from two channels of the cells.
  Eigen::Array2d uv_of(double first, double second) const;

  std::optional<Network> network_;
  std::string path_;
  std::optional<InputMap> map_;
  Camera camera_;
  FlatSheet sheet_;
  cv::Mat texture_;      ///< rows below the image; empty for a network of one template
  InputMap to_texture_;  ///< from the texture to its square in those rows
  double unit_m_ = 0.0;  ///< unit of the network's x, y and their error
  std::uint64_t checked_revision_ = 0;
};

/// Sets the stretch of each cell from the differences of uv to its seen neighbours: the root mean
/// square over both image axes. A cell without neighbours has the median of the others. An
/// inextensible surface cannot be smaller in the image than face on, so that the stretch is at
/// least half of depth / focal length. `cells` are sorted row by row.
void set_stretch(const CellGrid& grid, const Eigen::Array2d& size_m, const Eigen::Array2d& cell_px,
                 double focal_px, std::vector<SeenCell>& cells);

/// Standard deviation of a cell's place in px of the frame: its error_m divided by its stretch, at
/// least `least_px` and at most `most_px`.
double sigma_px(const SeenCell& cell, double least_px, double most_px);

}  // namespace weft::inference
