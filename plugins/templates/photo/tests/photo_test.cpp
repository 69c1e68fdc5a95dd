// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/testing/mistakes.hpp>

#include "photo_folder.hpp"

namespace weft::photo {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::mistakes_of;
using testing::PluginAnswer;

constexpr const char* kSize = ", width_m: 0.297";

Template built(const PluginAnswer& answer) {
  EXPECT_TRUE(answer.status == WEFT_OK || answer.status == WEFT_DEGENERATE) << answer.message;
  auto templ = answer.get<Template>();
  if (!templ) throw std::runtime_error("no template: " + answer.message);
  return *std::move(templ);
}

cv::Mat texture_in(const Template& templ) {
  return cv::Mat(static_cast<int>(templ.texture.dim(0)), static_cast<int>(templ.texture.dim(1)),
                 templ.texture.ndim() == 2 ? CV_8UC1 : CV_8UC3,
                 const_cast<std::uint8_t*>(templ.texture.data()))
      .clone();
}

double height_of(const Template& templ) {
  const auto heights = templ.vertices_m.matrix<3>().col(1);
  return heights.maxCoeff() - heights.minCoeff();
}

/// The correlation of two images once both are 200 px wide and blurred: 1 for the same.
double correlation(const cv::Mat& a, const cv::Mat& b) {
  const auto small = [](const cv::Mat& picture) {
    cv::Mat grey = picture, result;
    if (picture.channels() == 3) cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
    cv::resize(grey, result, {200, 141}, 0.0, 0.0, cv::INTER_AREA);
    return result;
  };
  cv::Mat result;
  cv::matchTemplate(small(a), small(b), result, cv::TM_CCOEFF_NORMED);
  return static_cast<double>(result.at<float>(0, 0));
}

TEST(PhotoTemplate, IsTheSheetAsItWasPrinted) {
  PhotoFolder folder;
  Still still = still_of(960, true);
  still.tilt_rad = 0.4;
  still.roll_rad = 0.15;
  still.turn_rad = 0.2;
  folder.take(still);
  const PluginAnswer answer = folder.build(kSize + folder.with_camera());
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  const Template templ = built(answer);
  EXPECT_NEAR(height_of(templ) / still.height_m, 1.0, 0.005);
  EXPECT_GT(correlation(texture_in(templ), still.print), 0.98);
  const auto vertices_m = templ.vertices_m.matrix<3>();
  const auto flat_px = templ.flat_px.matrix<2>();
  EXPECT_NEAR(vertices_m.col(0).maxCoeff() - vertices_m.col(0).minCoeff(), 0.297, 1e-12);
  for (Eigen::Index v = 0; v < flat_px.rows(); ++v) {
    EXPECT_NEAR(vertices_m(v, 0), templ.m_per_px(0) * flat_px(v, 0), 1e-12);
    EXPECT_NEAR(vertices_m(v, 1), templ.m_per_px(1) * flat_px(v, 1), 1e-12);
    EXPECT_EQ(vertices_m(v, 2), 0.0);
  }
  EXPECT_EQ(flat_px(0, 0), -0.5);
  EXPECT_TRUE(validate_flat_mesh(flat_px, templ.faces.matrix<3>()));
  EXPECT_NEAR(templ.m_per_px(0) / templ.m_per_px(1), 1.0, 0.003) << "texels are square";
  EXPECT_EQ(std::count(templ.mask.data(), templ.mask.data() + templ.mask.size(), 1),
            templ.mask.size());
}

TEST(PhotoTemplate, TakesCornersAsTheyAreGivenInThePhotograph) {
  PhotoFolder folder;
  Still still = still_of(640, true);
  still.tilt_rad = 0.3;
  folder.take(still);
  std::string corners;
  for (const Eigen::Vector2d& corner : true_corners_seen(still)) {
    corners += (corners.empty() ? "" : ", ") + std::to_string(corner.x()) + ", " +
               std::to_string(corner.y());
  }
  const Template templ =
      built(folder.build(kSize + folder.with_camera() + ", corners: [" + corners + "]"));
  EXPECT_NEAR(height_of(templ) / still.height_m, 1.0, 1e-4);
  EXPECT_GT(correlation(texture_in(templ), still.print), 0.98);
}

TEST(PhotoTemplate, SaysThatItIsNotCalibratedAndHowWellItsHeightIsKnown) {
  PhotoFolder folder;
  Still still = still_of(960, false);
  still.tilt_rad = 0.35;
  folder.take(still);
  const PluginAnswer guessed = folder.build(kSize);
  EXPECT_EQ(guessed.status, WEFT_DEGENERATE);
  EXPECT_THAT(guessed.message,
              AllOf(HasSubstr("photo.png: not calibrated"), HasSubstr("give 'height_m' or")));
  EXPECT_NEAR(height_of(built(guessed)) / still.height_m, 1.0, 0.03);
  const PluginAnswer measured = folder.build(std::string(kSize) + ", height_m: 0.2");
  EXPECT_EQ(measured.status, WEFT_DEGENERATE);
  EXPECT_THAT(measured.message, HasSubstr("not calibrated: without 'camera' what the lens bends"));
  EXPECT_NEAR(height_of(built(measured)), 0.2, 1e-12);
}

TEST(PhotoTemplate, TriesLensesWhereThereIsNoCamera) {
  PhotoFolder folder;
  Still still = still_of(960, true);
  still.tilt_rad = 0.35;
  folder.take(still);
  const PluginAnswer guessed = folder.build(kSize);
  EXPECT_THAT(guessed.message, HasSubstr("not calibrated"));
  const Template templ = built(guessed);
  EXPECT_NEAR(height_of(templ) / still.height_m, 1.0, 0.03);
  EXPECT_GT(correlation(texture_in(templ), still.print), 0.97);
}

TEST(PhotoTemplate, DoubtsAHeightThatTheCornersContradict) {
  PhotoFolder folder;
  const Still still = still_of(640, false);
  folder.take(still);
  const PluginAnswer answer = folder.build(kSize + folder.with_camera() + ", height_m: 0.25");
  EXPECT_EQ(answer.status, WEFT_DEGENERATE);
  EXPECT_THAT(answer.message, HasSubstr("'height_m' is 0.25, but by corners and camera it is 0.2"));
}

TEST(PhotoTemplate, ProposesAMeshFromTheKeypointsAndTakesOneThatIsGiven) {
  PhotoFolder folder;
  Still still = still_of(640, false);
  folder.take(still);
  const std::string params = kSize + folder.with_camera();
  const auto rich = built(folder.build(params)).vertices_m.rows();
  EXPECT_EQ(built(folder.build(params + ", columns: 7, rows: 4")).vertices_m.rows(), 28);
  EXPECT_EQ(built(folder.build(params + ", columns: 8")).vertices_m.rows(), 8 * 6);
  cv::GaussianBlur(still.print, still.print, {}, 40.0);
  folder.take(still);
  const auto poor = built(folder.build(params)).vertices_m.rows();
  EXPECT_EQ(poor, 7 * 5) << "24 cells, 6 x 4";
  EXPECT_GT(rich, poor);
  EXPECT_LE(rich, 220);
}

TEST(PhotoTemplate, DrawsWhatItFound) {
  PhotoFolder folder;
  folder.take(still_of(640, false));
  const std::string drawing = folder.path("corners.png");
  built(folder.build(kSize + folder.with_camera() + ", drawing: '" + drawing + "'"));
  const cv::Mat picture = cv::imread(drawing, cv::IMREAD_UNCHANGED);
  EXPECT_EQ(picture.size(), cv::Size(640, 480));
  EXPECT_EQ(picture.channels(), 3);
}

TEST(PhotoTemplate, SaysWhichSideIsTheBorderOfThePhotograph) {
  PhotoFolder folder;
  Still still = still_of(640, false);
  const Camera& camera = still.camera.camera;
  const double below_px = static_cast<double>(camera.height_px) + 40.0 - camera.cy;
  still.aside_m.y() = below_px * still.distance_m / camera.fy - 0.5 * still.height_m;
  folder.take(still);
  const PluginAnswer answer = folder.build(kSize + folder.with_camera());
  EXPECT_EQ(answer.status, WEFT_DEGENERATE) << answer.message;
  EXPECT_THAT(answer.message, HasSubstr("the lower side of the object is the border"));
  const double seen_m = still.height_m - 40.5 * still.distance_m / camera.fy;
  EXPECT_NEAR(height_of(built(answer)) / seen_m, 1.0, 0.01);
}

/// A JPEG file whose EXIF data specify an orientation.
void write_turned_jpeg(const PhotoFolder& folder, const cv::Mat& picture, char orientation) {
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, 95});
  const char exif[] = {'\xFF', '\xE1', 0, 34, 'E',         'x', 'i', 'f', 0,    0, 'I', 'I',
                       42,     0,      8, 0,  0,           0,   1,   0,   0x12, 1, 3,   0,
                       1,      0,      0, 0,  orientation, 0,   0,   0,   0,    0, 0,   0};
  jpeg.insert(jpeg.begin() + 2, std::begin(exif), std::end(exif));
  folder.files().write("photo.png", std::string(jpeg.begin(), jpeg.end()));
}

TEST(PhotoTemplate, TurnsAPhotographUprightAsItsExifDataSays) {
  PhotoFolder folder;
  const Still still = still_of(640, false);
  cv::Mat on_its_side;
  cv::rotate(photographed(still), on_its_side, cv::ROTATE_90_COUNTERCLOCKWISE);
  write_turned_jpeg(folder, on_its_side, 6);  // to be turned by 90 degrees clockwise
  folder.write_camera(still.camera);
  const Template templ = built(folder.build(kSize + folder.with_camera()));
  EXPECT_NEAR(height_of(templ) / still.height_m, 1.0, 0.005);
  EXPECT_GT(correlation(texture_in(templ), still.print), 0.98);
  write_turned_jpeg(folder, on_its_side, 1);
  const PluginAnswer refused = folder.build(kSize + folder.with_camera());
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("is 480 x 640 px, but"), HasSubstr("640 x 480 px"),
                                     HasSubstr("camera held as for the calibration")));
}

TEST(PhotoTemplate, RotatesTheCameraOfTheSensorWithThePhotograph) {
  PhotoFolder folder;
  const Still still = still_of(640, false);
  folder.write_camera(still.camera);
  write_turned_jpeg(folder, photographed(still), 6);
  const double height_m = still.height_m;
  const Template templ =
      built(folder.build(", width_m: " + std::to_string(height_m) + folder.with_camera()));
  EXPECT_NEAR(height_of(templ) / 0.297, 1.0, 0.005);
  cv::Mat turned;
  cv::rotate(still.print, turned, cv::ROTATE_90_CLOCKWISE);
  EXPECT_GT(correlation(texture_in(templ), turned), 0.98);
}

TEST(PhotoTemplate, SaysWhatToChangeWhereASheetCannotBe) {
  PhotoFolder folder;
  folder.files().write_image("photo.png", cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(120)));
  folder.files().write("camera.yaml",
                       "{fx: 500, fy: 500, cx: 300, cy: 200, width: 640, height: 480}");
  const auto mistake = [&](const std::string& more) {
    const PluginAnswer answer = folder.build(kSize + more);
    EXPECT_EQ(answer.status, WEFT_ERROR) << more;
    return answer.message;
  };
  EXPECT_THAT(mistake(""),
              AllOf(HasSubstr("photo.png: no object is found"), HasSubstr("'corners'")));
  EXPECT_THAT(mistake(folder.with_camera()),
              AllOf(HasSubstr("is 320 x 240 px, but"), HasSubstr("640 x 480 px")));
  EXPECT_THAT(mistake(", corners: [10, 10, 400, 12, 200, 200, 10, 200]"),
              HasSubstr("the top right corner at (400, 12) px lies outside of the photograph"));
  EXPECT_THAT(mistake(", corners: [10, 10, 10, 200, 200, 200, 200, 10]"),
              HasSubstr("anticlockwise"));
  EXPECT_THAT(mistake(", corners: [10, 10, 200, 200, 200, 10, 10, 200]"), HasSubstr("cross"));
  EXPECT_THAT(mistake(", corners: [10, 10, 100, 10, 200, 11, 10, 200]"), HasSubstr("on a line"));
  EXPECT_THAT(mistake(", corners: [10, 10, 200, 10, 50, 30, 10, 200]"), HasSubstr("not convex"));
  EXPECT_THAT(mistake(", corners: [120, 100, 200, 100, 310, 140, 5, 140]"),
              HasSubstr("degrees from straight above, too obliquely"));
  const std::string square = ", corners: [10, 10, 200, 10, 200, 200, 10, 200]";
  EXPECT_THAT(mistake(", height_m: 0.002" + square),
              HasSubstr("check 'width_m', 'height_m' and 'corners', or take it larger"));
  EXPECT_THAT(mistake(", texture_px: 20" + square), HasSubstr("raise 'texture_px'"));
}

TEST(PhotoTemplate, FindsMistakesBeforeAnythingRuns) {
  PhotoFolder folder;
  folder.files().write_image("photo.png", cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(120)));
  folder.files().write("empty.png", "");
  folder.files().write("camera.yaml", "{fx: 0}");
  const auto mistakes = [&](const std::string& photo, const std::string& more) {
    return mistakes_of("templates/photo",
                       "{photo: '" + folder.path(photo) + "', width_m: 0.3" + more + "}");
  };
  EXPECT_THAT(mistakes("photo.png", ""), ElementsAre());
  EXPECT_THAT(mistakes("empty.png", ""),
              ElementsAre(AllOf(HasSubstr("photo: "), HasSubstr("empty"))));
  EXPECT_THAT(mistakes("photo.png", folder.with_camera()), ElementsAre(HasSubstr("camera: ")));
  EXPECT_THAT(mistakes("photo.png", ", corners: [1, 2, 3]"),
              ElementsAre(HasSubstr("'corners' has 3 numbers and needs 8")));
  EXPECT_THAT(mistakes("photo.png", ", rows: 1"), ElementsAre(HasSubstr("2 vertices or more")));
  EXPECT_THROW(mistakes("none.png", ""), std::runtime_error);
  EXPECT_THROW(
      mistakes_of("templates/photo", "{photo: '" + folder.path("photo.png") + "', width_m: 0}"),
      std::runtime_error);
}

}  // namespace
}  // namespace weft::photo
