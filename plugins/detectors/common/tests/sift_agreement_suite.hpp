// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "common/tests/agreement.hpp"

namespace weft::detectors {

/// A detector and how much alike to detectors/sift it must be.
struct LikeSift {
  const char* id;
  double share;                  ///< least, of the keypoints of both
  double descriptor_difference;  ///< largest
};

/// A test program instantiates it with its detector, and with kSiftSettings.
class SiftAgreement : public ::testing::TestWithParam<std::tuple<LikeSift, const char*>> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SiftAgreement);

inline constexpr std::array kSiftSettings{
    "{max_keypoints: 0}", "{max_keypoints: 0, octave_layers: 5}",
    "{max_keypoints: 0, sigma_px: 2.4}",
    "{max_keypoints: 0, contrast_threshold: 0.01, edge_threshold: 30}"};

/// The same on data that may not be there.
class SiftAgreementOnRecordedData : public ::testing::TestWithParam<LikeSift> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SiftAgreementOnRecordedData);

inline void expect_agreement(const LikeSift& like, const std::string& params, const Image& image,
                             const std::string& name) {
  testing::PluginUnderTest reference("detectors/sift", params), other(like.id, params);
  const Keypoints expected = detect(reference, image), found = detect(other, image);
  ASSERT_GT(expected.count(), 200);
  const Agreement there = agreement(expected, found), back = agreement(found, expected);
  std::printf("%s %s: %d of OpenCV, %d found, agreement %.4f and %.4f, descriptors %.3f\n",
              params.c_str(), name.c_str(), static_cast<int>(expected.count()),
              static_cast<int>(found.count()), there.share, back.share,
              there.descriptor_difference);
  EXPECT_GT(there.share, like.share);
  EXPECT_GT(back.share, like.share);
  EXPECT_LT(there.descriptor_difference, like.descriptor_difference);
}

TEST_P(SiftAgreement, HasTheSameKeypointsAndLikeDescriptorsOnTextures) {
  const auto& [like, params] = GetParam();
  for (const std::uint64_t seed : {21U, 22U}) {
    expect_agreement(like, params, texture(319, 240, seed), "seed " + std::to_string(seed));
  }
}

TEST_P(SiftAgreement, HasTheSameKeypointsAndLikeDescriptorsOnAPrintedSheet) {
  const auto& [like, params] = GetParam();
  expect_agreement(like, params, image_of_file(WEFT_TEXTURE, 400), "sheet_texture.png");
}

TEST_P(SiftAgreementOnRecordedData, HasTheSameKeypointsAndLikeDescriptors) {
  namespace fs = std::filesystem;
  const char* data = std::getenv("WEFT_DATA");
  const fs::path frames = fs::path(data == nullptr ? "" : data) / "kinect_paper" / "frames";
  if (data == nullptr || !fs::exists(frames)) {
    GTEST_SKIP() << "WEFT_DATA does not name a folder that holds kinect_paper/";
  }
  const std::vector<fs::path> files{fs::directory_iterator(frames), fs::directory_iterator()};
  const fs::path first = *std::min_element(files.begin(), files.end());
  expect_agreement(GetParam(), "{max_keypoints: 0}", image_of_file(first, 640), first.filename());
}

}  // namespace weft::detectors
