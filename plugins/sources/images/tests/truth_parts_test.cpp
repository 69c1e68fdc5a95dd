// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/data/ground_truth.hpp>
#include <weft/testing/mistakes.hpp>
#include <weft/testing/record_file.hpp>

#include "images_source.hpp"

namespace weft::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kPointHeader = "point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm,Z_mm\n";
const std::string kCloudHeader = "X_m,Y_m,Z_m\n";
const std::string kTrianglePly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 1\n1 0 1\n0 1 1\n3 0 1 2\n";

/// Two frames, `a` and `a_b`.
class PartFolder : public FrameFolder {
 public:
  PartFolder() {
    write_camera();
    for (const char* name : {"frames/a.png", "frames/a_b.png"}) write_frame(name);
  }

  PluginUnderTest source(const std::string& parts, const std::string& pattern = "gt/*") const {
    return images_source(*this, "frames/*.png",
                         "truth: '" + path(pattern) + "', truth_parts: '" + parts + "'");
  }

  std::string refusal(const std::string& parts, const std::string& pattern = "gt/*") const {
    const PluginAnswer opened = source(parts, pattern).process(kOpen, {});
    EXPECT_EQ(opened.status, WEFT_ERROR);
    return opened.message;
  }
};

std::vector<int> as_list(const Array<std::int32_t>& values) {
  std::vector<int> list;
  for (std::int64_t i = 0; i < values.rows(); ++i) list.push_back(values(i));
  return list;
}

TEST(TruthParts, AreTheEndsOfNamesAndJoinedInOneTruth) {
  const PartFolder folder;
  folder.write("gt/a_b_mdh_hidden.csv", kPointHeader + "h,1,2,0,0,3,4,500\n");
  folder.write("gt/a_b_mdh_visible.csv", kPointHeader + "v,5,6,0,0,7,8,600\nw,6,6,0,0,8,8,600\n");
  auto source = folder.source("visible hidden");
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  EXPECT_FALSE(source.process(kRead, {}, 0).get<GroundTruth>().has_value());
  const auto truth = source.process(kRead, {}, 1).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->kind, "mdh");
  EXPECT_THAT(truth->parts(), ElementsAre("visible", "hidden"));
  ASSERT_EQ(truth->count(), 3);
  EXPECT_THAT(as_list(truth->point_part), ElementsAre(1, 0, 0));
  EXPECT_DOUBLE_EQ(truth->points_m(0, 2), 0.5);
  EXPECT_DOUBLE_EQ(truth->points_m(2, 0), 0.008);
  EXPECT_DOUBLE_EQ(truth->template_xy_m(1, 0), 0.005);
  EXPECT_FALSE(truth->cloud_part.present());
}

TEST(TruthParts, AreFoldersToo) {
  const PartFolder folder;
  folder.write("gt/visible/a.csv", kCloudHeader + "0,0,1\n0,1,1\n");
  folder.write("gt/hidden/a.ply", kTrianglePly);
  auto source = folder.source("visible hidden", "gt/*/*");
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const auto truth = source.process(kRead, {}, 0).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->kind, "cloud");
  ASSERT_EQ(truth->cloud_m.rows(), 5);
  EXPECT_THAT(as_list(truth->cloud_part), ElementsAre(1, 1, 1, 0, 0));
  ASSERT_EQ(truth->cloud_faces.rows(), 1);
  EXPECT_EQ(truth->cloud_faces(0, 2), 2);
}

TEST(TruthParts, MoveTheFacesOfLaterCloudsBehindTheEarlierPoints) {
  const PartFolder folder;
  folder.write("gt/a_hidden.csv", kCloudHeader + "0,0,1\n0,1,1\n");
  folder.write("gt/a_visible.ply", kTrianglePly);
  auto source = folder.source("visible hidden");
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const auto truth = source.process(kRead, {}, 0).get<GroundTruth>();
  ASSERT_EQ(truth->cloud_faces.rows(), 1);
  EXPECT_EQ(truth->cloud_faces(0, 0), 2);
  EXPECT_EQ(truth->cloud_faces(0, 2), 4);
}

TEST(TruthParts, JoinPointsRecordsAndClouds) {
  const PartFolder folder;
  GroundTruth record{Array<double>({2, 2}, 0.0), Array<double>({2, 3}, 1.0), "measured", ""};
  record.visible = Array<std::uint8_t>({2}, 1);
  folder.write("gt/.keep", "");
  write_record_file(folder.path("gt/a_markers.npz"), "ground_truth", record);
  folder.write("gt/a_scan.csv", kCloudHeader + "0,0,1\n");
  auto source = folder.source("markers scan");
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  const auto truth = source.process(kRead, {}, 0).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->kind, "measured");
  EXPECT_EQ(truth->count(), 2);
  EXPECT_TRUE(truth->visible.present());
  EXPECT_THAT(as_list(truth->point_part), ElementsAre(0, 0));
  EXPECT_THAT(as_list(truth->cloud_part), ElementsAre(1));
  folder.write("gt/a.csv", kPointHeader + "v,5,6,0,0,7,8,600\n");
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const PluginAnswer joined = source.process(kRead, {}, 0);
  EXPECT_EQ(joined.status, WEFT_ERROR);
  EXPECT_THAT(joined.message,
              AllOf(HasSubstr("a.csv"), HasSubstr("a_markers.npz"), HasSubstr("cannot be joined")));
}

TEST(TruthParts, AreOneFileEach) {
  const PartFolder folder;
  folder.write("gt/a_hidden.csv", kCloudHeader + "0,0,1\n");
  folder.write("gt/a_hidden.ply", kTrianglePly);
  EXPECT_THAT(folder.refusal("hidden"),
              AllOf(HasSubstr("a_hidden.ply"), HasSubstr("already has"), HasSubstr("truth_parts")));
}

TEST(TruthParts, HaveOneKindInAFrame) {
  const PartFolder folder;
  folder.write("gt/a_laser_hidden.csv", kCloudHeader + "0,0,1\n");
  folder.write("gt/a_probe_visible.csv", kCloudHeader + "0,0,1\n");
  EXPECT_THAT(folder.refusal("visible hidden"),
              AllOf(HasSubstr("'laser' instead of 'probe'"), HasSubstr("one kind")));
}

TEST(TruthParts, AreRefusedWithoutAFile) {
  const PartFolder folder;
  folder.write("gt/a_hidden.csv", kCloudHeader + "0,0,1\n");
  EXPECT_THAT(folder.refusal("visble hidden"), HasSubstr("no truth file has the part 'visble'"));
  EXPECT_THAT(
      mistakes_of("sources/images", "{path: '" + folder.path("frames/*.png") + "', camera: '" +
                                        folder.path("camera.yaml") + "', truth_parts: hidden}"),
      ElementsAre(HasSubstr("'hidden'")));
}

}  // namespace
}  // namespace weft::testing
