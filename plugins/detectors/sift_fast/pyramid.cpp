// SPDX-License-Identifier: Apache-2.0
#include "pyramid.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <new>

namespace weft::sift_fast {
namespace {

constexpr int kLine = 32;  ///< elements of a cache line
/// Allocates large pages, because windows of gradients would span many small ones.
constexpr std::size_t kPage = std::size_t{1} << 21U;
constexpr std::align_val_t kAlignment{kPage};

/// An odd number of lines: the rows of a column spread over the sets of the cache. A vector may
/// write twice its length behind the last pixel.
std::ptrdiff_t stride_of(int width) { return (width + 63) / 64 * 64 + kLine; }

Plane plane_of(int width, int height) { return {nullptr, width, height, stride_of(width)}; }

std::size_t elements(const Plane& plane) {
  return static_cast<std::size_t>(plane.stride * plane.height + 2 * Plane::kGuard);
}

}  // namespace

void Pyramid::Release::operator()(std::int16_t* memory) const {
  ::operator delete[](memory, kAlignment);
}

void Pyramid::resize(int width, int height, bool upsample, int layers) {
  const int enlarged = upsample ? 2 : 1;
  if (image_.width == width && image_.height == height && memory_ != nullptr) return;
  image_ = plane_of(width, height);
  std::size_t needed = elements(image_);
  octaves_ = 0;
  for (int w = enlarged * width, h = enlarged * height; std::min(w, h) > 2 * kBorder;
       w /= 2, h /= 2) {
    if (octaves_ == static_cast<int>(all_.size())) all_.emplace_back();
    Octave& octave = all_[static_cast<std::size_t>(octaves_++)];
    octave.layers.assign(static_cast<std::size_t>(layers), plane_of(w, h));
    needed += static_cast<std::size_t>(layers) * elements(octave.layers.front());
  }
  if (needed > capacity_) {
    memory_.reset();
    const std::size_t bytes = (needed * sizeof(std::int16_t) + kPage - 1) / kPage * kPage;
    memory_.reset(static_cast<std::int16_t*>(::operator new[](bytes, kAlignment)));
    madvise(memory_.get(), bytes, MADV_HUGEPAGE);  // without them it is slower, no more
    std::fill_n(memory_.get(), bytes / sizeof(std::int16_t), std::int16_t{0});
    capacity_ = bytes / sizeof(std::int16_t);
  }
  std::int16_t* next = memory_.get();
  const auto place = [&next](Plane& plane) {
    plane.data = next + Plane::kGuard;
    next += elements(plane);
  };
  place(image_);
  for (int i = 0; i < octaves_; ++i) {
    for (Plane& layer : all_[static_cast<std::size_t>(i)].layers) place(layer);
  }
}

}  // namespace weft::sift_fast
