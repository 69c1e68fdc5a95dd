// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>

#include "session.hpp"
#include "tests/adversarial_images.hpp"
#include "tests/kernel_runner.hpp"

namespace weft::sift_gpu {
namespace {

using reference::kRoundoff;
using reference::Plane;

constexpr std::uint64_t kImageSeed = 41;
const auto kGuardOffset = static_cast<cl_ulong>(Guarded::kGuard);

std::vector<std::uint8_t> bytes_of(const Plane& plane) {
  std::vector<std::uint8_t> bytes;
  for (const double value : plane.reshaped<Eigen::RowMajor>()) {
    bytes.push_back(static_cast<std::uint8_t>(value));
  }
  return bytes;
}

double largest_difference(const std::vector<float>& found, const Plane& expected) {
  const Plane plane = reference::plane_of(found.data(), static_cast<int>(expected.cols()),
                                          static_cast<int>(expected.rows()));
  const double largest = (plane - expected).cwiseAbs().maxCoeff();
  return plane.hasNaN() ? std::numeric_limits<double>::infinity() : largest;
}

/// The images of a size on which each kernel of the scale space is run.
class ScaleSpaceKernels : public ::testing::TestWithParam<Size> {
 protected:
  ScaleSpaceKernels() { std::printf("noise from seed %d\n", static_cast<int>(kImageSeed)); }

  Size size() const { return GetParam(); }
  auto images() const { return adversarial_images(size(), kImageSeed); }
  std::size_t pixels() const { return to_index(size().width) * to_index(size().height); }

  std::vector<float> grey_levels(const std::vector<std::uint8_t>& image, int channels, bool twice) {
    const int factor = twice ? 2 : 1;
    const cl::Buffer from = runner_.upload(image);
    const Guarded to(pixels() * to_index(factor * factor));
    const cl::Buffer levels = runner_.upload(to.all());
    runner_.over_pixels("grey_levels", factor * size().width, factor * size().height, from,
                        size().width, size().height, channels, twice ? 1 : 0, levels, kGuardOffset);
    return Guarded::inside(runner_.download<float>(levels, to.all().size()));
  }

  std::vector<float> blur(const std::vector<float>& image, const std::vector<float>& taps,
                          bool rows, bool columns) {
    const auto width = size().width, height = size().height;
    const auto radius = static_cast<int>(taps.size()) - 1;
    const cl::Buffer gaussian = runner_.upload(Guarded(taps).all());
    const int first_tap = static_cast<int>(Guarded::kGuard);
    const Guarded from(image);
    const std::size_t count = from.all().size();
    cl::Buffer levels = runner_.upload(from.all());
    cl::Buffer between = runner_.upload(std::vector<float>(image));
    if (rows) {
      runner_.over_pixels("blur_rows", width, height, levels, kGuardOffset, width, height, gaussian,
                          first_tap, radius, between);
    }
    if (columns) {
      levels = runner_.upload(Guarded(image.size()).all());
      runner_.over_pixels("blur_columns", width, height, between, width, height, gaussian,
                          first_tap, radius, levels, kGuardOffset);
      return Guarded::inside(runner_.download<float>(levels, count));
    }
    return runner_.download<float>(between, image.size());
  }

  KernelRunner runner_;
};

TEST_P(ScaleSpaceKernels, GreyLevelsAreThoseOfTheImage) {
  for (const auto& [name, image] : images()) {
    EXPECT_EQ(grey_levels(bytes_of(image), 1, false), reference::floats_of(image)) << name;
  }
}

TEST_P(ScaleSpaceKernels, DoublingIsLinearBetweenPixelCentresWithoutRounding) {
  for (const auto& [name, image] : images()) {
    const std::vector<float> found = grey_levels(bytes_of(image), 1, true);
    EXPECT_EQ(found, reference::floats_of(reference::doubled(image))) << name;

    std::vector<float> once = reference::floats_of(image);
    cv::Mat resized;
    cv::resize(cv::Mat(size().height, size().width, CV_32F, once.data()), resized, {}, 2.0, 2.0,
               cv::INTER_LINEAR);
    EXPECT_EQ(found, std::vector<float>(resized.begin<float>(), resized.end<float>())) << name;
  }
}

TEST_P(ScaleSpaceKernels, ColourIsWeightedAsOpenCvDoes) {
  const Plane blue = white_noise(size(), kImageSeed), green = white_noise(size(), kImageSeed + 1),
              red = white_noise(size(), kImageSeed + 2);
  std::vector<std::uint8_t> colour;
  for (Eigen::Index y = 0; y < blue.rows(); ++y) {
    for (Eigen::Index x = 0; x < blue.cols(); ++x) {
      for (const Plane* channel : {&blue, &green, &red}) {
        colour.push_back(static_cast<std::uint8_t>((*channel)(y, x)));
      }
    }
  }
  const std::vector<float> found = grey_levels(colour, 3, false);
  // Whole numbers, and weights of 15 bits.
  EXPECT_LE(largest_difference(found, 0.114 * blue + 0.587 * green + 0.299 * red), 0.52);
  cv::Mat grey;
  cv::cvtColor(cv::Mat(size().height, size().width, CV_8UC3, colour.data()), grey,
               cv::COLOR_BGR2GRAY);
  EXPECT_EQ(found, std::vector<float>(grey.begin<std::uint8_t>(), grey.end<std::uint8_t>()));

  const Plane plane = reference::plane_of(found.data(), size().width, size().height);
  EXPECT_EQ(grey_levels(colour, 3, true), reference::floats_of(reference::doubled(plane)));
}

TEST_P(ScaleSpaceKernels, BlursAreConvolutionsWithAMirroredBorder) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  double largest = 0.0;
  for (const int radius : {0, 2, 7, 40}) {
    const Eigen::VectorXd weights = reference::gaussian(0.3 * radius + 0.1, radius);
    const Eigen::VectorXf taps = weights.tail(radius + 1).cast<float>();
    const std::vector<float> half(taps.begin(), taps.end());
    // Each sum of products of numbers up to 255 with weights whose sum is 1 is rounded radius + 4
    // times at most, tap and addends included.
    const double tolerance = 255.0 * (radius + 4) * kRoundoff;
    for (const auto& [name, image] : images()) {
      const std::vector<float> levels = reference::floats_of(image);
      const double rows = largest_difference(blur(levels, half, true, false),
                                             reference::convolved(image, one, weights));
      const double columns = largest_difference(blur(levels, half, false, true),
                                                reference::convolved(image, weights, one));
      EXPECT_LE(rows, tolerance) << name << ", radius " << radius;
      EXPECT_LE(columns, tolerance) << name << ", radius " << radius;
      largest = std::max({largest, rows, columns});
      if (radius > 7 && pixels() > 1000) continue;  // 81 x 81 products a pixel
      const double both = largest_difference(blur(levels, half, true, true),
                                             reference::convolved(image, weights, weights));
      EXPECT_LE(both, 2.0 * tolerance) << name << ", radius " << radius;
      largest = std::max(largest, both);
    }
  }
  std::printf("largest difference of a blur: %.2g grey levels\n", largest);
}

class Halving : public ScaleSpaceKernels {};

TEST_P(Halving, TakesEverySecondPixel) {
  const int width = size().width / 2, height = size().height / 2;
  for (const auto& [name, image] : images()) {
    // One pyramid: the image, then a guard, the half and another guard.
    std::vector<float> pyramid = Guarded(reference::floats_of(image)).all();
    const std::size_t begin = pyramid.size() - Guarded::kGuard;
    const std::size_t half = to_index(width) * to_index(height);
    const Guarded place(half);
    pyramid.insert(pyramid.end(), place.all().begin() + Guarded::kGuard, place.all().end());
    const cl::Buffer buffer = runner_.upload(pyramid);
    runner_.over_pixels("halve", width, height, buffer, kGuardOffset, size().width,
                        static_cast<cl_ulong>(begin + Guarded::kGuard), width, height);
    const std::vector<float> written = runner_.download<float>(buffer, pyramid.size());
    EXPECT_EQ(
        Guarded::inside({written.begin() + static_cast<std::ptrdiff_t>(begin), written.end()}),
        reference::floats_of(reference::halved(image)))
        << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Halving,
                         ::testing::Values(Size{2, 2}, Size{7, 2}, Size{13, 17}, Size{8192, 3},
                                           Size{3, 8192}));

INSTANTIATE_TEST_SUITE_P(Sizes, ScaleSpaceKernels, ::testing::ValuesIn(kAdversarialSizes));

class WholePyramid : public ::testing::TestWithParam<Settings> {};

TEST_P(WholePyramid, IsThatOfTheReferenceInEveryLayer) {
  const auto device = Device::open("");
  ASSERT_TRUE(device);
  for (const Size size : {Size{47, 33}, Size{16, 64}}) {
    const Plane image = white_noise(size, kImageSeed);
    Array<std::uint8_t> pixels({size.height, size.width}, 0);
    std::ranges::copy(bytes_of(image), pixels.data());
    Session session(*device, size.width, size.height, 1, GetParam());
    session.find(pixels, [] { return false; });
    const auto expected = reference::pyramid(image, GetParam());
    EXPECT_EQ(ScalePlan(size.width, size.height, GetParam()).octaves.size(), expected.size());
    double largest = 0.0;
    for (std::size_t o = 0; o < expected.size(); ++o) {
      const std::vector<float> layers = session.octave(o);
      const auto layer_size = to_index(expected[o].front().size());
      ASSERT_EQ(layers.size(), expected[o].size() * layer_size);
      for (std::size_t l = 0; l < expected[o].size(); ++l) {
        const auto begin = layers.begin() + static_cast<std::ptrdiff_t>(l * layer_size);
        const std::vector<float> layer(begin, begin + static_cast<std::ptrdiff_t>(layer_size));
        largest = std::max(largest, largest_difference(layer, expected[o][l]));
      }
    }
    std::printf("%d x %d, %zu octaves from seed %d: largest difference %.2g grey levels\n",
                size.width, size.height, expected.size(), static_cast<int>(kImageSeed), largest);
    // A hundredth of the weakest difference of layers that counts at usual thresholds.
    EXPECT_LT(largest, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Settings, WholePyramid,
                         ::testing::Values(Settings{}, Settings{.upsample = false},
                                           Settings{.octave_layers = 5, .sigma_px = 2.4},
                                           Settings{.octave_layers = 1, .sigma_px = 1.0}));

}  // namespace
}  // namespace weft::sift_gpu
