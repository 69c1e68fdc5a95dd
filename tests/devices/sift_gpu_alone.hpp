// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cstring>
#include <weft/core/index.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "common/tests/scenes.hpp"

namespace weft::sift_gpu {

using detectors::texture;
using testing::PluginAnswer;
using testing::PluginUnderTest;

inline PluginAnswer detect(PluginUnderTest& plugin, const Image& image) {
  return plugin.process(0, {testing::input("image", image)});
}

/// True if two answers are equal to the bit; false if either has no keypoints.
inline bool same_keypoints(const PluginAnswer& a, const PluginAnswer& b) {
  const auto first = a.get<Keypoints>(), second = b.get<Keypoints>();
  if (a.status != WEFT_OK || b.status != WEFT_OK || !first || !second) return false;
  const auto equal = [](const auto& one, const auto& other) {
    return one.size() == other.size() &&
           std::memcmp(one.data(), other.data(), to_index(one.size()) * sizeof(*one.data())) == 0;
  };
  return first->count() > 0 && equal(first->xy_px, second->xy_px) &&
         equal(first->scale_px, second->scale_px) && equal(first->angle_rad, second->angle_rad) &&
         equal(first->response, second->response) && equal(first->octave, second->octave) &&
         equal(first->descriptors, second->descriptors);
}

}  // namespace weft::sift_gpu
