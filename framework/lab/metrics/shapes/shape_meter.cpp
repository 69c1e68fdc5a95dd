// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/shapes/shape_meter.hpp"

#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/mesh_topology.hpp>

namespace weft::lab {

Result<ShapeMeter> ShapeMeter::create(const Template& templ) {
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto topology = build_topology(templ.faces.matrix<3>(), vertices_m.rows());
  if (!topology) return topology.error();
  auto locator = FaceLocator::create(templ.flat_px.matrix<2>(), templ.faces.matrix<3>());
  if (!locator) return locator.error();
  auto edges = distance_constraints(topology->edges, vertices_m);
  if (!edges) return edges.error();
  ShapeMeter meter(*std::move(locator));
  meter.faces_ = templ.faces.matrix<3>();
  meter.vertex_count_ = vertices_m.rows();
  meter.edges_ = *std::move(edges);
  meter.diagonal_m_ = (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff()).norm();
  if (templ.m_per_px.present()) {
    meter.m_per_px_ = templ.m_per_px.matrix<1>();
    if (!(meter.m_per_px_.minCoeff() > 0.0)) {
      return Error{Errc::invalid_data, "the template's m_per_px must be above 0"};
    }
  }
  return meter;
}

Result<PointErrors> ShapeMeter::errors(const Points3View& vertices_m, const GroundTruth& truth,
                                       Alignment alignment) const {
  if (!(m_per_px_.minCoeff() > 0.0)) {
    return Error{Errc::invalid_data,
                 "the template has no m_per_px, so the points of the truth have no place on it; "
                 "evaluate with a flat template"};
  }
  PointErrors result;
  Points3 estimated_m(truth.count(), 3), truth_m(truth.count(), 3);
  Eigen::Index located = 0;
  for (std::int64_t i = 0; i < truth.count(); ++i) {
    const Eigen::Vector2d xy_m(truth.template_xy_m(i, 0), truth.template_xy_m(i, 1));
    const FaceLocation place = locator_.locate(xy_m.cwiseQuotient(m_per_px_));
    if (place.face < 0) {
      ++result.unlocated;
      continue;
    }
    if (!place.inside) ++result.extrapolated;
    estimated_m.row(located) = interpolate(vertices_m, faces_, place.face, place.weights);
    truth_m.row(located++) = truth.points_m.matrix<3>().row(i);
    result.points.push_back(i);
  }
  if (located == 0) return result;
  const auto aligned_m =
      align_estimate(estimated_m.topRows(located), truth_m.topRows(located), alignment);
  if (!aligned_m) return aligned_m.error();
  const Eigen::VectorXd distances = (*aligned_m - truth_m.topRows(located)).rowwise().norm();
  result.distances_m.assign(distances.begin(), distances.end());
  for (Eigen::Index i = 0; i < located; ++i) result.depths_m.push_back(truth_m(i, 2));
  return result;
}

}  // namespace weft::lab
