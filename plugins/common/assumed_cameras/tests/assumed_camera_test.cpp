// SPDX-License-Identifier: Apache-2.0
#include "common/assumed_cameras/assumed_camera.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace weft::cameras {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kFilm_mm = 43.27;

PhotoFacts photo(int width, int height, int focal_mm = 0, cv::Size exif = {}) {
  return {"folder/" + std::to_string(width) + ".jpg", {width, height}, focal_mm, exif};
}

Camera assumed(const std::vector<PhotoFacts>& photos) {
  const auto camera = assume_camera(photos);
  EXPECT_TRUE(camera) << camera.error().message;
  return camera ? *camera : Camera{};
}

/// [] of the focal length.
double relative_sd(const Camera& camera) {
  return CameraAssumption::of(camera)->focal_sd_px / camera.fx;
}

TEST(AssumedCamera, TakesTheFocalLengthOfAWholeImageByItsDiagonal) {
  for (const cv::Size size : {cv::Size(4000, 3000), cv::Size(3000, 4000)}) {
    const Camera camera = assumed({photo(size.width, size.height, 26)});
    EXPECT_DOUBLE_EQ(camera.fx, 26 / kFilm_mm * 5000);
    EXPECT_EQ(camera.fy, camera.fx);
    EXPECT_EQ(camera.cx, 0.5 * (size.width - 1));
    EXPECT_EQ(camera.cy, 0.5 * (size.height - 1));
    EXPECT_NEAR(relative_sd(camera), 0.05, 1e-9);
    EXPECT_DOUBLE_EQ(CameraAssumption::of(camera)->cx_sd_px, 40.0);
    EXPECT_DOUBLE_EQ(CameraAssumption::of(camera)->cy_sd_px, 40.0);
  }
}

TEST(AssumedCamera, TakesTheWholeSizeOfACroppedImageFromExif) {
  const Camera camera = assumed({photo(2000, 2200, 26, {4000, 3000})});
  EXPECT_DOUBLE_EQ(camera.fx, 26 / kFilm_mm * 5000);
  EXPECT_NEAR(relative_sd(camera), 0.05, 1e-9);
  const auto assumption = *CameraAssumption::of(camera);
  EXPECT_DOUBLE_EQ(assumption.cx_sd_px, std::hypot(22.0, 2000 / std::sqrt(12.0)));
  EXPECT_DOUBLE_EQ(assumption.cy_sd_px, std::hypot(22.0, 800 / std::sqrt(12.0)));
}

TEST(AssumedCamera, AssumesTwelveMegapixelsWhereACropDoesNotSayItsWholeSize) {
  // Programs that crop write the new size into EXIF.
  const Camera camera = assumed({photo(1951, 2154, 26, {1951, 2154})});
  EXPECT_DOUBLE_EQ(camera.fx, 26 / kFilm_mm * 5040);
  EXPECT_NEAR(relative_sd(camera), 0.20, 1e-9);
  EXPECT_THAT(assumption_text(camera),
              AllOf(HasSubstr("not calibrated"), HasSubstr("1951.jpg"), HasSubstr("26 mm"),
                    HasSubstr("cropped from 3024 x 4032 px by assumption")));
}

TEST(AssumedCamera, ACropIsNeverLargerThanItsWhole) {
  const Camera camera = assumed({photo(5000, 4500, 26)});
  EXPECT_DOUBLE_EQ(camera.fx, 26 / kFilm_mm * std::hypot(6000, 4500));
}

TEST(AssumedCamera, AWholeImageTellsTheSizeOfTheCroppedOnes) {
  const Camera camera = assumed({photo(2000, 2200, 26), photo(3264, 2448, 26)});
  EXPECT_DOUBLE_EQ(camera.fx, 26 / kFilm_mm * 4080);
  EXPECT_EQ(camera.width_px, 3264);
  EXPECT_EQ(camera.height_px, 2448);
  EXPECT_NEAR(relative_sd(camera), 0.05, 1e-9);
}

TEST(AssumedCamera, ACropWithTheSidesOfASensorByChanceIsNoWholeImage) {
  const Camera camera = assumed({photo(1500, 2000, 26), photo(1951, 2154, 26)});
  EXPECT_DOUBLE_EQ(camera.fx, 26 / kFilm_mm * 5040);
  EXPECT_NEAR(relative_sd(camera), 0.20, 1e-9);
  const Camera beside_whole = assumed({photo(1646, 2200, 26), photo(3024, 4032, 26)});
  EXPECT_DOUBLE_EQ(beside_whole.fx, 26 / kFilm_mm * 5040);
  EXPECT_NEAR(relative_sd(beside_whole), 0.05, 1e-9);
}

TEST(AssumedCamera, RefusesOneImageAtTwoScales) {
  EXPECT_FALSE(assume_camera({photo(4032, 3024, 26), photo(2016, 1512, 26)}));
}

TEST(AssumedCamera, TakesTheLongerSideWithoutExif) {
  const Camera camera = assumed({photo(640, 480), photo(480, 640)});
  EXPECT_EQ(camera.fx, 640);
  EXPECT_EQ(camera.width_px, 640);
  EXPECT_EQ(camera.height_px, 640);
  EXPECT_EQ(camera.cx, 319.5);
  EXPECT_NEAR(relative_sd(camera), 0.25, 1e-9);
  EXPECT_THAT(assumption_text(camera), HasSubstr("the longer side"));
}

TEST(AssumedCamera, ImagesWithoutExifHaveTheFocalLengthOfTheOthers) {
  EXPECT_DOUBLE_EQ(assumed({photo(4000, 3000), photo(4000, 3000, 26)}).fx, 26 / kFilm_mm * 5000);
}

TEST(AssumedCamera, RefusesImagesOfTwoFocalLengths) {
  const auto camera = assume_camera({photo(4000, 3000, 26), photo(4001, 3000, 52)});
  ASSERT_FALSE(camera);
  EXPECT_EQ(camera.error().code, Errc::invalid_data);
  EXPECT_THAT(camera.error().message,
              AllOf(HasSubstr("folder/4001.jpg"), HasSubstr("4000.jpg"), HasSubstr("camera file")));
  EXPECT_FALSE(assume_camera({}));
}

TEST(AssumedCamera, ACalibratedCameraHasNoAssumption) {
  EXPECT_FALSE(CameraAssumption::of(Camera{}).has_value());
  EXPECT_EQ(assumption_text(Camera{}), "");
}

}  // namespace
TEST(AssumedCamera, TakesAKnownFocalLengthInPlaceOfWhatExifSays) {
  for (const cv::Size size : {cv::Size(4000, 3000), cv::Size(3000, 4000)}) {
    const auto camera = assume_camera({photo(size.width, size.height, 26)}, {1.25, 0.05});
    ASSERT_TRUE(camera);
    EXPECT_DOUBLE_EQ(camera->fx, 5000.0);
    EXPECT_DOUBLE_EQ(camera->fy, 5000.0);
    EXPECT_NEAR(relative_sd(*camera), 0.04, 1e-9);
    EXPECT_THAT(assumption_text(*camera), HasSubstr("'focal_by_side' 1.25"));
  }
  EXPECT_NEAR(relative_sd(*assume_camera({photo(4000, 3000, 26)}, {1.25, 0.0})), 0.05, 1e-9);
}

TEST(AssumedCamera, RefusesAKnownFocalLengthBesideACameraFileAndADeviationByItself) {
  EXPECT_TRUE(check(KnownFocal{}, false));
  EXPECT_TRUE(check(KnownFocal{1.25, 0.05}, true));
  EXPECT_FALSE(check(KnownFocal{1.25, 0.05}, false));
  EXPECT_FALSE(check(KnownFocal{0.0, 0.05}, true));
}

}  // namespace weft::cameras
