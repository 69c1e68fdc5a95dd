// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/keypoints.hpp>

namespace weft::matchers {

/// Random numbers as SIFT gives them: 0 to 255, most of them small.
inline Array<float> random_descriptors(std::int64_t count, std::int64_t length, Rng& rng) {
  Array<float> descriptors({count, length}, 0.0F);
  for (std::int64_t i = 0; i < descriptors.size(); ++i) {
    const double root = rng.uniform(0.0, 1.0);
    descriptors.data()[i] = static_cast<float>(static_cast<int>(255.0 * root * root * root));
  }
  return descriptors;
}

/// Keypoints without descriptors on a grid of 10 px, scale 1, angle 0.
inline Keypoints keypoints_on_grid(std::int64_t count) {
  Keypoints keypoints;
  keypoints.xy_px = Array<double>({count, 2}, 0.0);
  keypoints.scale_px = Array<double>({count}, 0.0);
  keypoints.angle_rad = Array<double>({count}, 0.0);
  keypoints.response = Array<double>({count}, 0.0);
  keypoints.octave = Array<std::int32_t>({count}, 0);
  for (std::int64_t i = 0; i < count; ++i) {
    keypoints.xy_px(i, 0) = 10.0 * static_cast<double>(i % 64);
    keypoints.xy_px(i, 1) = 10.0 * static_cast<double>(i / 64);
    keypoints.scale_px(i) = 1.0;
  }
  return keypoints;
}

inline Keypoints l2_keypoints(Array<float> descriptors) {
  Keypoints keypoints = keypoints_on_grid(descriptors.dim(0));
  keypoints.metric = "l2";
  keypoints.descriptors = std::move(descriptors);
  return keypoints;
}

/// Descriptors written out, all of the same length.
inline Keypoints l2_rows(const std::vector<std::vector<float>>& rows) {
  const auto length = rows.empty() ? 2 : static_cast<std::int64_t>(rows[0].size());
  Array<float> descriptors({static_cast<std::int64_t>(rows.size()), length}, 0.0F);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::copy(rows[i].begin(), rows[i].end(), descriptors.row(static_cast<std::int64_t>(i)));
  }
  return l2_keypoints(std::move(descriptors));
}

inline Array<std::uint8_t> random_bytes(std::int64_t count, std::int64_t length, Rng& rng) {
  Array<std::uint8_t> bytes({count, length}, 0);
  for (std::int64_t i = 0; i < bytes.size(); ++i) {
    bytes.data()[i] = static_cast<std::uint8_t>(rng.below(256));
  }
  return bytes;
}

inline Keypoints hamming_keypoints(Array<std::uint8_t> descriptors) {
  Keypoints keypoints = keypoints_on_grid(descriptors.dim(0));
  keypoints.metric = "hamming";
  keypoints.binary_descriptors = std::move(descriptors);
  return keypoints;
}

}  // namespace weft::matchers
