// SPDX-License-Identifier: Apache-2.0
#include "spline_model.hpp"

#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/bspline_site.hpp>

#include "common/warp_samples.hpp"

namespace weft::bbs {

void write_model(const SplineDomain& domain, const Points2& control_px, Warp& warp) {
  warp.domain_px = make_array<double>(Eigen::Vector4d(domain.u0, domain.u1, domain.v0, domain.v1));
  warp.model.entries = {{"model.grid", make_array<double>(Eigen::Vector2d(domain.nu, domain.nv))},
                        {"model.control", make_array<double>(control_px)}};
}

Result<SplineModel> read_model(const Warp& warp) {
  const Error bad{Errc::invalid_data,
                  "the warp holds no spline: it was not made by warps/bbs, evaluate it with '" +
                      warp.producer + "'",
                  {}};
  const Array<double>* grid = warp.model.find("model.grid");
  const Array<double>* control = warp.model.find("model.control");
  if (grid == nullptr || control == nullptr || grid->size() != 2 || control->ndim() != 2) {
    return bad;
  }
  const double nu = *grid->row(0), nv = *grid->row(1);
  if (!(nu >= 4.0 && nu <= 1e4 && nv >= 4.0 && nv <= 1e4)) return bad;
  const auto border = warp.domain_px.matrix<1>();
  const SplineDomain domain{border[0],
                            border[1],
                            border[2],
                            border[3],
                            static_cast<std::int32_t>(nu),
                            static_cast<std::int32_t>(nv)};
  if (auto checked = check_domain(domain); !checked) return checked.error();
  if (control->dim(1) != 2 || control->rows() != domain.control_count()) return bad;
  return SplineModel{domain, control->matrix<2>()};
}

Result<WarpSamples> evaluate_model(const SplineModel& model, const Points& points) {
  auto samples = warps::make_samples(points);
  if (!samples) return samples.error();
  for (std::int64_t i = 0; i < points.xy_px.rows(); ++i) {
    worked_in_loop(i, points.order >= 2 ? 60 : 20);
    const double u = points.xy_px(i, 0), v = points.xy_px(i, 1);
    const auto at = [&](int du, int dv) {
      const SplineSite site = spline_site(model.domain, u, v, du, dv);
      return evaluate_site(model.domain, site, model.control_px);
    };
    const SplineSite site = spline_site(model.domain, u, v);
    warps::WarpAt here;
    here.value_px = evaluate_site(model.domain, site, model.control_px);
    here.inside = site.inside;
    if (points.order >= 1) here.jacobian << at(1, 0), at(0, 1);
    if (points.order >= 2) here.hessian << at(2, 0), at(1, 1), at(0, 2);
    warps::set_sample(*samples, i, here);
  }
  return samples;
}

}  // namespace weft::bbs
