// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>
#include <weft/geometry/thin_plate_spline.hpp>

#include "common/affine_fit.hpp"
#include "common/fit_data.hpp"
#include "common/warp_samples.hpp"

namespace weft::tps {

/// Value of a spline, and derivatives up to `order`. The second ones are infinite at a centre: they
/// are those at a distance of 1e-6 scales from it.
warps::WarpAt evaluate(const ThinPlateSpline& spline, const Eigen::RowVector2d& point_px,
                       std::int64_t order);

/// The data of the fit: min sum_k w_k |W(p_k) - y_k|^2 + lambda n (bending energy / 16 pi), the
/// energy in normalised coordinates. Lambda has no unit and means the same for any number n of
/// matches.
struct Samples {
  Points2View points_px, values_px;  ///< [n,2]
  std::span<const double> weights;   ///< [n] above 0
};

/// A fit and how far it is from the values.
struct Fitted {
  ThinPlateSpline spline;
  PointColumns residuals_px;  ///< [n,2] value minus that of the spline
  PointColumns left_out_px;   ///< [n,2] value minus that of the spline through the others, if
                              ///< requested
};

/// A centre at each match: the best such map there is, in n^3 operations. Matches in one place
/// (within 1e-6 px) are one with their mean value. Nothing where they do not determine it.
std::optional<Fitted> fit_at_matches(const Samples& samples, double lambda,
                                     bool leave_one_out = false);

/// Centres on a grid, independent of the matches (Bartoli, Perriollat and Chambon 2010): the map is
/// linear in its values at the centres, which are fitted. The part that depends on the grid alone
/// is kept.
class GridFit {
 public:
  /// Costs only when something differs from the time before. At least 2 x 2 centres.
  void set_grid(const TextureBox& box, int columns, int rows);
  std::optional<Fitted> fit(const Samples& samples, double lambda, bool leave_one_out = false);

 private:
  TextureBox box_;
  int columns_ = 0, rows_ = 0;
  ThinPlateSpline plate_;     ///< centre, scale and centres
  Eigen::MatrixXd cardinal_;  ///< [l+3,l] coefficients and affine part of the values at the centres
  Eigen::MatrixXd design_, weighted_, moments_, normal_;
};

}  // namespace weft::tps
