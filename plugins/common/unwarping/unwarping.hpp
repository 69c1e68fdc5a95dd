// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/core/result.hpp>
#include <weft/data/array.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>

/// Images mapped back onto the flat texture of a template.
namespace weft::unwarping {

/// Grey levels [H,W] u8 of grey or BGR pixels.
cv::Mat grey_levels(const Array<std::uint8_t>& pixels);

/// An image [H,W] or [H,W,3] u8 as the texture of the template. Each texel on the mesh has the
/// bilinear value of the pixel where the camera sees its place on the shape. Any other texel is 0.
/// Texels are 0 too where that place is behind the camera or outside of the image. Which part of a
/// fold hides another is not examined.
cv::Mat unwarped(const cv::Mat& image, const Template& templ, const Camera& camera,
                 const Shape& shape);

/// Checks what unwarped() needs: pixels, a texture, at most 32766 px along each axis of both, a
/// shape of the template's vertices, and faces of vertices that exist.
Result<void> check_unwarping(const Template& templ, const Image& image, const Shape& shape);

/// A copy of the pixels of a record as a matrix [H,W] or [H,W,3] u8.
cv::Mat matrix_of(const Array<std::uint8_t>& pixels);

}  // namespace weft::unwarping
