// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/joint_deviation.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string_view>

namespace weft {
namespace {

/// Errors that many frames have in common do not average out: the mesh is not quite the surface,
/// the template not quite the object. Standard deviations of focal, aspect, lens and centre.
constexpr double kCommon[] = {0.015, 0.005, 0.02, 0.01, 0.01};

/// Half of by how much more a surface may be stretched in one direction than across it, standard
/// deviations: of all frames alike, and of each by itself. Four of them are 16 %.
constexpr double kFixedStretch = 0.02, kOwnStretch = 0.02;

CameraDeviation joint(const CameraEvidence& sum, const std::vector<CameraEvidence>& frames) {
  CameraDeviation deviation = CameraDeviation::of(sum);
  double squares = 0.0;
  for (const CameraEvidence& frame : frames) {
    const PartVector rest = frame.weighted - frame.information * deviation.mean;
    squares += rest.dot(CameraDeviation::of(frame).covariance * rest);
  }
  const double freedom = kParts * (static_cast<double>(frames.size()) - 1.0);
  deviation.covariance *= std::max(1.0, squares / std::max(freedom, 1.0));
  for (int k = 0; k < 5; ++k) deviation.covariance(k, k) += kCommon[k] * kCommon[k];
  return deviation;
}

CameraEvidence sum_of(const std::vector<CameraEvidence>& frames) {
  CameraEvidence sum;
  for (const CameraEvidence& frame : frames) sum.add(frame);
  return sum;
}

}  // namespace

CameraDeviation joint_deviation(const std::vector<CameraEvidence>& frames) {
  return joint(sum_of(frames), frames);
}

CameraDeviation joint_beside_strain(std::vector<CameraEvidence> frames) {
  for (CameraEvidence& frame : frames) frame = frame.free_strain(kOwnStretch);
  const CameraEvidence sum = sum_of(frames).free_strain(kFixedStretch);
  for (CameraEvidence& frame : frames) frame = frame.free_strain(kFixedStretch);
  return joint(sum, frames);
}

double joint_stretch(const std::vector<CameraEvidence>& frames) {
  constexpr double kKnown = 1e12;
  CameraEvidence sum = sum_of(frames);
  for (int k = 0; k < 5; ++k) sum.information(k, k) += kKnown;
  const PartMatrix covariance = CameraDeviation::of(sum).covariance;
  const StrainMatrix information =
      sum.strain_information - sum.cross.transpose() * covariance * sum.cross;
  const StrainVector weighted =
      sum.strain_weighted - sum.cross.transpose() * covariance * sum.weighted;
  return 2.0 * information.ldlt().solve(weighted).norm();
}

CameraDeviation joint_centre(std::vector<CameraEvidence> frames) {
  constexpr double kKnown = 1e12;
  for (CameraEvidence& frame : frames) {
    for (const Part part : {kFocal, kAspect, kLens}) frame.information(part, part) += kKnown;
  }
  return joint_deviation(frames);
}

std::array<std::pair<const char*, double>, 10> camera_figures(const CameraDeviation& deviation,
                                                              const Camera& camera) {
  const PartVector stds = deviation.stds();
  return {{{"focal_factor", std::exp(deviation.mean(kFocal))},
           {"focal_std", stds(kFocal)},
           {"aspect_factor", std::exp(2.0 * deviation.mean(kAspect))},
           {"aspect_std", 2.0 * stds(kAspect)},
           {"lens_k1", deviation.mean(kLens)},
           {"lens_k1_std", stds(kLens)},
           {"centre_x_px", camera.fx * deviation.mean(kCentreX)},
           {"centre_x_std_px", camera.fx * stds(kCentreX)},
           {"centre_y_px", camera.fy * deviation.mean(kCentreY)},
           {"centre_y_std_px", camera.fy * stds(kCentreY)}}};
}

std::vector<std::pair<std::string, double>> run_figures(const std::vector<CameraEvidence>& frames,
                                                        const Camera& camera) {
  constexpr std::string_view kCentre = "centre_";
  std::vector<std::pair<std::string, double>> figures{
      {"frames", static_cast<double>(frames.size())}};
  const CameraDeviation together = joint_deviation(frames);
  for (const auto& [name, value] : camera_figures(together, camera)) {
    figures.emplace_back(name, value);
  }
  for (const auto& [name, value] : camera_figures(joint_centre(frames), camera)) {
    const std::string_view of(name);
    if (!of.starts_with(kCentre)) continue;
    figures.emplace_back("centre_alone_" + std::string(of.substr(kCentre.size())), value);
  }
  const double by_side = std::exp(together.mean(kFocal)) * std::sqrt(camera.fx * camera.fy) /
                         static_cast<double>(std::max(camera.width_px, camera.height_px));
  figures.emplace_back("focal_by_side", by_side);
  figures.emplace_back("focal_by_side_std", by_side * joint_beside_strain(frames).stds()(kFocal));
  return figures;
}

}  // namespace weft
