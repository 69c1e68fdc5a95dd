// SPDX-License-Identifier: Apache-2.0
#include "common/view/inputs.hpp"

#include <cstdint>
#include <string>

#include "common/view/patch.hpp"

namespace weft::view {

Result<void> check_frame(const Image& image, const Camera& camera, const Template& templ,
                         const Shape& shape, const char* named) {
  const Array<std::uint8_t>& pixels = image.pixels;
  const bool has_size =
      pixels.dim(0) == camera.height_px && pixels.dim(1) == camera.width_px && pixels.rows() > 0;
  if (!has_size || (pixels.ndim() == 3 && pixels.dim(2) != 3)) {
    return Error{Errc::invalid_data,
                 "the image must have the size of the camera and one or three channels"};
  }
  if (shape.vertices_m.rows() != templ.flat_px.rows()) {
    return Error{Errc::invalid_data,
                 std::string(named) + " must have as many vertices as the template"};
  }
  return {};
}

Result<void> check_texture(const Template& templ) {
  if (templ.texture.dim(0) >= Patch::kSide && templ.texture.dim(1) >= Patch::kSide) return {};
  return Error{Errc::invalid_data, "the texture must have at least " +
                                       std::to_string(Patch::kSide) + " px along each side"};
}

}  // namespace weft::view
