// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/core/result.hpp>
#include <weft/data/array.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>

namespace weft::flat_reference {

/// Grey levels [H,W] u8 of grey or BGR pixels. It may borrow from `pixels`.
cv::Mat grey_levels(const Array<std::uint8_t>& pixels);

/// The grey image [H,W] u8 as the texture of the template: each texel on the mesh has the bilinear
/// grey level of the pixel where the camera sees its place on the shape, any other texel is 0.
/// Texels are 0 too where that place is behind the camera or outside of the image. Which part of a
/// fold hides another is not examined.
cv::Mat unwarped(const cv::Mat& grey, const Template& templ, const Camera& camera,
                 const Shape& shape);

}  // namespace weft::flat_reference
