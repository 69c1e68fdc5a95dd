// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>

namespace weft::view {

/// Whether the image is the camera's, grey or BGR, and the shape, `named` so, the template's. The
/// Error says what to change.
Result<void> check_frame(const Image& image, const Camera& camera, const Template& templ,
                         const Shape& shape, const char* named);

/// Whether the texture is as large as a patch.
Result<void> check_texture(const Template& templ);

}  // namespace weft::view
