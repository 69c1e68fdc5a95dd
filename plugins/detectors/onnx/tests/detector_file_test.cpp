// SPDX-License-Identifier: Apache-2.0
#include "detector_file.hpp"

#include <gmock/gmock.h>

#include "tests/test_detector.hpp"

namespace weft::onnx {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TestFolder;
using testing::TestList;
using testing::TestMaps;

constexpr const char* kHash = "00112233445566aa";

struct DetectorFileTest : ::testing::Test {
  TestFolder folder;
  std::string maps = testing::TestImage().yaml(kHash) + TestMaps().rest();
  std::string list = testing::TestImage().yaml(kHash) + TestList().rest();

  Result<DetectorFile> read(const std::string& text) const {
    inference::testing::write_file(folder.file("net.yaml"), text);
    return read_detector_file(folder.file("net.yaml"));
  }
  std::string reason(std::string text, const std::string& from, const std::string& to) const {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    const auto file = read(text.replace(at, from.size(), to));
    return file ? "" : file.error().message;
  }
};

TEST_F(DetectorFileTest, IsReadAsItWasWritten) {
  const auto file = read(maps);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->onnx_path, folder.file("net.onnx"));
  EXPECT_EQ(file->onnx_hash, kHash);
  EXPECT_EQ(file->input, "image");
  EXPECT_EQ(file->image.size_px, cv::Size(160, 120));
  EXPECT_TRUE(file->image.is_grey);
  EXPECT_EQ(file->image.scale, 1.0 / 255.0);
  ASSERT_TRUE(file->heat_map);
  EXPECT_EQ(file->heat_map->nms_px, 2);
  EXPECT_EQ(file->heat_map->border_px, 4);
  EXPECT_FALSE(file->descriptors.align_corners);
  EXPECT_THAT(file->outputs(), ElementsAre("descriptors", "scores"));
}

TEST_F(DetectorFileTest, DescribesListsWithAndWithoutScores) {
  const auto file = read(list);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_FALSE(file->heat_map);
  EXPECT_FALSE(file->keypoints.is_normalised || file->keypoints.is_yx ||
               file->keypoints.is_at_halves);
  EXPECT_THAT(file->outputs(), ElementsAre("descriptors", "keypoints", "scores"));
  EXPECT_EQ(reason(list, "scores: {output: scores}\n", ""), "");
  const auto bare = read_detector_file(folder.file("net.yaml"));
  ASSERT_TRUE(bare) << bare.error().message;
  EXPECT_THAT(bare->outputs(), ElementsAre("descriptors", "keypoints"));
}

TEST_F(DetectorFileTest, NamesThePlaceAndTheFixOfEachError) {
  EXPECT_THAT(reason(maps, "kind: detector", "kind: registration"),
              HasSubstr("net.yaml:2:7: 'kind' is 'registration', but only 'detector' is known"));
  EXPECT_THAT(reason(maps, "grey", "gray"), HasSubstr("'image.colours' must be rgb or grey"));
  EXPECT_THAT(reason(maps, "width_px: 160", "width_px: 1e9"), HasSubstr("net.yaml:5:"));
  EXPECT_THAT(reason(maps, "offset", "ofset"), HasSubstr("did you mean 'offset'"));
  EXPECT_THAT(reason(maps, "scale: 0.00392", "scal: 0.00392"), HasSubstr("'image.scal'"));
  EXPECT_THAT(reason(maps, "nms_px: 2", "nms_px: 0"), HasSubstr("from 1 to 64"));
  EXPECT_THAT(reason(maps, "normalise: false", "normalise: 2"), HasSubstr("must be true or false"));
  EXPECT_THAT(reason(maps, "metric: l2", "metric: l1"), HasSubstr("must be l2 or hamming"));
  EXPECT_THAT(reason(maps, "metric: l2, ", ""), HasSubstr("'descriptors.metric' is missing"));
  EXPECT_THAT(reason(maps, "licence", "scores: {output: scores}\nlicence"),
              HasSubstr("remove 'scores'"));
  EXPECT_THAT(reason(maps, "heat_map: {", "comment: {"),
              HasSubstr("needs either 'heat_map' or 'keypoints'"));
  EXPECT_THAT(reason(list, "keypoints: {", "heat_map: {output: map}\nkeypoints: {"),
              HasSubstr("needs either"));
  EXPECT_THAT(reason(list, "units: px", "units: mm"), HasSubstr("must be px or normalised"));
  EXPECT_THAT(reason(list, "centres: integers", "centres: 0"),
              HasSubstr("'keypoints.centres' must be integers or halves"));
  EXPECT_THAT(reason(list, "metric: l2", "align_corners: true, metric: l2"),
              HasSubstr("only for networks with a heat_map"));
  EXPECT_THAT(reason(list, "onnx: net.onnx", "onnx: ../net.onnx"), HasSubstr("same folder"));
}

}  // namespace
}  // namespace weft::onnx
