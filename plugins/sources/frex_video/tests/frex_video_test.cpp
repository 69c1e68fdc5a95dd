// SPDX-License-Identifier: Apache-2.0
// Converts a film of paper with markers, whose true shape is known in closed form, into a scene
// with another texture. sources/synthetic makes the film.
#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/matrix.hpp>

#include "film_accuracy.hpp"

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::GroundTruth;
using weft::Image;
using weft::testing::FilmedSheet;
using weft::testing::kCount;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::OpenedSource;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;
using weft::testing::view;

constexpr int kFrames[] = {170};

std::string refusal(const std::string& params) {
  PluginUnderTest source("sources/frex_video", params);
  const PluginAnswer outcome = source.process(kOpen, {});
  EXPECT_EQ(outcome.status, WEFT_ERROR) << params;
  return outcome.message;
}

class FrexVideo : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { filmed_ = std::make_unique<FilmedSheet>(); }
  static void TearDownTestSuite() { filmed_.reset(); }

  static std::unique_ptr<FilmedSheet> filmed_;
};
std::unique_ptr<FilmedSheet> FrexVideo::filmed_;

TEST_F(FrexVideo, ShowsThePrintAsIfItHadBeenFilmed) {
  weft::testing::expect_the_print_as_if_filmed(*filmed_, kFrames, 60'000U);
}

TEST_F(FrexVideo, KnowsTheSurfaceBetterThanEachMarkerByItself) {
  weft::testing::expect_the_surface_to_be_known(*filmed_, kFrames);
}

TEST_F(FrexVideo, GivesATruthThatAgreesWithItself) {
  OpenedSource source(filmed_->scene());
  const PluginAnswer frame = source.frame(58);
  ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
  const GroundTruth truth = *frame.get<GroundTruth>();
  ASSERT_GT(truth.count(), 2000);
  ASSERT_TRUE(truth.faces.present() && truth.visible.present() && truth.depth_m.present());
  int compared = 0;
  for (std::int64_t k = 0; k < truth.count(); ++k) {
    const Eigen::Vector3d point = truth.points_m.matrix<3>().row(k).transpose();
    const Eigen::Vector2d pixel = project(filmed_->camera, point);
    const auto x = std::lround(pixel.x()), y = std::lround(pixel.y());
    const Eigen::Vector2d seen_mm =
        1000.0 * Eigen::Vector2d(truth.uv_m(y, 2 * x), truth.uv_m(y, 2 * x + 1));
    if (truth.visible(k) == 0 || !seen_mm.allFinite()) continue;
    ++compared;
    const Eigen::Vector2d own_mm = 1000.0 * truth.template_xy_m.matrix<2>().row(k).transpose();
    // The pixel's centre is up to half a pixel in x and in y from the projection, 1.4 mm for both
    // where the paper is seen obliquely.
    EXPECT_LT((seen_mm - own_mm).norm(), 1.4) << k;
    EXPECT_NEAR(truth.depth_m(y, x), point.z(), 0.0015) << k;
  }
  EXPECT_GT(compared, 2000);
  double largest_strain = 0.0;
  for (std::int64_t f = 0; f < truth.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int64_t a = truth.faces(f, k), b = truth.faces(f, (k + 1) % 3);
      ASSERT_TRUE(a >= 0 && a < truth.count());
      const auto flat = truth.template_xy_m.matrix<2>();
      const auto bent = truth.points_m.matrix<3>();
      const double length_m = (flat.row(a) - flat.row(b)).norm();
      const double strain = std::abs((bent.row(a) - bent.row(b)).norm() / length_m - 1.0);
      largest_strain = std::max(largest_strain, strain);
    }
  }
  std::cout << "largest strain of an edge: " << 100.0 * largest_strain << " %\n";
  EXPECT_GT(truth.faces.rows(), 4000);
  EXPECT_LT(largest_strain, 0.01);
}

TEST_F(FrexVideo, GivesTheSameBytesInAnyOrder) {
  OpenedSource one(filmed_->scene()), other(filmed_->scene());
  const PluginAnswer first = one.frame(17), later = other.frame(58), second = one.frame(58);
  const PluginAnswer again = other.frame(17);
  for (const auto& [a, b] : {std::pair{first, again}, std::pair{second, later}}) {
    const Image image = *a.get<Image>(), same = *b.get<Image>();
    EXPECT_TRUE(std::equal(image.pixels.data(), image.pixels.data() + image.pixels.size(),
                           same.pixels.data()));
    const GroundTruth truth = *a.get<GroundTruth>(), true_too = *b.get<GroundTruth>();
    EXPECT_TRUE(truth.points_m.matrix<3>() == true_too.points_m.matrix<3>());
  }
  EXPECT_EQ(first.get<Image>()->stem, "000017");
  EXPECT_NEAR(first.get<weft::Time>()->t_s, 17 / 30.0, 1e-12);
}

TEST_F(FrexVideo, LeavesOutFramesWithoutTheSheetAndSaysWhy) {
  OpenedSource source(filmed_->scene("", ", invisible_frames: [1]"));
  EXPECT_EQ(source.process(kCount, {}).get<weft::Count>()->frames, 200);
  const PluginAnswer empty = source.frame(1);
  EXPECT_EQ(empty.status, WEFT_DEGENERATE);
  EXPECT_THAT(empty.message, HasSubstr("of 100 markers 0 are found"));
  EXPECT_TRUE(empty.get<weft::Time>());
  EXPECT_FALSE(empty.get<Image>());
  EXPECT_FALSE(empty.get<GroundTruth>());
  EXPECT_EQ(source.frame(2).status, WEFT_OK);
  EXPECT_EQ(source.frame(200).status, WEFT_ERROR);
}

TEST_F(FrexVideo, ReadsAVideoToItsEnd) {
  OpenedSource film(filmed_->film("sheet.png"), "sources/synthetic");
  cv::VideoWriter writer(filmed_->folder.path("film.avi"), cv::CAP_OPENCV_MJPEG,
                         cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 30.0, {640, 480});
  for (int index = 0; index < 3; ++index) {
    cv::Mat picture;
    const PluginAnswer frame = film.frame(10 * index);
    cv::cvtColor(view(frame.get<Image>()->pixels), picture, cv::COLOR_GRAY2BGR);
    // The second one is a mirror image, as some programs record the user.
    if (index == 1) cv::flip(picture, picture, 1);
    writer.write(picture);
  }
  writer.release();
  filmed_->folder.write("camera.yaml",
                        "{fx: 820, fy: 820, cx: 319.5, cy: 239.5, width: 640, height: 480}");
  OpenedSource source("{frames: {use: sources/video, params: {path: '" +
                      filmed_->folder.path("film.avi") + "', camera: '" +
                      filmed_->folder.path("camera.yaml") + "'}}, layout: '" +
                      filmed_->folder.path("sheet.yaml") + "', texture: '" +
                      filmed_->folder.path("poster.png") + "'}");
  EXPECT_EQ(source.process(kCount, {}).get<weft::Count>()->frames, -1);
  EXPECT_EQ(source.frame(0).status, WEFT_OK);
  EXPECT_EQ(source.frame(1).status, WEFT_DEGENERATE);
  EXPECT_EQ(source.frame(2).status, WEFT_OK);
  EXPECT_EQ(source.frame(3).status, WEFT_END);
}

TEST_F(FrexVideo, PutsPicturesOfAnyShapeInTheMiddleOfWhitePaper) {
  filmed_->folder.write_image("upright.png", cv::Mat(400, 200, CV_8UC1, cv::Scalar(0)));
  OpenedSource source("{frames: {use: sources/synthetic, params: " + filmed_->film("sheet.png") +
                      "}, layout: '" + filmed_->folder.path("sheet.yaml") + "', texture: '" +
                      filmed_->folder.path("upright.png") +
                      "', background: white, noise_grey: 0, ambient: 1}");
  const PluginAnswer frame = source.frame(0);
  ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
  const cv::Mat3b picture = view(frame.get<Image>()->pixels);
  // 105 mm of 297 mm wide, in the middle of paper that is 405.9 px wide.
  EXPECT_EQ(picture(240, 320), cv::Vec3b::all(0));
  EXPECT_NEAR(cv::countNonZero(picture.row(240).reshape(1) < 128) / 3.0, 820 * 0.105 / 0.6, 2.0);
  EXPECT_EQ(picture(240, 180), cv::Vec3b::all(255));
  EXPECT_EQ(picture(10, 10), cv::Vec3b::all(255));
  const GroundTruth truth = *frame.get<GroundTruth>();
  EXPECT_NEAR(truth.template_xy_m.matrix<2>().col(0).maxCoeff(), 0.105 - 0.105 / 400, 1e-9);
  EXPECT_TRUE(std::isnan(truth.uv_m(240, 2 * 180)));
}

TEST_F(FrexVideo, RefusesWhatCannotBeMade) {
  EXPECT_THAT(refusal(filmed_->scene(", min_markers: 101")),
              AllOf(HasSubstr("sheet.yaml"), HasSubstr("100 markers"), HasSubstr("101")));
  EXPECT_THAT(refusal(filmed_->scene(", background: image")), HasSubstr("'background_image'"));
  EXPECT_THAT(
      refusal(filmed_->scene(", background_image: '" + filmed_->folder.path("poster.png") + "'")),
      HasSubstr("'background_image'"));
  filmed_->folder.write("text.png", "no image");
  const std::string no_image = filmed_->folder.path("text.png");
  EXPECT_THAT(refusal("{frames: {use: sources/synthetic, params: " + filmed_->film("sheet.png") +
                      "}, layout: '" + filmed_->folder.path("sheet.yaml") + "', texture: '" +
                      no_image + "'}"),
              AllOf(HasSubstr("text.png"), HasSubstr("'texture'")));
  EXPECT_THAT(refusal(filmed_->scene("", ", cut_frames: [5000]")), HasSubstr("cut_frames"));
  EXPECT_THROW(PluginUnderTest("sources/frex_video", "{}"), std::runtime_error);
}

}  // namespace
