// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>

namespace weft::view {

/// Checks that the image has the camera's size and is grey or BGR, and that the shape, called
/// `named`, fits the template. The Error suggests what to change.
Result<void> check_frame(const Image& image, const Camera& camera, const Template& templ,
                         const Shape& shape, const char* named);

/// Checks that the texture is at least as large as a patch.
Result<void> check_texture(const Template& templ);

}  // namespace weft::view
