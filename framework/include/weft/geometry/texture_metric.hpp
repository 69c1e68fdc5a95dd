// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// dX/d(u,v) of a face in m/px: [X1 - X0, X2 - X0] [m1 - m0, m2 - m0]^-1, with the corners X in
/// space and m in the texture. The face must have an area in the texture.
inline Eigen::Matrix<double, 3, 2> texture_jacobian(const Points3View& vertices_m,
                                                    const Points2View& flat_px,
                                                    const FacesView& faces, Eigen::Index face) {
  Eigen::Matrix<double, 3, 2> sides_m;
  Eigen::Matrix2d sides_px;
  for (int k = 0; k < 2; ++k) {
    sides_m.col(k) = vertices_m.row(faces(face, k + 1)) - vertices_m.row(faces(face, 0));
    sides_px.col(k) = flat_px.row(faces(face, k + 1)) - flat_px.row(faces(face, 0));
  }
  return sides_m * sides_px.inverse();
}

/// Size of a texel on a surface.
struct TexelPitch {
  Eigen::Vector2d m_per_px = Eigen::Vector2d::Zero();  ///< [2] m/px along u and v
  double distortion =
      0.0;  ///< [] largest |1 - s| over the stretches s of the faces relative to m_per_px
};

/// The root mean squares of |dX/du| and |dX/dv| over the area; exact on a surface that unrolls into
/// the texture. The singular values of J diag(m_per_px)^-1 measure the deviation from that case.
inline TexelPitch texel_pitch(const Points3View& vertices_m, const Points2View& flat_px,
                              const FacesView& faces) {
  TexelPitch pitch;
  double area = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const double own = face_area(vertices_m, faces, f);
    const auto jacobian = texture_jacobian(vertices_m, flat_px, faces, f);
    pitch.m_per_px += own * jacobian.colwise().squaredNorm().transpose();
    area += own;
  }
  pitch.m_per_px = (pitch.m_per_px / area).cwiseSqrt();
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Matrix<double, 3, 2> scaled = texture_jacobian(vertices_m, flat_px, faces, f) *
                                               pitch.m_per_px.cwiseInverse().asDiagonal();
    // Singular values from the 2 x 2 Gram matrix.
    const Eigen::Matrix2d gram = scaled.transpose() * scaled;
    const double mean = 0.5 * gram.trace();
    const double spread = std::hypot(0.5 * (gram(0, 0) - gram(1, 1)), gram(0, 1));
    const double most = std::sqrt(mean + spread);
    const double least = std::sqrt(std::max(0.0, mean - spread));
    pitch.distortion = std::max({pitch.distortion, std::abs(1.0 - most), std::abs(1.0 - least)});
  }
  return pitch;
}

}  // namespace weft
