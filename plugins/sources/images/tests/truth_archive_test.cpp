// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/data/ground_truth.hpp>
#include <weft/testing/record_file.hpp>

#include "images_source.hpp"

namespace {

using ::testing::HasSubstr;
using weft::Array;
using weft::GroundTruth;
using weft::testing::FrameFolder;
using weft::testing::images_source;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

/// Three frames, the second with an archive of this name.
void fill(const FrameFolder& folder, const std::string& archive) {
  folder.write_camera();
  for (const char* stem : {"008", "009", "010"}) {
    folder.write_frame(std::string("frames/") + stem + ".png");
  }
  GroundTruth truth{Array<double>({3, 2}, 0.0), Array<double>({3, 3}, 0.0), "measured", ""};
  truth.points_m(2, 2) = 0.1 + 0.2;
  truth.faces = Array<std::int32_t>({1, 3}, 0);
  truth.faces(0, 1) = 1;
  truth.faces(0, 2) = 2;
  truth.visible = Array<std::uint8_t>({3}, 0);
  truth.visible(1) = 1;
  truth.diag.set("stretch_max", 0.07);
  folder.write("gt/placeholder", "");
  weft::testing::write_record_file(folder.path(archive), "ground_truth", truth);
}

PluginUnderTest source(const FrameFolder& folder) {
  return images_source(folder, "frames/*.png", "truth: '" + folder.path("gt/*.npz") + "'");
}

TEST(TruthArchives, GiveTheWholeRecordToTheirFrame) {
  const FrameFolder folder;
  fill(folder, "gt/009.npz");
  auto images = source(folder);
  ASSERT_EQ(images.process(kOpen, {}).status, WEFT_OK);
  EXPECT_FALSE(images.process(kRead, {}, 0).get<GroundTruth>().has_value());
  const auto truth = images.process(kRead, {}, 1).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->kind, "measured");
  EXPECT_EQ(truth->points_m(2, 2), 0.1 + 0.2);
  EXPECT_EQ(truth->faces(0, 2), 2);
  EXPECT_EQ(truth->visible(1), 1);
  EXPECT_FALSE(truth->depth_m.present());
  EXPECT_EQ(truth->diag.value("stretch_max", 0.0), 0.07);
}

TEST(TruthArchives, TakeTheKindThatTheNameOfTheFileGives) {
  const FrameFolder folder;
  fill(folder, "gt/009_refined.npz");
  auto images = source(folder);
  ASSERT_EQ(images.process(kOpen, {}).status, WEFT_OK);
  EXPECT_EQ(images.process(kRead, {}, 1).get<GroundTruth>()->kind, "refined");
}

TEST(TruthArchives, AreAnErrorOfTheirFrameWhenTheyAreDamaged) {
  const FrameFolder folder;
  fill(folder, "gt/009.npz");
  folder.write("gt/010.npz", "no archive");
  auto images = source(folder);
  ASSERT_EQ(images.process(kOpen, {}).status, WEFT_OK);
  const PluginAnswer damaged = images.process(kRead, {}, 2);
  EXPECT_EQ(damaged.status, WEFT_ERROR);
  EXPECT_THAT(damaged.message, HasSubstr("010.npz"));
  EXPECT_EQ(images.process(kRead, {}, 1).status, WEFT_OK);
}

TEST(TruthArchives, MustHoldATruth) {
  const FrameFolder folder;
  fill(folder, "gt/009.npz");
  weft::testing::write_record_file(folder.path("gt/010.npz"), "time", weft::Time{});
  auto images = source(folder);
  ASSERT_EQ(images.process(kOpen, {}).status, WEFT_OK);
  EXPECT_THAT(images.process(kRead, {}, 2).message, HasSubstr("no record 'ground_truth'"));
}

}  // namespace
