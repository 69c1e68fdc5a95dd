// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/template_map.hpp"

#include <algorithm>
#include <cmath>
#include <weft/data/matrix.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/object_box.hpp>

namespace weft {
namespace {

/// Rows `top` to `bottom` and columns `left` to `right`, without the last of them.
struct PixelBox {
  std::int64_t left, right, top, bottom;
};

Array<std::uint8_t> part_of(const Array<std::uint8_t>& picture, const PixelBox& box) {
  const std::int64_t channels = picture.dim(2);
  const std::int64_t height = box.bottom - box.top, width = box.right - box.left;
  Array<std::uint8_t> part = picture.ndim() == 3 ? Array<std::uint8_t>({height, width, channels})
                                                 : Array<std::uint8_t>({height, width});
  for (std::int64_t y = 0; y < height; ++y) {
    const std::uint8_t* first = picture.row(box.top + y) + box.left * channels;
    std::copy(first, first + width * channels, part.row(y));
  }
  return part;
}

}  // namespace

Result<PlacesOnMesh> places_on_mesh(const Template& from, const Template& onto) {
  const auto locator = FaceLocator::create(onto.flat_px.matrix<2>(), onto.faces.matrix<3>());
  if (!locator) return locator.error();
  const std::int64_t count = from.flat_px.rows();
  PlacesOnMesh places{Array<std::int32_t>({count}), Array<double>({count, 3})};
  for (std::int64_t v = 0; v < count; ++v) {
    const FaceLocation at = locator->locate({from.flat_px(v, 0), from.flat_px(v, 1)});
    places.face(v) = at.face;
    for (int k = 0; k < 3; ++k) places.weights(v, k) = at.weights(k);
  }
  return places;
}

Template with_cropped_texture(const Template& templ, double margin_px) {
  const TextureBox object = object_box(templ).grown(margin_px);
  const std::int64_t height = templ.texture.dim(0), width = templ.texture.dim(1);
  const auto clamped = [](double border_px, std::int64_t most) {
    return std::clamp<std::int64_t>(std::llround(border_px + 0.5), 0, most);
  };
  const PixelBox box{clamped(object.u0, width), clamped(object.u1, width),
                     clamped(object.v0, height), clamped(object.v1, height)};
  Template cropped = templ;
  cropped.texture = part_of(templ.texture, box);
  cropped.mask = part_of(templ.mask, box);
  cropped.flat_px = Array<double>({templ.flat_px.rows(), 2});
  for (std::int64_t v = 0; v < templ.flat_px.rows(); ++v) {
    cropped.flat_px(v, 0) = templ.flat_px(v, 0) - static_cast<double>(box.left);
    cropped.flat_px(v, 1) = templ.flat_px(v, 1) - static_cast<double>(box.top);
  }
  return cropped;
}

}  // namespace weft
