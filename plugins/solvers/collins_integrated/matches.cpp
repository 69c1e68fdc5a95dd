// SPDX-License-Identifier: Apache-2.0
#include "matches.hpp"

#include <Eigen/Cholesky>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>

namespace weft::collins_integrated {
namespace {

constexpr double kMeshNoise_px = 0.25;  // noise of mesh, camera and lengths, which no match
                                        // contains

Error mistake(std::int64_t match, const std::string& problem) {
  return {Errc::invalid_data, "match " + std::to_string(match) + " " + problem};
}

/// W with W^T W = C^-1; false where C is not positive definite.
bool whiten(const double* covariance_px2, Eigen::Matrix2d& whitening_per_px) {
  Eigen::Matrix2d covariance;
  const double across = 0.5 * (covariance_px2[1] + covariance_px2[2]);
  covariance << covariance_px2[0], across, across, covariance_px2[3];
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() >= 0.0)) return false;
  covariance.diagonal().array() += kMeshNoise_px * kMeshNoise_px;
  const Eigen::LLT<Eigen::Matrix2d> factor(covariance);
  if (factor.info() != Eigen::Success) return false;
  whitening_per_px = factor.matrixL().solve(Eigen::Matrix2d::Identity());
  return true;
}

}  // namespace

Result<void> read_matches(const Correspondences& matches, const MeshModel& mesh, double noise_px,
                          const std::vector<std::uint8_t>& hidden_faces,
                          std::vector<Observation>& observations) {
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    worked_in_loop(i, 3);
    const std::int32_t face = matches.face(i);
    if (matches.kept(i) == 0 || face < 0) continue;
    if (face >= mesh.faces.rows()) {
      return mistake(i, "lies in face " + std::to_string(face) + " of a template with " +
                            std::to_string(mesh.faces.rows()) + ": use one template throughout");
    }
    Observation seen;
    seen.face = face;
    seen.weights = matches.barycentrics.matrix<3>().row(i).transpose();
    seen.seen_px = matches.image_px.matrix<2>().row(i).transpose();
    if (!seen.weights.allFinite() || !seen.seen_px.allFinite()) {
      return mistake(i, "is not finite: leave it out");
    }
    seen.whitening_per_px = Eigen::Matrix2d::Identity() / noise_px;
    if (matches.covariance_px2.present() &&
        !whiten(matches.covariance_px2.row(i), seen.whitening_per_px)) {
      return mistake(i, "has no positive definite covariance: leave it out");
    }
    if (hidden_faces.empty() || hidden_faces[to_index(face)] == 0) observations.push_back(seen);
  }
  return {};
}

}  // namespace weft::collins_integrated
