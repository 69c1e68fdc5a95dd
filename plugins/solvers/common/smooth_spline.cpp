// SPDX-License-Identifier: Apache-2.0
#include "smooth_spline.hpp"

#include <Eigen/LU>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {

bool determine_affine_map(const Points2View& places) {
  if (places.rows() < 3) return false;
  const Eigen::RowVector2d middle = places.colwise().mean();
  const Points2 offsets = places.rowwise() - middle;
  const Eigen::Matrix2d spread = offsets.transpose() * offsets;
  const double trace = spread.trace();
  return spread.determinant() > 1e-8 * trace * trace;  // false for NaN
}

SplineValues spline_values(const SplineDomain& domain, const SplineValues& control,
                           const Points2View& places, int du, int dv) {
  SplineValues values(places.rows(), control.cols());
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    worked_in_loop(p, 10);
    const SplineSite site = spline_site(domain, places(p, 0), places(p, 1), du, dv);
    values.row(p) = evaluate_site(domain, site, control).transpose();
  }
  return values;
}

Result<Eigen::VectorXd> integrate_gradients(SplineEquations& equations, const Points2View& places,
                                            const Points2View& gradients,
                                            const std::vector<bool>& is_used, double smoothing) {
  if (!determine_affine_map(places)) return no_result("the places to integrate over are on a line");
  const SplineDomain& domain = equations.domain();
  equations.clear(1);
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    if (!is_used[to_index(p)]) continue;
    const double u = places(p, 0), v = places(p, 1);
    equations.add(spline_site(domain, u, v, 1, 0), gradients.row(p).segment<1>(0));
    equations.add(spline_site(domain, u, v, 0, 1), gradients.row(p).segment<1>(1));
  }
  // Without a change of the others: gradients leave the constant free.
  equations.add(spline_site(domain, places(0, 0), places(0, 1)), Eigen::RowVectorXd::Zero(1),
                1.0 / (domain.su() * domain.sv()));
  const auto solved = equations.solve(smoothing);
  if (!solved) return solved.error();
  return Eigen::VectorXd(spline_values(domain, *solved, places));
}

Result<void> SmoothSpline::fit(const Points2View& places,
                               const Eigen::Ref<const SplineValues>& values, double smoothing) {
  // The bending energy leaves affine maps free: the places must determine one.
  if (!determine_affine_map(places)) {
    return no_result("the usable part of the warp is a point or a line");
  }
  const SplineDomain& domain = equations_.domain();
  equations_.clear(values.cols());
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    equations_.add(spline_site(domain, places(p, 0), places(p, 1)), values.row(p));
  }
  auto solved = equations_.solve(smoothing * domain.su() * domain.sv());
  if (!solved) return solved.error();
  control_ = *std::move(solved);
  return {};
}

SplineValues SmoothSpline::at(const Points2View& places, int du, int dv) const {
  return spline_values(equations_.domain(), control_, places, du, dv);
}

}  // namespace weft::solvers
