// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>

#include "match_folder.hpp"

namespace weft::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kPlaces = "template_x_px,template_y_px,image_x_px,image_y_px";

PluginAnswer opened(PluginUnderTest& source) { return source.process(kOpen, {}); }

TEST(Matches, AreReadAFileAFrameInTheOrderOfTheirNames) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write("sets/b.csv", kPlaces + "\n1,2,3,4\n5,6,7,8.5\n");
  folder.write("sets/a.csv", kPlaces + "\n0.25,0.5,1e0,2\n");
  auto source = matches_source(folder, "sets/*.csv", "fps: 10");
  const PluginAnswer camera = opened(source);
  ASSERT_EQ(camera.status, WEFT_OK) << camera.message;
  EXPECT_EQ(camera.get<Camera>()->fy, 11.0);
  EXPECT_EQ(source.process(kCount, {}).get<Count>()->frames, 2);
  const auto first = source.process(kRead, {}, 0).get<Correspondences>();
  ASSERT_TRUE(first && first->count() == 1);
  EXPECT_EQ(first->template_px(0, 0), 0.25);
  const PluginAnswer second = source.process(kRead, {}, 1);
  const auto matches = second.get<Correspondences>();
  ASSERT_TRUE(matches && matches->count() == 2);
  EXPECT_EQ(matches->template_px(1, 1), 6.0);
  EXPECT_EQ(matches->image_px(1, 1), 8.5);
  EXPECT_EQ(matches->face(1), -1) << "the host completes it";
  EXPECT_EQ(matches->kept(1), 1);
  EXPECT_EQ(matches->score(1), 1.0);
  EXPECT_FALSE(matches->ratio.present());
  EXPECT_FALSE(matches->template_xy_m.present());
  EXPECT_DOUBLE_EQ(second.get<Time>()->t_s, 0.1);
  EXPECT_FALSE(second.get<GroundTruth>().has_value());
}

TEST(Matches, AreReadFromOneFileOfAllFrames) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write("all.csv", "frame," + kPlaces + "\n2,1,2,3,4\n0,5,6,7,8\n2,9,10,11,12\n");
  auto source = matches_source(folder, "all.csv");
  ASSERT_EQ(opened(source).status, WEFT_OK);
  EXPECT_EQ(source.process(kCount, {}).get<Count>()->frames, 3);
  EXPECT_EQ(source.process(kRead, {}, 0).get<Correspondences>()->image_px(0, 0), 7.0);
  EXPECT_EQ(source.process(kRead, {}, 1).get<Correspondences>()->count(), 0);
  const auto last = source.process(kRead, {}, 2).get<Correspondences>();
  ASSERT_EQ(last->count(), 2);
  EXPECT_EQ(last->image_px(0, 1), 4.0);
  EXPECT_EQ(last->image_px(1, 1), 12.0);
  EXPECT_THAT(source.process(kRead, {}, 3).message, HasSubstr("there is no frame 3"));
}

TEST(Matches, MayBeInMetresOnTheTemplateWithAllThatFiltersAsk) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write("a.csv",
               "angle_difference_rad,scale_ratio,ratio,distance,kept,score,image_y_px,image_x_px,"
               "template_y_m,template_x_m\n-0.5,1.5,0.7,120,0,0.3,4,3,0.02,0.01\n");
  auto source = matches_source(folder, "a.csv");
  ASSERT_EQ(opened(source).status, WEFT_OK);
  const auto matches = source.process(kRead, {}, 0).get<Correspondences>();
  ASSERT_TRUE(matches.has_value());
  EXPECT_EQ(matches->template_xy_m(0, 0), 0.01);
  EXPECT_EQ(matches->template_xy_m(0, 1), 0.02);
  EXPECT_EQ(matches->image_px(0, 0), 3.0);
  EXPECT_EQ(matches->score(0), 0.3);
  EXPECT_EQ(matches->kept(0), 0);
  EXPECT_EQ(matches->distance(0), 120.0);
  EXPECT_EQ(matches->ratio(0), 0.7);
  EXPECT_EQ(matches->scale_ratio(0), 1.5);
  EXPECT_EQ(matches->angle_difference_rad(0), -0.5);
}

TEST(Matches, BringTheirLabelsAndTrueImagesAsTruth) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write("a.csv", kPlaces +
                            ",label,true_x_px,true_y_px\n1,2,3,4,1,3.5,4\n1,2,3,4,0,,\n"
                            "1,2,3,4,,,\n");
  auto source = matches_source(folder, "a.csv");
  ASSERT_EQ(opened(source).status, WEFT_OK);
  const auto truth = source.process(kRead, {}, 0).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->kind, "matches");
  EXPECT_EQ(truth->count(), 0);
  ASSERT_EQ(truth->match_label.rows(), 3);
  ASSERT_EQ(truth->match_xy_px.rows(), 3);
  EXPECT_EQ(truth->match_label(0), 1);
  EXPECT_EQ(truth->match_label(1), 0);
  EXPECT_EQ(truth->match_label(2), -1);
  EXPECT_EQ(truth->match_xy_px(0, 0), 3.5);
  EXPECT_TRUE(std::isnan(truth->match_xy_px(1, 0)));
}

TEST(Matches, HaveTruePointsFromTheFileOfTheirStem) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write("all.csv", "frame,label," + kPlaces + "\n1,1,1,2,3,4\n");
  folder.write("gt/000001_mdh.csv",
               "point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm,Z_mm\nm,1,2,3,4,5,6,7\n");
  auto source = matches_source(folder, "all.csv", "truth: '" + folder.path("gt/*.csv") + "'");
  const PluginAnswer camera = opened(source);
  ASSERT_EQ(camera.status, WEFT_OK) << camera.message;
  const auto truth = source.process(kRead, {}, 1).get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->kind, "mdh");
  EXPECT_EQ(truth->points_m(0, 2), 0.007);
  ASSERT_EQ(truth->match_label.rows(), 1);
  EXPECT_EQ(truth->match_label(0), 1);
}

TEST(Matches, LoseTheDistortionOfTheLens) {
  const FrameFolder folder;
  const double k1 = -0.2, fx = 400.0, fy = 410.0, cx = 319.5, cy = 239.5;
  const double x = 0.5, y = -0.3, r2 = x * x + y * y;
  const auto text = [](double value) { return std::to_string(value); };
  folder.write("camera.yaml",
               "fx: 400\nfy: 410\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n"
               "distortion: [-0.2, 0, 0, 0, 0]\n");
  folder.write("a.csv", kPlaces + "\n1,2," + text(fx * x * (1.0 + k1 * r2) + cx) + "," +
                            text(fy * y * (1.0 + k1 * r2) + cy) + "\n");
  auto source = matches_source(folder, "a.csv");
  const PluginAnswer camera = opened(source);
  ASSERT_EQ(camera.status, WEFT_OK) << camera.message;
  const auto matches = source.process(kRead, {}, 0).get<Correspondences>();
  ASSERT_TRUE(matches.has_value());
  EXPECT_NEAR(matches->image_px(0, 0), fx * x + cx, 1e-5);
  EXPECT_NEAR(matches->image_px(0, 1), fy * y + cy, 1e-5);
}

TEST(Matches, RefuseSeveralFilesWithFrames) {
  const FrameFolder folder;
  folder.write_camera();
  for (const char* name : {"a.csv", "b.csv"}) {
    folder.write(name, "frame," + kPlaces + "\n0,1,2,3,4\n");
  }
  auto source = matches_source(folder, "*.csv");
  EXPECT_THAT(opened(source).message,
              AllOf(HasSubstr("a.csv"), HasSubstr("2 files match"), HasSubstr("one file a frame")));
}

TEST(Matches, RefuseWhatIsMissing) {
  const FrameFolder folder;
  folder.write_camera();
  auto none = matches_source(folder, "sets/*.csv");
  EXPECT_THAT(opened(none).message, HasSubstr("no file matches"));
  folder.write("a.csv", kPlaces + "\n1,2,3,4\n");
  folder.write("gt/b.csv", "");
  auto stranger = matches_source(folder, "a.csv", "truth: '" + folder.path("gt/*.csv") + "'");
  EXPECT_THAT(opened(stranger).message, AllOf(HasSubstr("b.csv"), HasSubstr("no frame")));
  folder.write("camera.yaml", "fx: 10\n");
  auto blind = matches_source(folder, "a.csv");
  EXPECT_THAT(opened(blind).message, HasSubstr("camera.yaml"));
}

}  // namespace
}  // namespace weft::testing
