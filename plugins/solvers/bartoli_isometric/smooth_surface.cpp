// SPDX-License-Identifier: Apache-2.0
#include "smooth_surface.hpp"

#include <vector>
#include <weft/core/index.hpp>
#include <weft/geometry/bspline_bending.hpp>
#include <weft/geometry/bspline_site.hpp>

namespace weft::bartoli_isometric {

void SmoothSurface::set_domain(const SplineDomain& domain) {
  domain_ = domain;
  bending_ = domain.su() * domain.sv() * bending_matrix(domain);
}

Result<void> SmoothSurface::fit(const Points2View& points_px, const Points3View& points_m,
                                double smoothing) {
  // The bending energy leaves affine maps free: the points must determine one.
  const Eigen::RowVector2d middle = points_px.rows() > 0
                                        ? Eigen::RowVector2d(points_px.colwise().mean())
                                        : Eigen::RowVector2d(0.0, 0.0);
  const Points2 offsets = points_px.rowwise() - middle;
  const Eigen::Matrix2d spread = offsets.transpose() * offsets;
  const double trace = spread.trace();
  if (points_px.rows() < 3 || !(spread.determinant() > 1e-8 * trace * trace)) {
    return no_result("the usable part of the warp is a point or a line");
  }
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(256 * to_index(points_px.rows()));
  Points3 right = Points3::Zero(domain_.control_count(), 3);
  for (Eigen::Index p = 0; p < points_px.rows(); ++p) {
    const SplineSite site = spline_site(domain_, points_px(p, 0), points_px(p, 1));
    for (int a = 0; a < 16; ++a) {
      const Eigen::Index row = domain_.control_index(site.i + a / 4, site.j + a % 4);
      right.row(row) += site.weights[to_index(a)] * points_m.row(p);
      for (int b = 0; b < 16; ++b) {
        const Eigen::Index column = domain_.control_index(site.i + b / 4, site.j + b % 4);
        triplets.emplace_back(static_cast<int>(row), static_cast<int>(column),
                              site.weights[to_index(a)] * site.weights[to_index(b)]);
      }
    }
  }
  Eigen::SparseMatrix<double> normal(domain_.control_count(), domain_.control_count());
  normal.setFromTriplets(triplets.begin(), triplets.end());
  normal += smoothing * bending_;
  factor_.compute(normal);
  if (factor_.info() != Eigen::Success) return no_result("the surface is not determined");
  control_m_ = factor_.solve(right);
  if (!control_m_.allFinite()) return no_result("the surface is not finite");
  return {};
}

Points3 SmoothSurface::at(const Points2View& places_px) const {
  Points3 points_m(places_px.rows(), 3);
  for (Eigen::Index p = 0; p < places_px.rows(); ++p) {
    const SplineSite site = spline_site(domain_, places_px(p, 0), places_px(p, 1));
    points_m.row(p) = evaluate_site(domain_, site, control_m_).transpose();
  }
  return points_m;
}

}  // namespace weft::bartoli_isometric
