// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/camera_formats.hpp"

#include <algorithm>
#include <iterator>

namespace weft::cameras {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

Format orb_slam(const std::string& camera) {
  return {.title = "an ORB-SLAM calibration",
          .signature = camera + ".fx",
          .pinhole = {camera + ".fx", camera + ".fy", camera + ".cx", camera + ".cy"},
          .size = {"Camera.width", "Camera.height"},
          .model = "Camera.type",
          .coefficients = {},
          .each = camera + "."};
}

Format stereo(const std::string& matrices, const std::string& coefficients) {
  return {.title = "a stereo calibration of OpenCV",
          .signature = matrices,
          .pinhole = {matrices, "", "", ""},
          .size = {"image_width|imageWidth|width|imageSize|image_size|size",
                   "image_height|imageHeight|height"},
          .model = "distortion_model",
          .coefficients = coefficients,
          .each = {}};
}

/// Keys that identify files of a program whose format cannot be read: one of them is present.
struct Unread {
  std::string_view keys, title;
};
constexpr Unread kUnread[] = {
    {"projection_parameters|mirror_parameters",
     "a camodocal (VINS) calibration of a model that "
     "is not read"},
    {"IntrinsicMatrix|FocalLength|cameraParams/IntrinsicMatrix", "a MATLAB calibration"},
    {"camera_angle_x", "a transforms.json without focal lengths in px"},
    {"value0", "a Basalt calibration"},
    {"sfm_data_version|sfmData", "an OpenMVG or AliceVision scene"},
    {"P0|P2|P_rect_00|P_rect_02|P_rect_00/data", "a KITTI calibration"},
    {"document|chunk",
     "a Metashape project: export the calibration alone (Tools > Camera "
     "Calibration > Save), or"},
    {"fx/value|intrinsic/fx/value", "a calibration with separate keys for its numbers"}};

/// How texts begin that are neither YAML nor XML.
constexpr Unread kUnreadTexts[] = {
    {"PK\x03\x04", "a NumPy (.npz) or zip archive"},
    {"\x93NUMPY", "a NumPy array (.npy)"},
    {"\x80\x03|\x80\x04|\x80\x05", "a Python pickle"},
    {"MATLAB 5.0", "a MATLAB file (.mat)"},
    {"\x89HDF", "an HDF5 or MATLAB file"},
    {"\x89PNG|\xFF\xD8\xFF|GIF8", "an image"},
    {"%PDF", "a PDF"},
    {"%time,", "what `rostopic echo -p` prints: echo without -p, or"}};

}  // namespace

const std::vector<Format>& known_formats() {
  static const std::vector<Format> kFormats{
      {.title = "a Kalibr or EuRoC calibration",
       .signature = "intrinsics",
       .pinhole = {"intrinsics", "", "", ""},
       .size = {"resolution", ""},
       .model = "distortion_model",
       .coefficients = "distortion_coeffs|distortion_coefficients",
       .each = {}},
      {.title = "RealSense intrinsics",
       .signature = "ppx",
       .pinhole = {"fx", "fy", "ppx", "ppy"},
       .size = {"width", "height"},
       .model = "model|distortion_model",
       .coefficients = "coeffs|coefficients|distortion_coeffs",
       .each = {}},
      orb_slam("Camera"),
      orb_slam("Camera1"),
      {.title = "a camodocal (VINS) calibration",
       .signature = "projection_parameters/fx",
       .pinhole = {"projection_parameters/fx", "projection_parameters/fy",
                   "projection_parameters/cx", "projection_parameters/cy"},
       .size = {"image_width", "image_height"},
       .model = "model_type",
       .coefficients = {},
       .each = "distortion_parameters/"},
      {.title = "a nerfstudio transforms.json",
       .signature = "fl_x",
       .pinhole = {"fl_x", "fl_y", "cx", "cy"},
       .size = {"w", "h"},
       .model = "camera_model",
       .coefficients = {},
       .each = "",
       .first_centre = 0.5},
      {.title = "a Metashape calibration",
       .signature = "f",
       .pinhole = {"f", "f", "cx", "cy"},
       .size = {"width", "height"},
       .model = "projection",
       .coefficients = {},
       .each = "",
       .first_centre = 0.5,
       .metashape = true},
      {.title = "an OpenCV or ROS calibration",
       .signature = "camera_matrix|Camera_Matrix|cameraMatrix|CameraMatrix|K|k|mtx|cam_matrix|"
                    "intrinsic_matrix|intrinsicMatrix|camera_intrinsic",
       .pinhole = {"camera_matrix|Camera_Matrix|cameraMatrix|CameraMatrix|K|k|mtx|cam_matrix|"
                   "intrinsic_matrix|intrinsicMatrix|camera_intrinsic",
                   "", "", ""},
       .size = {"image_width|image_Width|imageWidth|width|imageSize|image_size|img_size|size|"
                "resolution|w",
                "image_height|image_Height|imageHeight|height|h"},
       .model = "distortion_model",
       .coefficients =
           "distortion_coefficients|Distortion_Coefficients|distCoeffs|DistCoeffs|dist_coeffs|"
           "dist_coeff|dist_coefs|distortion_coeffs|distortionCoefficients|distortion|dist|D|d",
       .each = {}},
      stereo("M1|K1|cameraMatrix1|camera_matrix_1|cameraMatrixL|left_camera_matrix",
             "D1|distCoeffs1|dist_coeffs_1|distCoeffsL|left_distortion_coefficients"),
      stereo("M2|K2|cameraMatrix2|camera_matrix_2|cameraMatrixR|right_camera_matrix",
             "D2|distCoeffs2|dist_coeffs_2|distCoeffsR|right_distortion_coefficients")};
  return kFormats;
}

const Format& own_format() {
  static const Format kOurs{.title = "a camera file of Weft",
                            .signature = "fx",
                            .pinhole = {"fx", "fy", "cx", "cy"},
                            .size = {"width", "height"},
                            .model = {},
                            .coefficients = "distortion",
                            .each = ""};
  return kOurs;
}

std::optional<std::string> unread_format(const CameraValues& values) {
  for (const Unread& unread : kUnread) {
    if (values.find("", unread.keys) != nullptr) return std::string(unread.title);
  }
  if (values.is_xml() && values.xml_root() == "document") return std::string(kUnread[6].title);
  for (const Value& value : values.all()) {
    if (value.path.ends_with("/projection_type")) return "an OpenSfM calibration";
  }
  if (values.is_xml()) return "an XML file with the root element '" + values.xml_root() + "'";
  return std::nullopt;
}

std::optional<std::string> unread_text(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  for (const Unread& unread : kUnreadTexts) {
    std::string_view starts = unread.keys;
    while (!starts.empty()) {
      const std::size_t end = std::min(starts.find('|'), starts.size());
      if (text.starts_with(starts.substr(0, end))) return std::string(unread.title);
      starts.remove_prefix(std::min(end + 1, starts.size()));
    }
  }
  // Sections of INI files: [image] of ROS's ost.txt, [LEFT_CAM_HD] of ZED.
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    if (line.empty() || line.front() == '#' || line.front() == ';') continue;
    const bool section = line.size() > 2 && line.front() == '[' && line.back() == ']' &&
                         line.find_first_of(",0123456789\"'") != 1 && line.find(',') == line.npos;
    if (!section) return std::nullopt;
    return line == "[image]" ? "an oST file of ROS: give ost.yaml, which ROS writes beside it, or"
                             : "an INI file, such as ZED's: ";
  }
  return std::nullopt;
}

std::string keys_to_write() {
  return "write its numbers into a camera file: fx, fy, cx, cy (px, the centre of the first pixel "
         "is 0), width, height and distortion: {model: brown or fisheye, coefficients: [...]}";
}

std::optional<Lens> lens_named(std::string name) {
  static constexpr Lens kLenses[] = {{"none", Distortion::none},
                                     {"rectified", Distortion::none},
                                     {"simple_pinhole", Distortion::none},
                                     {"brown", Distortion::brown},
                                     {"plumb_bob", Distortion::brown},
                                     {"rational_polynomial", Distortion::brown},
                                     {"radtan", Distortion::brown},
                                     {"radial_tangential", Distortion::brown},
                                     {"brown_conrady", Distortion::brown},
                                     {"pinhole", Distortion::brown},
                                     {"perspective", Distortion::brown},
                                     {"frame", Distortion::brown},
                                     {"opencv", Distortion::brown},
                                     {"full_opencv", Distortion::brown},
                                     {"simple_radial", Distortion::brown},
                                     {"radial", Distortion::brown},
                                     {"fisheye", Distortion::fisheye},
                                     {"equidistant", Distortion::fisheye},
                                     {"equi", Distortion::fisheye},
                                     {"opencv_fisheye", Distortion::fisheye},
                                     {"kannalabrandt8", Distortion::fisheye},
                                     {"kannala_brandt4", Distortion::fisheye},
                                     {"kannala_brandt", Distortion::fisheye},
                                     {"inverse_brown_conrady", Distortion::brown, true},
                                     {"modified_brown_conrady", Distortion::brown, true}};
  if (const std::size_t dot = name.rfind('.'); dot != name.npos) name.erase(0, dot + 1);
  for (char& c : name) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == ' ' || c == '-') c = '_';
  }
  constexpr std::string_view kRealSense = "rs2_distortion_";
  if (name.starts_with(kRealSense)) name.erase(0, kRealSense.size());
  const auto* found = std::find_if(std::begin(kLenses), std::end(kLenses),
                                   [&](const Lens& lens) { return lens.name == name; });
  return found == std::end(kLenses) ? std::nullopt : std::optional(*found);
}

}  // namespace weft::cameras
