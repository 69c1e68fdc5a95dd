// SPDX-License-Identifier: Apache-2.0
#include "rest_metric.hpp"

#include <Eigen/Cholesky>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/bspline_site.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/texture_metric.hpp>

namespace weft::brunet_refine {

SplineDomain domain_around(const Template& templ, int control) {
  const auto flat_px = templ.flat_px.matrix<2>();
  const Eigen::RowVector2d low_px = flat_px.colwise().minCoeff();
  const Eigen::RowVector2d high_px = flat_px.colwise().maxCoeff();
  return {low_px.x(), high_px.x(), low_px.y(), high_px.y(), control, control};
}

Result<std::vector<MetricPlace>> metric_places(const Template& templ, const SplineDomain& domain,
                                               int per_cell) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto flat_px = templ.flat_px.matrix<2>();
  const auto faces = templ.faces.matrix<3>();
  const auto locator = FaceLocator::create(flat_px, faces, 0.0);
  if (!locator) return locator.error();
  std::vector<MetricPlace> places;
  const int columns = per_cell * (domain.nu - 3), rows = per_cell * (domain.nv - 3);
  for (int i = 0; i < columns; ++i) {
    worked(20 * rows);
    for (int j = 0; j < rows; ++j) {
      const double u = domain.u0 + (i + 0.5) / columns * (domain.u1 - domain.u0);
      const double v = domain.v0 + (j + 0.5) / rows * (domain.v1 - domain.v0);
      const FaceLocation at = locator->locate({u, v});
      if (!at.inside) continue;
      const auto rest = texture_jacobian(vertices_m, flat_px, faces, at.face);
      const Eigen::Matrix2d lower = (rest.transpose() * rest).llt().matrixL();
      const SplineSite along_u = spline_site(domain, u, v, 1, 0);
      const SplineSite along_v = spline_site(domain, u, v, 0, 1);
      MetricPlace place;
      place.corner = domain.control_index(along_u.i, along_u.j);
      for (std::size_t k = 0; k < 16; ++k) {
        // L^-1 applied to the pair (phi_u, phi_v).
        place.first[k] = along_u.weights[k] / lower(0, 0);
        place.second[k] = (along_v.weights[k] - lower(1, 0) * place.first[k]) / lower(1, 1);
      }
      places.push_back(place);
    }
  }
  return places;
}

}  // namespace weft::brunet_refine
