// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>

#include "images_source.hpp"

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::GroundTruth;
using weft::testing::FrameFolder;
using weft::testing::images_source;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

const std::string kHeader = "point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm,Z_mm\n";
const std::string kRow = "m0,59.25,37.5,1,2,-98.5,-131.75,545.5\n";

void fill(const FrameFolder& folder) {
  folder.write_camera();
  for (const char* stem : {"008", "009", "010"}) {
    folder.write_frame(std::string("frames/") + stem + ".png");
  }
}

PluginUnderTest source_with_truth(const FrameFolder& folder, const std::string& more = "") {
  return images_source(
      folder, "frames/*.png",
      "truth: '" + folder.path("gt/*.csv") + "'" + (more.empty() ? "" : ", " + more));
}

/// The message with which open() refuses a truth file of this content.
std::string refusal_of(const std::string& content) {
  const FrameFolder folder;
  fill(folder);
  folder.write("gt/009_a.csv", content);
  const PluginAnswer opened = source_with_truth(folder).process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR) << content;
  return opened.message;
}

std::string refusal_of(const FrameFolder& folder, const std::string& more = "") {
  const PluginAnswer opened = source_with_truth(folder, more).process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  return opened.message;
}

TEST(Truth, BelongsToTheFrameOfItsStemAndIsInMetres) {
  const FrameFolder folder;
  fill(folder);
  folder.write("gt/009_mdh_301.csv", kHeader + kRow + "m1,0,1,3,4,5,6,7e2\n");
  folder.write("gt/010.csv", kHeader + kRow);
  auto source = source_with_truth(folder, "excluded: {\"009\": texture source}");
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  EXPECT_FALSE(source.process(kRead, {}, 0).get<GroundTruth>().has_value());
  const auto truth = source.process(kRead, {}, 1).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->kind, "mdh_301");
  EXPECT_EQ(truth->exclusion, "texture source");
  ASSERT_EQ(truth->count(), 2);
  EXPECT_DOUBLE_EQ(truth->template_xy_m(0, 0), 0.05925);
  EXPECT_DOUBLE_EQ(truth->template_xy_m(0, 1), 0.0375);
  EXPECT_DOUBLE_EQ(truth->points_m(0, 0), -0.0985);
  EXPECT_DOUBLE_EQ(truth->points_m(0, 1), -0.13175);
  EXPECT_DOUBLE_EQ(truth->points_m(0, 2), 0.5455);
  EXPECT_DOUBLE_EQ(truth->points_m(1, 2), 0.7);
  const auto other = source.process(kRead, {}, 2).get<GroundTruth>();
  ASSERT_TRUE(other.has_value());
  EXPECT_EQ(other->kind, "");
  EXPECT_EQ(other->exclusion, "");
}

TEST(Truth, ReadsColumnsInAnyOrderWithForeignLineEnds) {
  const FrameFolder folder;
  fill(folder);
  folder.write("gt/009_a.csv",
               "\xEF\xBB\xBFZ_mm, Y_mm,X_mm,v_px,u_px,template_y_mm,template_x_mm,point_id\r\n"
               "3,2,1,0,0,5,4,p\r\n\r\n");
  auto source = source_with_truth(folder);
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  const auto truth = source.process(kRead, {}, 1).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_DOUBLE_EQ(truth->points_m(0, 0), 0.001);
  EXPECT_DOUBLE_EQ(truth->points_m(0, 2), 0.003);
  EXPECT_DOUBLE_EQ(truth->template_xy_m(0, 0), 0.004);
}

TEST(Truth, IsReadAsSpreadsheetsQuoteIt) {
  const FrameFolder folder;
  fill(folder);
  folder.write(
      "gt/009_a.csv",
      "\xEF\xBB\xBF\"point_id\",\"template_x_mm\",\"template_y_mm\",\"u_px\",\"v_px\","
      "\"X_mm\",\"Y_mm\",\"Z_mm\"\r\n\"left, \"\"upper\"\"\",\"4\",5,0,0,+1,\"-2\",3\r\n\r\n\r\n");
  auto source = source_with_truth(folder);
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  const auto truth = source.process(kRead, {}, 1).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  ASSERT_EQ(truth->count(), 1);
  EXPECT_DOUBLE_EQ(truth->template_xy_m(0, 0), 0.004);
  EXPECT_DOUBLE_EQ(truth->points_m(0, 0), 0.001);
  EXPECT_DOUBLE_EQ(truth->points_m(0, 1), -0.002);
}

TEST(Truth, RefusesValuesThatAreNoNumbersWithTheirLine) {
  EXPECT_THAT(refusal_of(kHeader + kRow + "m1,1,2,3,4,nan,6,7\n"),
              AllOf(HasSubstr("009_a.csv:3:"), HasSubstr("'X_mm'"), HasSubstr("nan")));
  EXPECT_THAT(refusal_of(kHeader + "m1,1,2,inf,4,5,6,7\n"), HasSubstr("'u_px'"));
  EXPECT_THAT(refusal_of(kHeader + "m1,1,,3,4,5,6,7\n"), HasSubstr("'template_y_mm'"));
  EXPECT_THAT(refusal_of(kHeader + "m1,1,2mm,3,4,5,6,7\n"), HasSubstr("2mm"));
  EXPECT_THAT(refusal_of(kHeader + "m1,1,1e999,3,4,5,6,7\n"), HasSubstr("1e999"));
  EXPECT_THAT(refusal_of(kHeader + "m1,1,2,3,4,5,6,-7\n"), HasSubstr("'Z_mm' must be positive"));
}

TEST(Truth, RefusesTablesOfTheWrongForm) {
  EXPECT_THAT(refusal_of(""), HasSubstr("is empty"));
  EXPECT_THAT(refusal_of(kHeader), HasSubstr("holds no points"));
  EXPECT_THAT(refusal_of("point_id;X_mm\n1;2\n"), HasSubstr(":1: separates its columns by semi"));
  EXPECT_THAT(refusal_of(kHeader + "\"m1,1,2,3,4,5,6,7\n"), HasSubstr(":2: has a quote that is"));
  EXPECT_THAT(refusal_of(kHeader + "m1,1,2,3,4,5,6\n"), HasSubstr(":2: has 7 fields"));
  EXPECT_THAT(refusal_of(kHeader + kRow + kRow), HasSubstr(":3: the point 'm0' is given twice"));
  EXPECT_THAT(refusal_of("point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm\n" + kRow),
              HasSubstr("'Z_mm' is missing"));
  EXPECT_THAT(refusal_of("X_m," + kHeader + kRow), HasSubstr("'X_m' is unknown"));
  EXPECT_THAT(refusal_of("Z_mm," + kHeader + kRow), HasSubstr("'Z_mm' is given twice"));
}

TEST(Truth, BelongsToTheFrameWhoseStemHasUnderscores) {
  const FrameFolder folder;
  folder.write_camera();
  for (const char* stem : {"a", "a_b", "frame_0001"}) {
    folder.write_frame(std::string("frames/") + stem + ".png");
  }
  folder.write("gt/a_c.csv", kHeader + kRow);
  folder.write("gt/a_b_mdh_301.csv", kHeader + kRow);
  folder.write("gt/frame_0001.csv", kHeader + kRow);
  auto source = source_with_truth(folder);
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  const char* const kinds[] = {"c", "mdh_301", ""};
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    const auto truth = source.process(kRead, {}, frame).get<GroundTruth>();
    ASSERT_TRUE(truth.has_value()) << frame;
    EXPECT_EQ(truth->kind, kinds[frame]);
  }
}

TEST(Truth, BelongsToTheFrameOfTheLongestStemThatItsNameBeginsWith) {
  const FrameFolder folder;
  folder.write_camera();
  for (const char* stem : {"a", "a_b"}) folder.write_frame(std::string("frames/") + stem + ".png");
  folder.write("gt/a_b.csv", kHeader + kRow);
  folder.write("gt/a_bc.csv", kHeader + kRow);
  auto source = source_with_truth(folder);
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  EXPECT_EQ(source.process(kRead, {}, 0).get<GroundTruth>()->kind, "bc");
  EXPECT_EQ(source.process(kRead, {}, 1).get<GroundTruth>()->kind, "");
}

TEST(Truth, RefusesAFileWithoutAFrame) {
  const FrameFolder folder;
  fill(folder);
  folder.write("gt/009_a.csv", kHeader + kRow);
  folder.write("gt/011_a.csv", kHeader + kRow);
  EXPECT_THAT(refusal_of(folder), AllOf(HasSubstr("011_a.csv"), HasSubstr("'011'")));
}

TEST(Truth, RefusesTwoFilesForOneFrameAndNamesBoth) {
  const FrameFolder folder;
  fill(folder);
  folder.write("gt/009_a.csv", kHeader + kRow);
  folder.write("gt/009_b.csv", kHeader + kRow);
  EXPECT_THAT(refusal_of(folder), AllOf(HasSubstr("009_a.csv"), HasSubstr("009_b.csv")));
}

TEST(Truth, RefusesAPatternWithoutFiles) {
  const FrameFolder folder;
  fill(folder);
  EXPECT_THAT(refusal_of(folder), AllOf(HasSubstr("truth"), HasSubstr("gt/*.csv")));
}

TEST(Truth, RefusesToExcludeAFrameThatDoesNotExist) {
  const FrameFolder folder;
  fill(folder);
  folder.write("gt/009_a.csv", kHeader + kRow);
  EXPECT_THAT(refusal_of(folder, "excluded: {\"9\": reason}"), HasSubstr("'9'"));
  EXPECT_THAT(refusal_of(folder, "excluded: {\"0010\": reason}"), HasSubstr("did you mean '010'?"));
}

TEST(Truth, RefusesFramesThatItCannotDistinguish) {
  const FrameFolder folder;
  fill(folder);
  folder.write_frame("frames/009.bmp");
  folder.write("gt/009_a.csv", kHeader + kRow);
  auto ambiguous = images_source(folder, "frames/*", "truth: '" + folder.path("gt/*.csv") + "'");
  const PluginAnswer refused = ambiguous.process(kOpen, {});
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("009.bmp"), HasSubstr("009.png")));
  auto without_truth = images_source(folder, "frames/*");
  EXPECT_EQ(without_truth.process(kOpen, {}).status, WEFT_OK);
}

}  // namespace
