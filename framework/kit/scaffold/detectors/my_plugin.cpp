// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>
#include <weft/core/stop_check.hpp>
#include <weft/sdk/detector.hpp>

namespace {

using Grey = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // [H,W]
using Patch = Eigen::Array<float, 8, 8, Eigen::RowMajor>;

constexpr int kWindow_px = 5;  ///< side of the square in which a corner's contrast is measured
constexpr int kBlock_px = 2;   ///< side of a block, whose mean is one number of the descriptor
constexpr Eigen::Index kHalfPatch_px = kBlock_px * Patch::RowsAtCompileTime / 2;
constexpr Eigen::Index kBorder_px = kHalfPatch_px + 1;

struct Corner {
  Eigen::Index x = 0, y = 0;
  float contrast = 0.0F;  ///< grey levels per px
};

Grey grey_levels(const weft::Array<std::uint8_t>& pixels) {
  constexpr float kOfBgr[] = {0.114F, 0.587F, 0.299F};
  const int channels = pixels.ndim() == 3 ? 3 : 1;
  Grey grey = Grey::Zero(pixels.dim(0), pixels.dim(1));
  for (Eigen::Index y = 0; y < grey.rows(); ++y) {
    for (Eigen::Index x = 0; x < grey.cols(); ++x) {
      for (int c = 0; c < channels; ++c) {
        const auto level = static_cast<float>(pixels(y, channels * x + c));
        grey(y, x) += channels == 1 ? level : kOfBgr[c] * level;
      }
    }
  }
  return grey;
}

/// Products of the grey levels' derivatives, 0 along the border.
struct Gradients {
  Grey xx, xy, yy;

  explicit Gradients(const Grey& grey) {
    const Eigen::Index height = grey.rows(), width = grey.cols();
    xx = xy = yy = Grey::Zero(height, width);
    for (Eigen::Index y = 1; y + 1 < height; ++y) {
      weft::worked(width);
      for (Eigen::Index x = 1; x + 1 < width; ++x) {
        const float dx = 0.5F * (grey(y, x + 1) - grey(y, x - 1));
        const float dy = 0.5F * (grey(y + 1, x) - grey(y - 1, x));
        xx(y, x) = dx * dx;
        xy(y, x) = dx * dy;
        yy(y, x) = dy * dy;
      }
    }
  }

  /// Root of the smaller eigenvalue of the mean structure tensor: 0 on an edge.
  float contrast_at(Eigen::Index y, Eigen::Index x) const {
    constexpr int kHalf = kWindow_px / 2;
    const auto mean = [&](const Grey& of) {
      return of.block<kWindow_px, kWindow_px>(y - kHalf, x - kHalf).mean();
    };
    const float a = mean(xx), b = mean(xy), c = mean(yy);
    const float smaller = 0.5F * (a + c) - std::sqrt(0.25F * (a - c) * (a - c) + b * b);
    return std::sqrt(std::max(smaller, 0.0F));
  }
};

/// Mean grey levels of 8 x 8 blocks around a corner, less their mean, of length 1.
Patch describe(const Grey& grey, const Corner& corner) {
  Patch patch;
  for (Eigen::Index j = 0; j < patch.rows(); ++j) {
    for (Eigen::Index i = 0; i < patch.cols(); ++i) {
      patch(j, i) = grey.block<kBlock_px, kBlock_px>(corner.y - kHalfPatch_px + kBlock_px * j,
                                                     corner.x - kHalfPatch_px + kBlock_px * i)
                        .mean();
    }
  }
  const float mean = patch.mean();
  patch -= mean;
  const float length = patch.matrix().norm();
  if (length > 0.0F) patch /= length;
  return patch;
}

/// The best corner of each square of the image, described by its neighbourhood as it is.
class MyPluginDetector final : public weft::Detector {
 public:
  static constexpr weft::About kAbout{
      .reference = "reconstruction: Shi and Tomasi, Good features to track, CVPR 1994",
      .reads = "region"};

  explicit MyPluginDetector(weft::Params& p) {
    p.read("cell_px", cell_px_, "px", {4, 1000},
           "side of the squares in which the best corner becomes a keypoint");
    p.read("least_contrast", least_contrast_, "grey levels per px", {0, 255},
           "minimum change of grey level along every direction at a corner");
  }

  weft::Result<weft::Keypoints> detect(const weft::DetectorInput& in) override {
    const weft::Array<std::uint8_t>& pixels = in.image.pixels;
    if (pixels.size() == 0) {
      return weft::Error{weft::Errc::invalid_data, "the image is empty; give at least one pixel"};
    }
    if (in.region &&
        (in.region->mask.dim(0) != pixels.dim(0) || in.region->mask.dim(1) != pixels.dim(1))) {
      return weft::Error{weft::Errc::invalid_data,
                         "the region has another size than the image; give a mask of its size"};
    }
    const Grey grey = grey_levels(pixels);
    const std::vector<Corner> corners = find_corners(grey, in.region);
    weft::Keypoints keypoints = make_keypoints(grey, corners);
    if (corners.empty()) return weft::degenerate(std::move(keypoints), "no corner has contrast");
    return keypoints;
  }

 private:
  std::vector<Corner> find_corners(const Grey& grey,
                                   const std::optional<weft::Region>& region) const {
    const Gradients gradients(grey);
    std::vector<Corner> corners;
    for (Eigen::Index top = kBorder_px; top < grey.rows() - kBorder_px; top += cell_px_) {
      for (Eigen::Index left = kBorder_px; left < grey.cols() - kBorder_px; left += cell_px_) {
        Corner best{0, 0, static_cast<float>(least_contrast_)};
        const Eigen::Index bottom = std::min(top + cell_px_, grey.rows() - kBorder_px);
        const Eigen::Index right = std::min(left + cell_px_, grey.cols() - kBorder_px);
        for (Eigen::Index y = top; y < bottom; ++y) {
          weft::worked(5 * (right - left));
          for (Eigen::Index x = left; x < right; ++x) {
            if (region && region->mask(y, x) == 0) continue;
            const float contrast = gradients.contrast_at(y, x);
            if (contrast > best.contrast) best = {x, y, contrast};
          }
        }
        if (best.x > 0) corners.push_back(best);
      }
    }
    return corners;
  }

  static weft::Keypoints make_keypoints(const Grey& grey, const std::vector<Corner>& corners) {
    const std::int64_t count = std::ssize(corners);
    weft::Keypoints keypoints;
    keypoints.xy_px = weft::Array<double>({count, 2});
    keypoints.scale_px = weft::Array<double>({count}, kBlock_px);
    keypoints.angle_rad = weft::Array<double>({count}, 0.0);
    keypoints.response = weft::Array<double>({count});
    keypoints.octave = weft::Array<std::int32_t>({count}, 0);
    keypoints.metric = "l2";
    keypoints.descriptors = weft::Array<float>({count, Patch::SizeAtCompileTime});
    std::int64_t k = 0;
    for (const Corner& corner : corners) {
      keypoints.xy_px(k, 0) = static_cast<double>(corner.x);
      keypoints.xy_px(k, 1) = static_cast<double>(corner.y);
      keypoints.response(k) = static_cast<double>(corner.contrast);
      const Patch patch = describe(grey, corner);
      std::copy_n(patch.data(), patch.size(), keypoints.descriptors.row(k));
      ++k;
    }
    return keypoints;
  }

  int cell_px_ = 16;
  double least_contrast_ = 4.0;
};

}  // namespace

WEFT_PLUGIN(MyPluginDetector, "detectors/my_plugin", "1.0.0",
            "Detects the best corner of each square of the image.")
