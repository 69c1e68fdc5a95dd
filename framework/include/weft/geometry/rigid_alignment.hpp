// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <string>
#include <utility>
#include <weft/core/result.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

enum class AlignmentKind { rigid, similarity };

/// Similarity transform: target ~ scale * rotation * source + translation.
struct RigidAlignment {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< [3,3] target_from_source, det 1
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();   ///< [3] unit of the points
  double scale = 1.0;                                      ///< [] 1 for AlignmentKind::rigid
  double rms = 0.0;  ///< [] root mean square of the residual distances, unit of the points

  Eigen::Vector3d operator()(const Eigen::Vector3d& source) const {
    return scale * (rotation * source) + translation;
  }
};

/// Transforms all points [N,3].
inline Points3 transform_points(const RigidAlignment& alignment, const Points3View& points) {
  return ((alignment.scale * points * alignment.rotation.transpose()).rowwise() +
          alignment.translation.transpose());
}

namespace detail {

inline Error no_alignment(std::string reason) {
  return no_result("the best rigid transform is not unique: " + std::move(reason));
}

inline Result<void> check_alignable(const Points3View& source, const Points3View& target) {
  if (source.rows() != target.rows()) {
    return Error{Errc::invalid_value, "alignment needs as many source as target points, got " +
                                          std::to_string(source.rows()) + " and " +
                                          std::to_string(target.rows())};
  }
  if (source.rows() < 3) {
    return no_alignment(std::to_string(source.rows()) + " points are given, at least 3 are needed");
  }
  if (!source.allFinite() || !target.allFinite()) {
    return Error{Errc::invalid_data, "alignment needs finite points: remove the others"};
  }
  return {};
}

}  // namespace detail

/// The transform with the least sum of squared distances between corresponding points [N,3]
/// (Umeyama, PAMI 1991, eq. 40-42; without reflections). Returns no_result for fewer than 3 points
/// and for an undetermined rotation: coincident or collinear points, or a mirrored symmetry.
inline Result<RigidAlignment> align_points(const Points3View& source, const Points3View& target,
                                           AlignmentKind kind = AlignmentKind::rigid) {
  if (auto checked = detail::check_alignable(source, target); !checked) return checked.error();
  const Eigen::RowVector3d source_mean = source.colwise().mean();
  const Eigen::RowVector3d target_mean = target.colwise().mean();
  const Points3 a = source.rowwise() - source_mean;
  const Points3 b = target.rowwise() - target_mean;
  constexpr double kRank = 1e-12;
  if (a.cwiseAbs().maxCoeff() <= kRank * source.cwiseAbs().maxCoeff() ||
      b.cwiseAbs().maxCoeff() <= kRank * target.cwiseAbs().maxCoeff()) {
    return detail::no_alignment("all points coincide");
  }
  const Eigen::Matrix3d covariance = b.transpose() * a;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& sigma = svd.singularValues();
  if (!(sigma[1] > kRank * sigma[0])) return detail::no_alignment("the points lie on a line");
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) {
    sign[2] = -1.0;
    if (!(sigma[1] - sigma[2] > kRank * sigma[0])) {
      return detail::no_alignment("the target is a mirror image with a symmetry");
    }
  }
  RigidAlignment result;
  result.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  if (kind == AlignmentKind::similarity) result.scale = sigma.dot(sign) / a.squaredNorm();
  result.translation =
      target_mean.transpose() - result.scale * (result.rotation * source_mean.transpose());
  const Points3 left_over = b - result.scale * a * result.rotation.transpose();
  result.rms = std::sqrt(left_over.squaredNorm() / static_cast<double>(a.rows()));
  return result;
}

}  // namespace weft
