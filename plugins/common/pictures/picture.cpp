// SPDX-License-Identifier: Apache-2.0
#include "common/pictures/picture.hpp"

#include <weft/core/stop_check.hpp>

namespace weft::pictures {

void read_grey(const Array<std::uint8_t>& pixels, Picture& grey) {
  grey.resize(static_cast<int>(pixels.dim(1)), static_cast<int>(pixels.dim(0)));
  const bool has_colours = pixels.ndim() == 3 && pixels.dim(2) == 3;
  const bool has_one_channel = pixels.ndim() == 2 || pixels.dim(2) == 1;
  const auto channels = has_one_channel ? 1 : static_cast<int>(pixels.dim(2));
  for (int y = 0; y < grey.height; ++y) {
    worked(grey.width);
    const std::uint8_t* __restrict in = pixels.row(y);
    float* __restrict out = grey.row(y);
    if (!has_colours) {
      for (int x = 0; x < grey.width; ++x) out[x] = static_cast<float>(in[channels * x]);
      continue;
    }
    // ITU-R BT.601
    for (int x = 0; x < grey.width; ++x) {
      out[x] = 0.114F * static_cast<float>(in[3 * x]) + 0.587F * static_cast<float>(in[3 * x + 1]) +
               0.299F * static_cast<float>(in[3 * x + 2]);
    }
  }
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

void Picture::resize(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  values.resize(to_index(width) * to_index(height) + kSpare);
}

void Pyramid::load(const Array<std::uint8_t>& pixels, int most, int smallest_px) {
  if (pictures_.size() < to_index(most)) pictures_.resize(to_index(most));
  read_grey(pixels, pictures_[0]);
  levels_ = 1;
  while (levels_ < most && pictures_[to_index(levels_ - 1)].width >= 2 * smallest_px &&
         pictures_[to_index(levels_ - 1)].height >= 2 * smallest_px) {
    halve(pictures_[to_index(levels_ - 1)], pictures_[to_index(levels_)]);
    ++levels_;
  }
}

}  // namespace weft::pictures
