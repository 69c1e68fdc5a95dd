// SPDX-License-Identifier: Apache-2.0
#include "common/pictures/picture.hpp"

#include <cstring>
#include <weft/core/stop_check.hpp>

namespace weft::pictures {
namespace {

/// ITU-R BT.601
float grey_of(const std::uint8_t* bgr) {
  return 0.114F * static_cast<float>(bgr[0]) + 0.587F * static_cast<float>(bgr[1]) +
         0.299F * static_cast<float>(bgr[2]);
}

void grey_row_plain(const std::uint8_t* __restrict in, float* __restrict out, int from, int width) {
  for (int x = from; x < width; ++x) out[x] = grey_of(in + 3 * x);
}

#ifdef __x86_64__
/// The same numbers, four pixels at once; loads are 16 bytes long.
[[gnu::target("ssse3")]] void grey_row_ssse3(const std::uint8_t* __restrict in,
                                             float* __restrict out, int from, int width) {
  typedef std::uint8_t Bytes __attribute__((vector_size(16)));
  typedef std::int32_t Whole __attribute__((vector_size(16)));
  typedef float Four __attribute__((vector_size(16)));
  const Bytes none{};
  int x = from;
  for (; x + 6 <= width; x += 4) {
    Bytes bytes;
    std::memcpy(&bytes, in + 3 * x, sizeof bytes);
    const auto blue = reinterpret_cast<Whole>(__builtin_shufflevector(
        bytes, none, 0, 16, 16, 16, 3, 16, 16, 16, 6, 16, 16, 16, 9, 16, 16, 16));
    const auto green = reinterpret_cast<Whole>(__builtin_shufflevector(
        bytes, none, 1, 16, 16, 16, 4, 16, 16, 16, 7, 16, 16, 16, 10, 16, 16, 16));
    const auto red = reinterpret_cast<Whole>(__builtin_shufflevector(
        bytes, none, 2, 16, 16, 16, 5, 16, 16, 16, 8, 16, 16, 16, 11, 16, 16, 16));
    const Four grey = 0.114F * __builtin_convertvector(blue, Four) +
                      0.587F * __builtin_convertvector(green, Four) +
                      0.299F * __builtin_convertvector(red, Four);
    std::memcpy(out + x, &grey, sizeof grey);
  }
  grey_row_plain(in, out, x, width);
}
const auto kGreyRow = __builtin_cpu_supports("ssse3") ? grey_row_ssse3 : grey_row_plain;
#else
const auto kGreyRow = grey_row_plain;
#endif

}  // namespace

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
    kGreyRow(in, out, 0, grey.width);
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
