// SPDX-License-Identifier: Apache-2.0
#include "common/tests/agreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace weft::detectors {
namespace {

using testing::PluginUnderTest;

void expect_agreement(const std::string& params, const Image& image, const std::string& name) {
  PluginUnderTest reference("detectors/sift", params), fast("detectors/sift_fast", params);
  const Keypoints expected = detect(reference, image), found = detect(fast, image);
  ASSERT_GT(expected.count(), 200);
  const Agreement there = agreement(expected, found), back = agreement(found, expected);
  std::printf("%s %s: %d of OpenCV, %d found, agreement %.4f and %.4f, descriptors %.3f\n",
              params.c_str(), name.c_str(), static_cast<int>(expected.count()),
              static_cast<int>(found.count()), there.share, back.share,
              there.descriptor_difference);
  // The rest are extrema that hardly are any: a hundredth of a grey level decides about them.
  EXPECT_GT(there.share, 0.9);
  EXPECT_GT(back.share, 0.9);
  EXPECT_LT(there.descriptor_difference, 3.0);
}

class SiftFastAgainstOpenCv : public ::testing::TestWithParam<const char*> {};

TEST_P(SiftFastAgainstOpenCv, HasTheSameKeypointsAndLikeDescriptorsOnTextures) {
  for (const std::uint64_t seed : {21U, 22U}) {
    expect_agreement(GetParam(), texture(319, 240, seed), "seed " + std::to_string(seed));
  }
}

TEST_P(SiftFastAgainstOpenCv, HasTheSameKeypointsAndLikeDescriptorsOnAPrintedSheet) {
  expect_agreement(GetParam(), image_of_file(WEFT_TEXTURE, 400), "sheet_texture.png");
}

INSTANTIATE_TEST_SUITE_P(Settings, SiftFastAgainstOpenCv,
                         ::testing::Values("{max_keypoints: 0}",
                                           "{max_keypoints: 0, octave_layers: 5}",
                                           "{max_keypoints: 0, sigma_px: 2.4}",
                                           "{max_keypoints: 0, contrast_threshold: 0.01, "
                                           "edge_threshold: 30}"));

TEST(SiftFastOnRecordedData, HasTheSameKeypointsAndLikeDescriptorsAsOpenCv) {
  namespace fs = std::filesystem;
  const char* data = std::getenv("WEFT_DATA");
  const fs::path frames = fs::path(data == nullptr ? "" : data) / "kinect_paper" / "frames";
  if (data == nullptr || !fs::exists(frames)) {
    GTEST_SKIP() << "WEFT_DATA does not name a folder that holds kinect_paper/";
  }
  const std::vector<fs::path> files{fs::directory_iterator(frames), fs::directory_iterator()};
  const fs::path first = *std::min_element(files.begin(), files.end());
  expect_agreement("{max_keypoints: 0}", image_of_file(first, 640), first.filename());
}

}  // namespace
}  // namespace weft::detectors
