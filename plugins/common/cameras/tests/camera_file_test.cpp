// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/camera_file.hpp"

#include <gmock/gmock.h>

#include <opencv2/core/persistence.hpp>

#include "common/cameras/tests/frame_folder.hpp"

namespace weft::cameras {
namespace {

using testing::FrameFolder;
using ::testing::HasSubstr;

Result<CameraFile> read(const std::string& content) {
  const FrameFolder folder;
  folder.write("camera.yaml", content);
  return read_camera_file(folder.path("camera.yaml"));
}

void expect_camera(const std::string& content) {
  const auto file = read(content);
  ASSERT_TRUE(file) << file.error().message;
  const Camera& camera = file->camera;
  EXPECT_EQ(camera.fx, 500.25);
  EXPECT_EQ(camera.fy, 510.0);
  EXPECT_EQ(camera.cx, 3.5);
  EXPECT_EQ(camera.cy, -2.5);
  EXPECT_EQ(camera.width_px, 8);
  EXPECT_EQ(camera.height_px, 6);
}

void expect_refusal(const std::string& content, const std::vector<std::string>& parts) {
  const auto file = read(content);
  ASSERT_FALSE(file) << content;
  for (const std::string& part : parts) EXPECT_THAT(file.error().message, HasSubstr(part));
}

const std::string kMatrix =
    "camera_matrix: {rows: 3, cols: 3, data: [500.25, 0, 3.5, 0, 510, -2.5, 0, 0, 1]}\n";

TEST(CameraFile, ReadsYamlWithNotes) {
  expect_camera(
      "fx: 500.25\nfy: 5.1e2\ncx: 3.5\ncy: -2.5\nwidth: 8\nheight: 6.0\n"
      "distortion: null\nconvention: \"whatever\"\ncomment: {a: 1}\n");
}

TEST(CameraFile, ReadsNothingBehindWhatTheLibraryTakesForTheEnd) {
  const std::string camera = "{fx: 500, fy: 510, cx: 3, cy: 2, width: 8, height: 6}\n";
  expect_refusal("", {"camera.yaml:1:1: must hold keys"});
  expect_refusal(camera + "é\x04 fx: 9\n", {"camera.yaml:2:2: a control character"});
  expect_refusal("{fx: 1, cx: \xC3}\n", {"camera.yaml:1:13: no UTF-8"});
  expect_refusal("{comment: é, fx: 1, nofx: 1}\n", {"camera.yaml:1:21: a camera file has no key"});
  expect_refusal(camera + "---\nfx: 9\n", {"camera.yaml:2:1: more than one document"});
  expect_refusal(camera + "...\nfx: 9\n", {"camera.yaml:3:1: more than one document"});
}

TEST(CameraFile, IsRefusedWhereTheLibraryWouldBeginEmptyDocumentsForEver) {
  const std::string camera = "{fx: 500, fy: 510, cx: 3, cy: 2, width: 8, height: 6}";
  expect_refusal(",", {"camera.yaml:1:1: cannot be understood from here on"});
  expect_refusal(camera + "}\n", {"camera.yaml:1:54: cannot be understood from here on"});
  expect_refusal(camera + "\n, fx: 9\n", {"camera.yaml:2:1: cannot be understood from here on"});
  expect_refusal("\xEF\xBB\xBF" + camera + "\n---\n]\n",
                 {"camera.yaml:2:1: more than one document"});
}

TEST(CameraFile, ReadsJsonIndentedWithTabs) {
  expect_camera(
      "{\n\t\"fx\": 500.25,\n\t\"fy\": 510, \"cx\": 3.5,\r\n\t\"cy\": -2.5,\n"
      "\t\"width\": 8, \"height\": 6, \"distortion\": []\n}\n");
}

TEST(CameraFile, ReadsWhatOpenCvWrites) {
  const FrameFolder folder;
  {
    cv::FileStorage file(folder.path("opencv.yaml"), cv::FileStorage::WRITE);
    const cv::Mat k = (cv::Mat_<double>(3, 3) << 500.25, 0, 3.5, 0, 510, -2.5, 0, 0, 1);
    cv::Mat d = cv::Mat::zeros(5, 1, CV_64F);
    d.at<double>(0) = -0.1;
    file << "calibration_time"
         << "Thu 01 Jan 1970"
         << "image_width" << 8 << "image_height" << 6;
    file << "camera_matrix" << k << "distortion_coefficients" << d;
  }
  std::ifstream stream(folder.path("opencv.yaml"));
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  ASSERT_THAT(text, HasSubstr("%YAML:1.0"));
  ASSERT_THAT(text, HasSubstr("!!opencv-matrix"));
  expect_camera(text);
}

TEST(CameraFile, ReadsRosCameraInfoOfEachModel) {
  const std::string head = "image_width: 8\nimage_height: 6\ncamera_name: narrow\n" + kMatrix;
  expect_camera(head +
                "distortion_model: plumb_bob\n"
                "distortion_coefficients: {rows: 1, cols: 5, data: [-0.1, 0, 0, 0, 0]}\n"
                "rectification_matrix: {rows: 1, cols: 1, data: [1]}\n");
  expect_camera(head +
                "distortion_model: rational_polynomial\n"
                "distortion_coefficients: {rows: 1, cols: 8, data: [1,0,0,0,0,1,0,0]}\n");
  expect_camera(head +
                "distortion_model: equidistant\n"
                "distortion_coefficients: {rows: 1, cols: 4, data: [0.1, 0, 0, 0]}\n");
}

TEST(CameraFile, AcceptsTheZerosWithWhichOpenCvPadsTheRationalModel) {
  expect_camera("image_width: 8\nimage_height: 6\n" + kMatrix +
                "distortion_coefficients: {rows: 14, cols: 1, data: "
                "[0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0, 0, 0, 0]}\n");
}

TEST(CameraFile, NamesThePlaceAndTheKeyThatIsWrong) {
  const std::string rest = "fy: 510\ncx: 3.5\ncy: 2.5\nwidth: 8\nheight: 6\n";
  expect_refusal("fx: .nan\n" + rest, {"camera.yaml:1:5", "'fx'", "finite", ".nan"});
  expect_refusal("fx: .inf\n" + rest, {"'fx'", "finite"});
  expect_refusal("fx: nan\n" + rest, {"'fx'", "finite"});
  expect_refusal("fx: -500\n" + rest, {"'fx'", "larger than 0", "-500"});
  expect_refusal("fx: 0\n" + rest, {"'fx'", "larger than 0"});
  expect_refusal("fx: 500px\n" + rest, {"'fx'", "500px"});
  expect_refusal("fx: [500]\n" + rest, {"'fx'", "must be a number"});
  expect_refusal(rest, {"camera.yaml", "no 'fx'"});
  expect_refusal("fx: null\n" + rest, {"no 'fx'"});
  expect_refusal("fx: 1\nfx: 2\n" + rest, {"camera.yaml:2:1", "given twice"});
}

TEST(CameraFile, RefusesSizesThatAreNoSizes) {
  const std::string rest = "fx: 500\nfy: 510\ncx: 3.5\ncy: 2.5\nheight: 6\n";
  for (const char* width : {"0", "-8", "8.5", "40000", "1e300"}) {
    expect_refusal(rest + "width: " + width + "\n", {"'width'", "whole number", width});
  }
}

TEST(CameraFile, RefusesDistortionThatItDoesNotKnow) {
  const std::string head = "fx: 5\nfy: 5\ncx: 3.5\ncy: 2.5\nwidth: 8\nheight: 6\ndistortion: ";
  expect_refusal(head + "[1, 2, 3]", {":7:13", "3 distortion coefficients", "5"});
  expect_refusal(head + "[0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0]", {"12 distortion"});
  expect_refusal(head + "[.nan, 0, 0, 0, 0]", {"'distortion'", "finite"});
  expect_refusal(head + "0.1", {"list of numbers"});
  expect_refusal(head + "{model: fisheye, coefficients: [1, 2, 3, 4, 5]}", {"fisheye has 4"});
  expect_refusal(head + "{model: division, coefficients: [1]}", {"'division' is unknown"});
  expect_refusal(head + "{model: fisheye}", {"'coefficients'"});
}

TEST(CameraFile, RefusesBrokenMatrices) {
  const std::string head = "image_width: 8\nimage_height: 6\n";
  expect_refusal(head + "camera_matrix: {rows: 3, cols: 3, data: [1, 2]}\n", {"rows x cols"});
  expect_refusal(head + "camera_matrix: {rows: 1, cols: 2, data: [1, 2]}\n", {"3 x 3"});
  expect_refusal(head + "camera_matrix: [1, 2]\n", {"rows, cols and data"});
  expect_refusal(
      head + "camera_matrix: {rows: 3, cols: 3, data: [500, 0.2, 3, 0, 500, 2, 0, 0, 1]}\n",
      {"skew"});
  expect_refusal(head + "camera_matrix: {rows: 3, cols: 3, data: [-5, 0, 3, 0, 500, 2, 0, 0, 1]}\n",
                 {"larger than 0"});
  expect_refusal("image_width: 8\n" + kMatrix, {"no 'image_height'"});
}

TEST(CameraFile, RefusesKeysThatItDoesNotKnow) {
  const std::string own = "fx: 5\nfy: 5\ncx: 3.5\ncy: 2.5\nwidth: 8\nheight: 6\n";
  expect_refusal(own + "distorsion: [0.1, 0, 0, 0, 0]\n",
                 {"camera.yaml:7:1", "no key 'distorsion'", "did you mean 'distortion'?"});
  expect_refusal(own + "anything: 1\n", {":7:1", "no key 'anything'", "'comment'"});
  expect_refusal("image_width: 8\nimage_height: 6\n" + kMatrix + "distortion_coefficient: 1\n",
                 {"did you mean 'distortion_coefficients'?"});
  expect_camera("image_width: 8\nimage_height: 6\n" + kMatrix +
                "calibration_time: now\nnframes: 12\nsquare_size: 0.03\n");
}

TEST(CameraFile, RefusesWhatNoCameraCanHave) {
  const auto own = [](const std::string& cx, const std::string& cy, const std::string& fy) {
    return "fx: 500\nfy: " + fy + "\ncx: " + cx + "\ncy: " + cy + "\nwidth: 640\nheight: 480\n";
  };
  ASSERT_TRUE(read(own("-640", "960", "5000")));
  ASSERT_TRUE(read(own("1280", "-480", "50")));
  expect_refusal(own("99999", "240", "500"), {"camera.yaml:3:5", "'cx' is 99999", "-640 to 1280"});
  expect_refusal(own("320", "-481", "500"), {"camera.yaml:4:5", "'cy' is -481", "-480 to 960"});
  expect_refusal(own("320", "240", "5001"), {"camera.yaml:2:5", "'fy' is 5001", "50 to 5000"});
  expect_refusal(own("320", "240", "1e9"),
                 {"camera.yaml:2:5", "'fy' is 1000000000", "0.01 to 10000000"});
  expect_refusal(
      "image_width: 8\nimage_height: 6\n"
      "camera_matrix: {rows: 3, cols: 3, data: [500, 0, 77, 0, 500, 2, 0, 0, 1]}\n",
      {":3:50", "'cx' is 77", "-8 to 16"});
}

TEST(CameraFile, DoesNotReadWhatCalibrationSaysOfItsResult) {
  expect_camera(
      "fx: 500.25\nfy: 510\ncx: 3.5\ncy: -2.5\nwidth: 8\nheight: 6\ndistortion: null\n"
      "calibration:\n  rms_px: 0.1\n  images:\n    - {name: \"a.png\", corners: 24, rms_px: "
      "0.1}\n");
}

TEST(CameraFile, RefusesDistortionThatLeavesNothingOfTheImage) {
  const std::string own = "fx: 500\nfy: 500\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\n";
  ASSERT_TRUE(read(own + "distortion: [-0.35, 0.18, 0.001, -0.001, -0.05]\n"));
  ASSERT_TRUE(read(own + "distortion: {model: fisheye, coefficients: [0.1, 0.02, 0, 0]}\n"));
  expect_refusal(own + "distortion: [1e6, 0, 0, 0, 0]\n", {":7:13", "less than a tenth"});
  expect_refusal(own + "distortion: [0, 0, 0, 900, 0]\n", {"less than a tenth"});
}

TEST(CameraFile, RefusesWhatIsNoRegularFile) {
  const auto folder = read_camera_file("/tmp");
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().message,
            "/tmp: cannot be read: it is a folder: correct 'camera' or its file");
  EXPECT_THAT(read_camera_file("/dev/zero").error().message, HasSubstr("no regular file"));
}

TEST(CameraFile, RefusesTextThatIsNoCamera) {
  expect_refusal("", {"camera.yaml", "must hold keys"});
  expect_refusal("just text", {"must hold keys"});
  expect_refusal("[1, 2]", {"must hold keys"});
  expect_refusal("fx: [1, 2", {"camera.yaml:", "cannot be understood from here on"});
  expect_refusal("{\"fx\": 1,, }}", {"camera.yaml:", "cannot be understood from here on"});
  expect_refusal(std::string(2 << 20, ' '), {"more than 1048576 bytes"});
}

}  // namespace
}  // namespace weft::cameras
