// SPDX-License-Identifier: Apache-2.0
// One camera, as different programs write it.
#include <gmock/gmock.h>

#include <opencv2/core/persistence.hpp>

#include "common/cameras/camera_file.hpp"
#include "common/cameras/tests/frame_folder.hpp"

namespace weft::cameras {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::FrameFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Result<CameraFile> read_text(const std::string& content) {
  const FrameFolder folder;
  folder.write("camera.txt", content);
  return read_camera_file(folder.path("camera.txt"));
}

std::string refusal_of(const std::string& content) {
  const auto file = read_text(content);
  EXPECT_FALSE(file) << content;
  return file ? "" : file.error().message;
}

void expect_pinhole(const std::string& content) {
  const auto file = read_text(content);
  ASSERT_TRUE(file) << file.error().message << "\n" << content;
  const Camera& camera = file->camera;
  EXPECT_NEAR(camera.fx, 528.5, 1e-9) << content;
  EXPECT_NEAR(camera.fy, 530.25, 1e-9) << content;
  EXPECT_NEAR(camera.cx, 318.75, 1e-9) << content;
  EXPECT_NEAR(camera.cy, 242.5, 1e-9) << content;
  EXPECT_EQ(camera.width_px, 640) << content;
  EXPECT_EQ(camera.height_px, 480) << content;
}

void expect_brown(const std::string& content) {
  expect_pinhole(content);
  const auto file = read_text(content);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->model, Distortion::brown) << content;
  EXPECT_THAT(file->coefficients, ElementsAre(-0.125, 0.0625, 0.0005, -0.00025, 0.0)) << content;
}

void expect_fisheye(const std::string& content) {
  expect_pinhole(content);
  const auto file = read_text(content);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->model, Distortion::fisheye) << content;
  EXPECT_THAT(file->coefficients, ElementsAre(0.125, -0.0625, 0.03125, -0.015625)) << content;
}

const std::string kOurs = "fx: 528.5\nfy: 530.25\ncx: 318.75\ncy: 242.5\nwidth: 640\nheight: 480\n";
const std::string kK = "[528.5, 0, 318.75, 0, 530.25, 242.5, 0, 0, 1]";
const std::string kD = "[-0.125, 0.0625, 0.0005, -0.00025, 0]";
const std::string kFisheye = "[0.125, -0.0625, 0.03125, -0.015625]";

std::string kalibr(const std::string& model, const std::string& lens, const std::string& values) {
  return "cam0:\n  cam_overlaps: [1]\n  camera_model: " + model +
         "\n  distortion_coeffs: " + values + "\n  distortion_model: " + lens +
         "\n  intrinsics: [528.5, 530.25, 318.75, 242.5]\n  resolution: [640, 480]\n"
         "  rostopic: /cam0/image_raw\n  T_cam_imu:\n  - [1, 0, 0, 0]\n  - [0, 1, 0, 0]\n";
}

TEST(CameraFormats, KalibrAndEuRoCAreRead) {
  const std::string brown = "[-0.125, 0.0625, 0.0005, -0.00025]";
  expect_brown(kalibr("pinhole", "radtan", brown));
  expect_brown("%YAML:1.0\n" + kalibr("pinhole", "radtan", brown));
  expect_fisheye(kalibr("pinhole", "equi", kFisheye));
  expect_brown(kalibr("pinhole", "radtan", brown) +
               "cam1:\n  camera_model: pinhole\n  distortion_coeffs: [0, 0, 0, 0]\n"
               "  distortion_model: radtan\n  intrinsics: [1, 1, 1, 1]\n  resolution: [9, 9]\n");
  expect_brown(
      "sensor_type: camera\ncomment: VI-Sensor cam0\nT_BS:\n  cols: 4\n  rows: 1\n"
      "  data: [0, 1, 0, 0]\nrate_hz: 20\nresolution: [640, 480]\ncamera_model: pinhole\n"
      "intrinsics: [528.5, 530.25, 318.75, 242.5]\ndistortion_model: radial-tangential\n"
      "distortion_coefficients: " +
      brown + "\n");
  for (const char* model : {"omni", "eucm", "ds"}) {
    EXPECT_THAT(refusal_of(kalibr(model, "radtan", brown)),
                AllOf(HasSubstr("camera.txt:3:17: this is a Kalibr"), HasSubstr(model),
                      HasSubstr("pinhole-radtan")));
  }
  EXPECT_THAT(refusal_of(kalibr("pinhole", "fov", "[0.9]")), HasSubstr("'fov' is unknown"));
}

TEST(CameraFormats, RosMessagesAreReadAsTheToolsPrintThem) {
  const std::string head =
      "header:\n  seq: 0\n  stamp:\n    secs: 0\n    nsecs: 0\n  frame_id: camera\n"
      "height: 480\nwidth: 640\n";
  const std::string tail =
      "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\nP: [1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3]\n"
      "binning_x: 0\nbinning_y: 0\nroi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n  width: 0\n"
      "  do_rectify: False\n---\n";
  const std::string one =
      head + "distortion_model: plumb_bob\nD: " + kD + "\nK: " + kK + "\n" + tail;
  expect_brown(one);
  expect_brown(one + one);
  expect_fisheye(head + "distortion_model: equidistant\nD: " + kFisheye + "\nK: " + kK + "\n" +
                 tail);
  expect_pinhole(head + "distortion_model: ''\nD: []\nK: " + kK + "\n" + tail);
  expect_brown(
      "header:\n  stamp:\n    sec: 1\n    nanosec: 2\n  frame_id: left\nheight: 480\nwidth: 640\n"
      "distortion_model: plumb_bob\nd:\n- -0.125\n- 0.0625\n- 0.0005\n- -0.00025\n- 0.0\n"
      "k:\n- 528.5\n- 0.0\n- 318.75\n- 0.0\n- 530.25\n- 242.5\n- 0.0\n- 0.0\n- 1.0\n---\n");
  std::string part = one;
  part.replace(part.find("binning_x: 0"), 12, "binning_x: 2");
  EXPECT_THAT(refusal_of(part), HasSubstr("'binning_x': images of a part"));
  std::string no_camera = one;
  no_camera.replace(no_camera.find(kK), kK.size(), "[0, 0, 0, 0, 0, 0, 0, 0, 1]");
  EXPECT_THAT(refusal_of(no_camera), HasSubstr("larger than 0"));
}

TEST(CameraFormats, OpenCvIsReadUnderTheNamesOfItsSamples) {
  const std::vector<std::pair<std::string, std::string>> names{
      {"camera_matrix", "distortion_coefficients"},
      {"Camera_Matrix", "Distortion_Coefficients"},
      {"cameraMatrix", "distCoeffs"},
      {"K", "D"},
      {"M1", "D1"},
      {"M2", "D2"},
      {"mtx", "dist"},
      {"camera_matrix", "dist_coeffs"}};
  for (const auto& [k, d] : names) {
    for (const char* extension : {"yaml", "xml", "json"}) {
      const FrameFolder folder;
      const std::string path = folder.path(std::string("written.") + extension);
      {
        cv::FileStorage file(path, cv::FileStorage::WRITE);
        file << "calibration_time"
             << "Thu 01 Jan 1970 00:00:00"
             << "image_width" << 640 << "image_height" << 480;
        const cv::Mat matrix =
            (cv::Mat_<double>(3, 3) << 528.5, 0, 318.75, 0, 530.25, 242.5, 0, 0, 1);
        const cv::Mat lens = (cv::Mat_<double>(5, 1) << -0.125, 0.0625, 0.0005, -0.00025, 0);
        file << k << matrix << d << lens << "avg_reprojection_error" << 0.25;
      }
      std::ifstream stream(path);
      expect_brown({std::istreambuf_iterator<char>(stream), {}});
    }
  }
  expect_brown(
      "camera_matrix: [[528.5, 0, 318.75], [0, 530.25, 242.5], [0, 0, 1]]\n"
      "dist_coeff: [[-0.125, 0.0625, 0.0005, -0.00025, 0]]\nimage_size: [640, 480]\n");
  expect_pinhole(
      "{\"width\": 640, \"height\": 480, \"intrinsic_matrix\": [528.5, 0, 0, 0, 530.25, "
      "0, 318.75, 242.5, 1]}");
  EXPECT_THAT(refusal_of("image_width: 640\nimage_height: 480\nK: " + kK + "\nLensDist: " + kD),
              HasSubstr(":4:1: 'LensDist' is not known"));
}

TEST(CameraFormats, ColmapIsReadWithTheCentreOfItsPixels) {
  const std::string head =
      "# Camera list with one line of data per camera:\n"
      "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n# Number of cameras: 1\n";
  expect_pinhole(head + "1 PINHOLE 640 480 528.5 530.25 319.25 243\n");
  expect_brown(head + "1 OPENCV 640 480 528.5 530.25 319.25 243 -0.125 0.0625 0.0005 -0.00025\r\n");
  expect_brown(
      "7 OPENCV 640 480 528.5 530.25 319.25 243 -0.125 0.0625 0.0005 -0.00025\n"
      "8 PINHOLE 9 9 5 5 4 4\n");
  const auto full = read_text("7 FULL_OPENCV 640 480 528.5 530.25 319.25 243 1 2 0 0 3 1 2 3\n");
  ASSERT_TRUE(full) << full.error().message;
  EXPECT_THAT(full->coefficients, ElementsAre(1, 2, 0, 0, 3, 1, 2, 3));
  expect_fisheye(head +
                 "1 OPENCV_FISHEYE 640 480 528.5 530.25 319.25 243 0.125 -0.0625 0.03125 "
                 "-0.015625\n");
  const auto simple = read_text("1 SIMPLE_PINHOLE 640 480 500 320 240\n");
  ASSERT_TRUE(simple) << simple.error().message;
  EXPECT_EQ(simple->camera.fy, 500.0);
  EXPECT_EQ(simple->camera.cx, 319.5);
  EXPECT_THAT(simple->coefficients, IsEmpty());
  const auto radial = read_text("1 SIMPLE_RADIAL 640 480 500 320 240 -0.125\n");
  ASSERT_TRUE(radial) << radial.error().message;
  EXPECT_THAT(radial->coefficients, ElementsAre(-0.125, 0, 0, 0, 0));
  const auto two = read_text("1 RADIAL 640 480 500 320 240 -0.125 0.0625\n");
  ASSERT_TRUE(two) << two.error().message;
  EXPECT_THAT(two->coefficients, ElementsAre(-0.125, 0.0625, 0, 0, 0));
  EXPECT_THAT(refusal_of("1 FOV 640 480 500 500 320 240 0.9\n"),
              AllOf(HasSubstr(":1:3: this is a COLMAP camera"), HasSubstr("'FOV'")));
  EXPECT_THAT(refusal_of("1 OPENCV 640 480 500 500 320 240 0.9\n"),
              HasSubstr("OPENCV has 8 parameters, not 5"));
}

TEST(CameraFormats, OrbSlamIsRead) {
  for (const std::string name : {"Camera", "Camera1"}) {
    const auto line = [&](const std::string& key, const std::string& value) {
      return name + "." + key + ": " + value + "\n";
    };
    const std::string head = "%YAML:1.0\n\n#-----\n# Camera Parameters\n#-----\n";
    const std::string pinhole =
        line("fx", "528.5") + line("fy", "530.25") + line("cx", "318.75") + line("cy", "242.5");
    const std::string size = "Camera.width: 640\nCamera.height: 480\nCamera.fps: 20.0\n";
    expect_brown(head + "Camera.type: \"PinHole\"\n" + pinhole + line("k1", "-0.125") +
                 line("k2", "0.0625") + line("p1", "0.0005") + line("p2", "-0.00025") + size);
    expect_fisheye(head + "Camera.type: \"KannalaBrandt8\"\n" + pinhole + line("k1", "0.125") +
                   line("k2", "-0.0625") + line("k3", "0.03125") + line("k4", "-0.015625") + size);
    EXPECT_THAT(refusal_of(head + pinhole + line("k1", "0")),
                HasSubstr("has no 'Camera.width': add 'Camera.width: N', the width of the images"));
  }
}

TEST(CameraFormats, RealSenseIsReadWhereItsModelIsTheSame) {
  const auto text = [](const std::string& model, const std::string& coefficients) {
    return "{\"width\": 640, \"height\": 480, \"ppx\": 318.75, \"ppy\": 242.5, \"fx\": 528.5, "
           "\"fy\": 530.25, \"model\": \"" +
           model + "\", \"coeffs\": " + coefficients + "}";
  };
  const std::string zeros = "[0.0, 0.0, 0.0, 0.0, 0.0]";
  for (const char* model : {"distortion.inverse_brown_conrady", "Inverse Brown Conrady",
                            "RS2_DISTORTION_NONE", "distortion.modified_brown_conrady"}) {
    expect_pinhole(text(model, zeros));
  }
  expect_brown(text("distortion.brown_conrady", kD));
  expect_brown("{\"color\": " + text("Brown Conrady", kD) + "}");
  for (const char* model : {"distortion.inverse_brown_conrady", "Modified Brown Conrady"}) {
    EXPECT_THAT(refusal_of(text(model, kD)), HasSubstr("only with coefficients of 0"));
  }
  EXPECT_THAT(refusal_of(text("distortion.ftheta", kD)), HasSubstr("is unknown"));
  EXPECT_THAT(refusal_of("{\"color\": " + text("none", zeros) +
                         ", \"depth\": " + text("none", zeros) + "}"),
              HasSubstr("describes several cameras (color, depth)"));
}

TEST(CameraFormats, MetashapeIsReadFromItsCalibrationWithoutSkew) {
  const auto text = [](const std::string& more) {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<calibration>\n"
           "  <projection>frame</projection>\n  <width>640</width>\n  <height>480</height>\n"
           "  <f>530.25</f>\n  <cx>-0.75</cx>\n  <cy>3</cy>\n  <b1>-1.75</b1>\n" +
           more + "  <date>2024-01-01T00:00:00Z</date>\n</calibration>\n";
  };
  // p1 and p2 have each other's place.
  const std::string lens = "<k1>-0.125</k1><k2>0.0625</k2><p1>-0.00025</p1><p2>0.0005</p2>\n";
  expect_brown(text(lens));
  expect_pinhole(text(""));
  EXPECT_THAT(refusal_of(text(lens + "<b2>0.5</b2>\n")),
              AllOf(HasSubstr(":11:1:"), HasSubstr("skew")));
  EXPECT_THAT(refusal_of(text(lens + "<k4>0.5</k4>\n")), HasSubstr("'k4' means what"));
}

TEST(CameraFormats, OtherProgramsAreReadToo) {
  expect_brown(
      "%YAML:1.0\n---\nmodel_type: PINHOLE\ncamera_name: camera\nimage_width: 640\n"
      "image_height: 480\ndistortion_parameters:\n   k1: -0.125\n   k2: 0.0625\n   p1: 0.0005\n"
      "   p2: -0.00025\nprojection_parameters:\n   fx: 528.5\n   fy: 530.25\n   cx: 318.75\n"
      "   cy: 242.5\n");
  expect_brown(
      "{\"fl_x\": 528.5, \"fl_y\": 530.25, \"cx\": 319.25, \"cy\": 243, \"w\": 640, "
      "\"h\": 480, \"k1\": -0.125, \"k2\": 0.0625, \"p1\": 0.0005, \"p2\": -0.00025, "
      "\"camera_model\": \"OPENCV\", \"frames\": [{\"file_path\": \"a.png\"}]}");
  expect_brown(kOurs + "k1: -0.125\nk2: 0.0625\np1: 0.0005\np2: -0.00025\n");
  expect_pinhole(
      "{\"intrinsics\": {\"fx\": 528.5, \"fy\": 530.25, \"cx\": 318.75, \"cy\": 242.5},"
      " \"width\": 640, \"height\": 480}");
}

TEST(CameraFormats, NumbersMayHaveASignAndALonePoint) {
  const auto file = read_text(
      "fx: +528.\nfy: 5.3025e2\ncx: +.5\ncy: 1.E1\nwidth: +640\nheight: 480\n"
      "distortion: [-0.0171603, +0.0120395, -.002512, 1e-3, +0]\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->camera.fx, 528.0);
  EXPECT_EQ(file->camera.cx, 0.5);
  EXPECT_THAT(file->coefficients, ElementsAre(-0.0171603, 0.0120395, -0.002512, 0.001, 0.0));
  EXPECT_THAT(refusal_of("fx: +-5\n" + kOurs.substr(10)), HasSubstr("finite number, not '+-5'"));
}

TEST(CameraFormats, WhatIsNotReadIsNamedWithTheKeysToWrite) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"PK\x03\x04npz", "a NumPy (.npz) or zip archive"},
      {"\x93NUMPY", "a NumPy array"},
      {"\x80\x04pickle", "a Python pickle"},
      {"[image]\n\nwidth\n640\n", "give ost.yaml"},
      {"[LEFT_CAM_HD]\nfx=528.5\n", "an INI file"},
      {"%time,field.header.seq\n1,2\n", "rostopic echo -p"},
      {"{\"IntrinsicMatrix\": [[1, 2, 3]]}", "a MATLAB calibration"},
      {"{\"v2 unknown 640\": {\"projection_type\": \"brown\", \"width\": 640}}", "an OpenSfM"},
      {"{\"value0\": {\"intrinsics\": [{\"camera_type\": \"ds\"}]}}", "a Basalt calibration"},
      {"P0: 7.2e2 0 6.1e2 0\nP1: 7.2e2 0 6.1e2 0\n", "a KITTI calibration"},
      {"<?xml version=\"1.0\"?>\n<rig><camera/></rig>\n", "root element 'rig'"},
      {"lens: 50 mm\nsensor: full\n", "it has 'lens', 'sensor'"}};
  for (const auto& [content, title] : cases) {
    EXPECT_THAT(refusal_of(content), AllOf(HasSubstr(title), HasSubstr("fx, fy, cx, cy (px"),
                                           Not(HasSubstr("'comment'"))))
        << content;
  }
}

TEST(CameraFormats, SlipsOfSyntaxHaveTheirPlaceAndTheirName) {
  const std::string opencv =
      "%YAML:1.0\n---\nimage_width:640\nimage_height:480\ncamera_matrix: !!opencv-matrix\n"
      "   rows: 3\n   cols: 3\n   dt: d\n   data: " +
      kK + "\n";
  EXPECT_THAT(
      refusal_of(opencv),
      HasSubstr("camera.txt:3:13: a blank is missing after the colon: write 'image_width: "));
  EXPECT_THAT(refusal_of("fx:528.5\nfy:530\ncx:318\ncy:242\nwidth:640\nheight:480\n"),
              HasSubstr(":1:4: a blank is missing"));
  EXPECT_THAT(refusal_of(kOurs.substr(0, kOurs.rfind("height")) + "height:480\n"),
              HasSubstr(":6:8: a blank is missing"));
  EXPECT_THAT(refusal_of("{fx: 528.5, fy:530.25, cx: 1, cy: 1, width: 640, height: 480}"),
              HasSubstr(":1:13: a blank is missing after the colon of 'fy:'"));
  EXPECT_THAT(refusal_of("cam0:\n\tintrinsics: [1, 2, 3, 4]\n"), HasSubstr(":2:1: a tab indents"));
  EXPECT_THAT(refusal_of(std::string("\xFF\xFE"
                                     "f\0x\0",
                                     6)),
              HasSubstr(":1:1: UTF-16"));
  EXPECT_THAT(refusal_of(std::string("f\0x\0:\0", 6)), HasSubstr(":1:1: UTF-16"));
  EXPECT_THAT(refusal_of("<a><b></a>"), HasSubstr("cannot be understood as XML"));
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  EXPECT_THAT(refusal_of(deep), HasSubstr("too many elements inside another"));
  std::string windows = "\xEF\xBB\xBF" + kOurs;
  for (std::size_t at = 0; (at = windows.find('\n', at)) != windows.npos; at += 2) {
    windows.replace(at, 1, "\r\n");
  }
  expect_pinhole(windows);
}

TEST(CameraFormats, ValuesThatRepeatThemselvesEndTheReading) {
  std::string bomb = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (char name = 'b'; name < 'k'; ++name) {
    const std::string before = std::string("*") + static_cast<char>(name - 1);
    bomb += std::string(1, name) + ": &" + name + " {";
    for (int i = 0; i < 10; ++i) bomb += "k" + std::to_string(i) + ": " + before + ", ";
    bomb += "}\n";
  }
  EXPECT_FALSE(read_text(bomb));
}

}  // namespace
}  // namespace weft::cameras
