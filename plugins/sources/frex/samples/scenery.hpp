// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/camera.hpp>

#include "backdrop.hpp"

namespace weft::frex {

/// Backgrounds for independent images: plain and cluttered tables, and the photographs of a folder.
class Scenery {
 public:
  /// `folder` may be empty. Fails if it cannot be read or holds no image.
  static Result<Scenery> create(const Camera& camera, const std::string& folder,
                                std::uint64_t seed);

  /// One of them, mirrored, brightened and tinted at random.
  Picture draw(Rng& rng) const;

 private:
  std::vector<Picture> pictures_;
};

}  // namespace weft::frex
