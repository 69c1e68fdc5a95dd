// SPDX-License-Identifier: Apache-2.0
#include "image_motion.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace weft::solvers {

ImageMotion image_motion(const Points2View& measured_px, const Points2View& projected_px) {
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d high = -low;
  Eigen::Vector2d moved = Eigen::Vector2d::Zero();
  double distance_px = 0.0;
  for (Eigen::Index i = 0; i < measured_px.rows(); ++i) {
    const Eigen::Vector2d measured = measured_px.row(i).transpose();
    const Eigen::Vector2d gap = measured - projected_px.row(i).transpose();
    moved += gap;
    distance_px += gap.norm();
    low = low.min(measured.array());
    high = high.max(measured.array());
  }
  const auto count = static_cast<double>(measured_px.rows());
  const double moved_px = moved.norm() / count;
  return {std::isfinite(moved_px) ? moved_px : std::numeric_limits<double>::infinity(),
          distance_px / count, (high - low).matrix().norm()};
}

Points3 depth_mirrored(const Points3View& vertices_m) {
  Points3 mirrored = vertices_m;
  const double middle_m = vertices_m.col(2).mean();
  for (Eigen::Index v = 0; v < mirrored.rows(); ++v) {
    const double factor = (2.0 * middle_m - mirrored(v, 2)) / mirrored(v, 2);
    if (factor > 0.0 && std::isfinite(factor)) mirrored.row(v) *= factor;
  }
  return mirrored;
}

Points3 bend_mirrored(const Points3View& vertices_m) {
  const Eigen::RowVector3d centre = vertices_m.colwise().mean();
  const Points3 from_centre = vertices_m.rowwise() - centre;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(from_centre.transpose() *
                                                              from_centre);
  const Eigen::Vector3d normal = spread.eigenvectors().col(0);
  Points3 mirrored = vertices_m;
  for (Eigen::Index v = 0; v < mirrored.rows(); ++v) {
    const double above_m = from_centre.row(v).dot(normal.transpose());
    const double depth_m = vertices_m(v, 2) - 2.0 * above_m * normal.z();
    const double factor = depth_m / vertices_m(v, 2);
    if (factor > 0.0 && std::isfinite(factor)) mirrored.row(v) *= factor;
  }
  return mirrored;
}

}  // namespace weft::solvers
