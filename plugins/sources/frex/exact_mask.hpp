// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/image.hpp>

#include "common/scene/sheet_renderer.hpp"

namespace weft::frex {

/// The exact mask of a rendered surface: the foreground is the share of each pixel that shows it.
/// Pixels of an occluder, and those less than three pixels from one, are unknown.
ObjectMask exact_mask(const scene::View& view);

}  // namespace weft::frex
