// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/camera_evidence.hpp"

#include <Eigen/LU>

namespace weft {
namespace {

PartMatrix prior_information() { return prior_std().cwiseAbs2().cwiseInverse().asDiagonal(); }

}  // namespace

CameraDeviation CameraDeviation::of(const CameraEvidence& evidence) {
  const PartMatrix covariance = (evidence.information + prior_information()).inverse();
  return {covariance * evidence.weighted, covariance};
}

CameraEvidence CameraEvidence::free_strain(double std) const {
  const StrainMatrix loose =
      (strain_information + StrainMatrix::Identity() / (std * std)).inverse();
  const PartsByStrains by_strain = cross * loose;
  const StrainMatrix shared = strain_information * loose;
  CameraEvidence left;
  left.information = information - by_strain * cross.transpose();
  left.weighted = weighted - by_strain * strain_weighted;
  left.cross = cross - by_strain * strain_information;
  left.strain_information = strain_information - shared * strain_information;
  left.strain_weighted = strain_weighted - shared * strain_weighted;
  return left;
}

void CameraEvidence::add_strain(const NormalEquations& equations, const PartVector& deviation) {
  const auto& mixed = equations.strain_mixed;
  const auto by_strains = equations.by_strains();
  cross = equations.parts_by_strains - equations.mixed.transpose() * by_strains;
  strain_information = equations.strains - mixed.transpose() * by_strains;
  strain_weighted = cross.transpose() * deviation - equations.strain_gradient +
                    mixed.transpose() * equations.alone;
}

}  // namespace weft
