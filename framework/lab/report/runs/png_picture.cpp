// SPDX-License-Identifier: Apache-2.0
#include "lab/report/runs/png_picture.hpp"

#include <png.h>

#include <algorithm>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::lab {
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

/// Rows of `channels` bytes a pixel, without gaps.
struct PngPixels {
  std::int64_t width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> values;
};

/// The mean of the block of `step` x `step` pixels that begins at (x, y), cut off at the border.
std::uint8_t mean_of_block(const PngPixels& pixels, std::int64_t x, std::int64_t y,
                           std::int64_t channel, std::int64_t step) {
  std::int64_t sum = 0, count = 0;
  for (std::int64_t v = y; v < std::min(y + step, pixels.height); ++v) {
    for (std::int64_t u = x; u < std::min(x + step, pixels.width); ++u, ++count) {
      sum += pixels.values[to_index((v * pixels.width + u) * pixels.channels + channel)];
    }
  }
  return static_cast<std::uint8_t>((sum + count / 2) / count);
}

PngPixels mean_blocks(const PngPixels& pixels, std::int64_t most_px) {
  const std::int64_t step =
      std::max<std::int64_t>(1, (std::max(pixels.width, pixels.height) + most_px - 1) / most_px);
  PngPixels small{
      (pixels.width + step - 1) / step, (pixels.height + step - 1) / step, pixels.channels, {}};
  for (std::int64_t y = 0; y < pixels.height; y += step) {
    for (std::int64_t x = 0; x < pixels.width; x += step) {
      for (std::int64_t c = 0; c < pixels.channels; ++c) {
        small.values.push_back(mean_of_block(pixels, x, y, c, step));
      }
    }
  }
  return small;
}

std::string encoded_png(const PngPixels& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(pixels.width);
  image.height = static_cast<png_uint_32>(pixels.height);
  image.format = pixels.channels == 1 ? PNG_FORMAT_GRAY : PNG_FORMAT_BGR;
  png_alloc_size_t bytes = 0;
  const auto write = [&](void* memory) {
    return png_image_write_to_memory(&image, memory, &bytes, 0, pixels.values.data(), 0, nullptr);
  };
  if (write(nullptr) == 0) return "";
  std::string png(bytes, '\0');
  if (write(png.data()) == 0) return "";
  png.resize(bytes);
  return png;
}

}  // namespace

std::string png_of(const Array<std::uint8_t>& pixels, std::int64_t most_px) {
  const bool is_colour = pixels.ndim() == 3 && pixels.dim(2) == 3;
  if ((pixels.ndim() != 2 && !is_colour) || pixels.size() == 0) return "";
  PngPixels whole{pixels.dim(1), pixels.dim(0), is_colour ? 3 : 1, {}};
  for (std::int64_t y = 0; y < whole.height; ++y) {
    const std::uint8_t* row = pixels.row(y);
    whole.values.insert(whole.values.end(), row, row + whole.width * whole.channels);
  }
  return encoded_png(mean_blocks(whole, most_px));
}

std::string smaller_png(const std::string& png, std::int64_t most_px) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, png.data(), png.size()) == 0) return "";
  const bool is_grey = (image.format & PNG_FORMAT_FLAG_COLOR) == 0;
  PngPixels pixels{image.width, image.height, is_grey ? 1 : 3, {}};
  image.format = is_grey ? PNG_FORMAT_GRAY : PNG_FORMAT_BGR;
  if (pixels.width * pixels.height > kMostPixels) {
    png_image_free(&image);
    return "";
  }
  pixels.values.resize(PNG_IMAGE_SIZE(image));
  const png_color white{255, 255, 255};
  const int read = png_image_finish_read(&image, &white, pixels.values.data(), 0, nullptr);
  return read == 0 ? "" : encoded_png(mean_blocks(pixels, most_px));
}

}  // namespace weft::lab
