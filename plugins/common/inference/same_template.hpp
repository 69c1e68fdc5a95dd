// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <weft/core/result.hpp>
#include <weft/data/template.hpp>

#include "common/inference/network_file.hpp"

namespace weft::inference {

/// A flat rectangular template: (x, y) in m from its top left corner, and texels.
struct FlatSheet {
  Eigen::Array2d size_m = Eigen::Array2d::Zero();     ///< width and height of the mesh
  Eigen::Array2d corner_m = Eigen::Array2d::Zero();   ///< template frame, least x and y
  Eigen::Array2d corner_px = Eigen::Array2d::Zero();  ///< texture, least u and v
  Eigen::Array2d size_px = Eigen::Array2d::Zero();    ///< texture, extent of the mesh

  /// The texel of a point given as shares of width and height.
  Eigen::Array2d texel(const Eigen::Array2d& uv) const { return corner_px + uv * size_px; }
  /// The shares of width and height of a vertex at rest.
  Eigen::Array2d shares(double x_m, double y_m) const {
    return (Eigen::Array2d(x_m, y_m) - corner_m) / size_m;
  }
};

/// Fails unless the template is flat and its texture is neither turned nor distorted.
Result<FlatSheet> flat_sheet(const Template& templ);

/// Fails unless the network was trained for this template: texture, width and height.
Result<void> check_same_template(const NetworkFile& file, const Template& templ,
                                 const FlatSheet& sheet);

}  // namespace weft::inference
