// SPDX-License-Identifier: Apache-2.0
#include "common/view/picture.hpp"

#include <weft/core/stop_check.hpp>

namespace weft::view {

void Picture::resize(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  values.resize(to_index(width) * to_index(height) + kLanes);
}

void halve(const Picture& from, Picture& to) {
  to.resize(from.width / 2, from.height / 2);
  for (int y = 0; y < to.height; ++y) {
    worked(to.width);
    const float* __restrict above = from.row(2 * y);
    const float* __restrict below = from.row(2 * y + 1);
    float* __restrict out = to.row(y);
    for (int x = 0; x < to.width; ++x) {
      out[x] = 0.25F * ((above[2 * x] + above[2 * x + 1]) + (below[2 * x] + below[2 * x + 1]));
    }
  }
}

void read_grey(const Array<std::uint8_t>& pixels, Picture& grey) {
  grey.resize(static_cast<int>(pixels.dim(1)), static_cast<int>(pixels.dim(0)));
  const bool has_colours = pixels.ndim() == 3 && pixels.dim(2) == 3;
  for (int y = 0; y < grey.height; ++y) {
    worked(grey.width);
    const std::uint8_t* __restrict in = pixels.row(y);
    float* __restrict out = grey.row(y);
    if (!has_colours) {
      for (int x = 0; x < grey.width; ++x) out[x] = static_cast<float>(in[x]);
      continue;
    }
    // ITU-R BT.601
    for (int x = 0; x < grey.width; ++x) {
      out[x] = 0.114F * static_cast<float>(in[3 * x]) + 0.587F * static_cast<float>(in[3 * x + 1]) +
               0.299F * static_cast<float>(in[3 * x + 2]);
    }
  }
}

void Pyramid::load(const Array<std::uint8_t>& pixels) {
  read_grey(pixels, levels_[0]);
  for (std::size_t k = 1; k < levels_.size(); ++k) halve(levels_[k - 1], levels_[k]);
}

}  // namespace weft::view
