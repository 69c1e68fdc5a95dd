// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace weft::sift_fast {

/// Grey levels are whole numbers, (grey - 128) * kUnit: the sum of two fits into 16 bits.
constexpr int kUnit = 128;

/// Rows of grey levels. A row may be read and written from kGuard before its begin to kGuard behind
/// its stride: what is there has no meaning.
struct Plane {
  static constexpr int kGuard = 320;

  std::int16_t* data = nullptr;
  int width = 0, height = 0;
  std::ptrdiff_t stride = 0;  ///< elements between rows: an odd number of cache lines

  std::int16_t* row(int y) const { return data + y * stride; }
  std::int16_t at(int x, int y) const { return row(y)[x]; }
};

/// Layers of one size, each blurred more than the one before.
struct Octave {
  std::vector<Plane> layers;
  int width() const { return layers.front().width; }
  int height() const { return layers.front().height; }
};

/// Memory of the image and of all octaves. It only grows.
class Pyramid {
 public:
  /// No extremum is looked for nearer to the border, px of its octave.
  static constexpr int kBorder = 5;

  /// The octaves for an image of this size, of `layers` layers each. They start from the image
  /// itself or from the image enlarged twice, and continue as long as they are large enough to
  /// contain an extremum.
  void resize(int width, int height, bool upsample, int layers);

  const Plane& image() const { return image_; }
  int octaves() const { return octaves_; }
  const Octave& octave(int index) const { return all_[static_cast<std::size_t>(index)]; }

 private:
  struct Release {
    void operator()(std::int16_t* memory) const;
  };

  Plane image_;
  std::vector<Octave> all_;  ///< more than `octaves_` after a larger image
  int octaves_ = 0;
  std::unique_ptr<std::int16_t[], Release> memory_;
  std::size_t capacity_ = 0;
};

}  // namespace weft::sift_fast
