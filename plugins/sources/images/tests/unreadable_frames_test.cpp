// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/testing/mistakes.hpp>

#include "images_source.hpp"

namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using weft::testing::FrameFolder;
using weft::testing::images_source;
using weft::testing::kCount;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::mistakes_of;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

std::string bytes_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Between good frames, everything that matches a pattern and cannot be read.
void add_unreadable(const FrameFolder& folder) {
  folder.write_camera();
  folder.write_frame("frames/0.png");
  fs::create_symlink("nowhere", folder.path("frames/1.png"));
  fs::create_directory(folder.path("frames/2.png"));
  ASSERT_EQ(mkfifo(folder.path("frames/3.png").c_str(), 0600), 0);
  folder.write("frames/4.png", "no image");
  folder.write_image("frames/5.png", cv::Mat(6, 9, CV_8UC3, cv::Scalar::all(1)));
  folder.write("frames/6.png", bytes_of(folder.path("frames/0.png")).substr(0, 60));
  folder.write_frame("frames/7.png", 77);
}

TEST(ImagesSource, TakesEveryMatchOfThePatternForAFrame) {
  const FrameFolder folder;
  add_unreadable(folder);
  PluginUnderTest source = images_source(folder);
  const PluginAnswer opened = source.process(kOpen, {});
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
  EXPECT_EQ(source.process(kCount, {}).get<weft::Count>()->frames, 8);
  const std::vector<std::string> reasons{"no such file",   "it is a folder", "no regular file",
                                         "can be decoded", "is 9 x 6 px",    "cut off"};
  for (std::uint64_t i = 0; i < reasons.size(); ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i + 1);
    EXPECT_EQ(frame.status, WEFT_ERROR) << i + 1;
    EXPECT_THAT(frame.message, AllOf(HasSubstr(folder.path("frames/" + std::to_string(i + 1))),
                                     HasSubstr(reasons[i])));
  }
  const PluginAnswer last = source.process(kRead, {}, 7);
  ASSERT_EQ(last.status, WEFT_OK) << last.message;
  EXPECT_EQ(last.get<weft::Image>()->stem, "7");
}

TEST(ImagesSource, LeavesTruthWithItsFramesWhenOneCannotBeRead) {
  const FrameFolder folder;
  add_unreadable(folder);
  fs::create_directory(folder.path("gt"));
  fs::create_symlink("nowhere", folder.path("gt/0.npz"));
  folder.write(
      "gt/7_measured.csv",
      "point_id,template_x_mm,template_y_mm,u_px,v_px,X_mm,Y_mm,Z_mm\na,1,2,3,4,5,6,700\n");
  PluginUnderTest source =
      images_source(folder, "frames/*.png", "truth: '" + folder.path("gt/*") + "'");
  ASSERT_EQ(source.process(kOpen, {}).status, WEFT_OK);
  const PluginAnswer broken = source.process(kRead, {}, 0);
  EXPECT_EQ(broken.status, WEFT_ERROR);
  EXPECT_THAT(broken.message, HasSubstr("gt/0.npz"));
  const PluginAnswer last = source.process(kRead, {}, 7);
  ASSERT_EQ(last.status, WEFT_OK) << last.message;
  EXPECT_DOUBLE_EQ(last.get<weft::GroundTruth>()->points_m(0, 2), 0.7);
}

TEST(ImagesSource, RefusesASizeThatNoFrameHas) {
  const FrameFolder folder;
  folder.write_camera();
  folder.write_image("frames/a.png", cv::Mat(480, 640, CV_8UC1, cv::Scalar::all(1)));
  folder.write_image("frames/b.png", cv::Mat(480, 640, CV_8UC1, cv::Scalar::all(2)));
  const PluginAnswer opened = images_source(folder).process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  EXPECT_THAT(opened.message, AllOf(HasSubstr("a.png: is 640 x 480 px"), HasSubstr("8 x 6 px")));
}

TEST(ImagesSource, RefusesAPathOfWhichNothingCanBeRead) {
  const FrameFolder folder;
  folder.write_camera();
  fs::create_directory(folder.path("frames"));
  ASSERT_EQ(mkfifo(folder.path("frames/a.png").c_str(), 0600), 0);
  const PluginAnswer opened = images_source(folder).process(kOpen, {});
  EXPECT_EQ(opened.status, WEFT_ERROR);
  EXPECT_THAT(opened.message, AllOf(HasSubstr("a.png"), HasSubstr("no regular file")));
  EXPECT_THAT(mistakes_of("sources/images", "{path: '" + folder.path("frames/*.png") +
                                                "', camera: '" + folder.path("camera.yaml") + "'}"),
              ElementsAre(HasSubstr("path: ")));
}

TEST(ImagesSource, SaysAllMistakesBeforeAnythingRuns) {
  const FrameFolder folder;
  folder.write_frame("frames/a.png");
  folder.write("camera.yaml", "fx: 10\nfy: 11\ncx: 3.5\ncy: 2.5\nwidth: 8\nheight: 6\nhigth: 6\n");
  folder.write("depth/b.png", "no image");
  const std::string start =
      "{path: '" + folder.path("frames/*.png") + "', camera: '" + folder.path("camera.yaml") + "'";
  EXPECT_THAT(
      mistakes_of("sources/images", start + ", truth: '" + folder.path("gt/*.npz") + "', depth: '" +
                                        folder.path("depth/*.png") + "', excluded: {c: why}}"),
      ElementsAre(HasSubstr("camera: " + folder.path("camera.yaml") +
                            ":7:1: a camera file has no key 'higth'"),
                  HasSubstr("truth: truth: no file matches"),
                  HasSubstr("depth: " + folder.path("depth/b.png") + ": belongs to no frame"),
                  HasSubstr("excluded: 'excluded' names the frame 'c'")));
  folder.write_camera();
  EXPECT_THAT(mistakes_of("sources/images", start + "}"), IsEmpty());
}

}  // namespace
