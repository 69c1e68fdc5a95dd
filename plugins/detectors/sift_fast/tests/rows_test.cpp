// SPDX-License-Identifier: Apache-2.0
#include "rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>

#include "common/tests/scenes.hpp"
#include "kernels.hpp"
#include "pyramid.hpp"
#include "search.hpp"

namespace weft::sift_fast {
namespace {

/// Grey levels 0 to 255 of a plane.
cv::Mat grey_levels(const Plane& plane) {
  cv::Mat grey(plane.height, plane.width, CV_64F);
  for (int y = 0; y < plane.height; ++y) {
    for (int x = 0; x < plane.width; ++x) {
      grey.at<double>(y, x) = static_cast<double>(plane.at(x, y)) / kUnit + 128.0;
    }
  }
  return grey;
}

/// A Gaussian of five sigmas.
cv::Mat blurred(const cv::Mat& grey, double sigma_px) {
  cv::Mat result;
  const int side = 2 * static_cast<int>(std::ceil(5.0 * sigma_px)) + 1;
  cv::GaussianBlur(grey, result, {side, side}, sigma_px, sigma_px, cv::BORDER_REFLECT_101);
  return result;
}

TEST(Rows, MakeLayersOfTheRightBlurToAFewHundredthsOfAGreyLevel) {
  for (const bool upsample : {true, false}) {
    Settings settings;
    settings.upsample = upsample;
    const Blurs blurs(settings);
    Pyramid pyramid;
    const Image image = detectors::texture(230, 170, 51);
    pyramid.resize(230, 170, upsample, blurs.layers);
    RowScratch scratch;
    load_rows(image.pixels.data(), image.pixels.row_stride(), pyramid.image(), {0, 170});
    const std::vector<Plane>& layers = pyramid.octave(0).layers;
    const RowRange all{0, layers[0].height};
    if (upsample) {
      double_rows(pyramid.image(), blurs.doubling, layers[0], all, scratch);
    } else {
      blur_rows(pyramid.image(), blurs.first, layers[0], all, scratch);
    }
    cv::Mat source = grey_levels(pyramid.image());
    if (upsample) cv::resize(source, source, {}, 2.0, 2.0, cv::INTER_LINEAR);
    const double had = upsample ? 1.0 : 0.5;
    for (int l = 0; l < blurs.layers; ++l) {
      if (l > 0) {
        blur_rows(layers[to_index(l - 1)], blurs.steps[to_index(l)], layers[to_index(l)], all,
                  scratch);
      }
      const double sigma = 1.6 * std::exp2(l / 3.0);
      const cv::Mat inner =
          grey_levels(layers[to_index(l)]) - blurred(source, std::sqrt(sigma * sigma - had * had));
      // Borders are mirrored otherwise.
      const int border = 24;
      const cv::Mat part =
          inner(cv::Rect(border, border, inner.cols - 2 * border, inner.rows - 2 * border));
      cv::Scalar mean, deviation;
      cv::meanStdDev(part, mean, deviation);
      std::printf("upsample %d layer %d: error %.4f +- %.4f grey levels\n", upsample ? 1 : 0, l,
                  mean[0], deviation[0]);
      EXPECT_LT(std::abs(mean[0]), 0.02);
      EXPECT_LT(deviation[0], 0.05);
    }
  }
}

}  // namespace
}  // namespace weft::sift_fast
