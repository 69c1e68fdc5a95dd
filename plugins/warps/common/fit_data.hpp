// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/geometry/object_box.hpp>
#include <weft/geometry/types.hpp>
#include <weft/sdk/warp_model.hpp>

namespace weft::warps {

/// The matches that take part in a fit: kept, in the box, with a weight above 0. Memory is kept.
class FitData {
 public:
  /// Takes the matches of `in`. invalid_data names a number that is not finite or a negative
  /// weight; no_result where none is left.
  Result<void> take(const FitInput& in, const TextureBox& box);

  std::size_t count() const { return weights_.size(); }
  int dropped_outside() const { return dropped_; }
  Points2View points_px() const { return view(points_px_); }  ///< [n,2] px of the texture
  Points2View values_px() const { return view(values_px_); }  ///< [n,2] px of the image
  const std::vector<double>& weights() const { return weights_; }

 private:
  Points2View view(const std::vector<double>& pairs) const {
    return Eigen::Map<const Points2>(pairs.data(), static_cast<Eigen::Index>(count()), 2);
  }

  std::vector<double> points_px_, values_px_;  // u v u v ...
  std::vector<double> weights_;
  int dropped_ = 0;
};

}  // namespace weft::warps
