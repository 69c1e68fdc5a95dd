// SPDX-License-Identifier: Apache-2.0
#include "spline_model.hpp"

#include <string>
#include <weft/geometry/bspline_site.hpp>

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
  if (points.order < 0 || points.order > 2) {
    return Error{Errc::invalid_value,
                 "order " + std::to_string(points.order) + " of derivatives: ask for 0, 1 or 2",
                 {}};
  }
  const std::int64_t count = points.xy_px.rows();
  WarpSamples samples;
  samples.xy_px = Array<double>({count, 2});
  samples.valid = Array<std::uint8_t>({count});
  if (points.order >= 1) samples.jacobian = Array<double>({count, 2, 2});
  if (points.order >= 2) samples.hessian = Array<double>({count, 2, 3});
  for (std::int64_t i = 0; i < count; ++i) {
    const double u = points.xy_px(i, 0), v = points.xy_px(i, 1);
    const auto at = [&](int du, int dv) {
      const SplineSite site = spline_site(model.domain, u, v, du, dv);
      return evaluate_site(model.domain, site, model.control_px);
    };
    const SplineSite site = spline_site(model.domain, u, v);
    const Eigen::Vector2d value = evaluate_site(model.domain, site, model.control_px);
    Eigen::Map<Eigen::Vector2d>(samples.xy_px.row(i)) = value;
    samples.valid(i) = site.inside && value.allFinite() ? 1 : 0;
    if (points.order >= 1) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(samples.jacobian.row(i)) << at(1, 0),
          at(0, 1);
    }
    if (points.order >= 2) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>(samples.hessian.row(i)) << at(2, 0),
          at(1, 1), at(0, 2);
    }
  }
  return samples;
}

}  // namespace weft::bbs
