// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>

namespace weft::cameras {

enum class Distortion { none, brown, fisheye };

/// A calibrated camera as its file describes it: the pinhole of the ideal image and how the lens
/// departs from it. With x = X/Z, y = Y/Z, r^2 = x^2 + y^2 and theta = atan r:
///   brown    x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
///                 + 2 p1 x y + p2 (r^2 + 2 x^2), y' alike
///   fisheye  x' = x / r * theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), y' alike
struct CameraFile {
  Camera camera;
  Distortion model = Distortion::none;
  std::vector<double> coefficients;  ///< brown: k1 k2 p1 p2 k3, then k4 k5 k6; fisheye: k1 to k4
};

/// Reads a camera file: Weft's own (YAML or JSON: fx fy cx cy width height distortion) or one of
/// the formats in README.md. Fails with a message that names the file, the line and the key.
Result<CameraFile> read_camera_file(const std::string& path);

/// Where the camera shows what the ideal pinhole has at a pixel, px.
Eigen::Vector2d seen_px(const CameraFile& file, const Eigen::Vector2d& ideal_px);

/// Share of the ideal image that the camera's image shows, by probes.
double shown_share(const CameraFile& file);

}  // namespace weft::cameras
