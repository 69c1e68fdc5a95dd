// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/camera.hpp>

#include "pipeline/monitor/camera_evidence.hpp"

namespace weft {

/// Estimate from all frames together. If they contradict each other by more than their covariances,
/// these are too small, and grow. Errors that frames have in common and that do not average out are
/// added.
CameraDeviation joint_deviation(const std::vector<CameraEvidence>& frames);

/// The same if the surface may be stretched in its plane, by up to some 10 % more in one direction
/// than across it. A part of this may be the same in all frames.
CameraDeviation joint_beside_strain(std::vector<CameraEvidence> frames);

/// [] By how much more the surface is stretched in one direction than across it in all frames
/// together, if the camera is as it is given.
double joint_stretch(const std::vector<CameraEvidence>& frames);

/// As joint_deviation(), of the principal point by itself: focal lengths and lens are held as they
/// are given.
CameraDeviation joint_centre(std::vector<CameraEvidence> frames);

/// A deviation by the names of a frame's `setup`: factors, k1, px, each with a standard deviation.
std::array<std::pair<const char*, double>, 10> camera_figures(const CameraDeviation& deviation,
                                                              const Camera& camera);

/// Figures of a run about its camera: `frames`, their number, the figures of joint_deviation(),
/// `centre_alone_*`, those of joint_centre(), and `focal_by_side`. This is the focal length divided
/// by the longer side of the image, for sources that take it without a camera. Its standard
/// deviation `focal_by_side_std` is that of joint_beside_strain().
std::vector<std::pair<std::string, double>> run_figures(const std::vector<CameraEvidence>& frames,
                                                        const Camera& camera);

}  // namespace weft
