// SPDX-License-Identifier: Apache-2.0
#include "common/camera_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "common/yaml_file.hpp"

namespace weft::sources {
namespace {

constexpr double kLargestSize = 32767;  // the remapping of OpenCV counts pixels in 16 bits

class Reader {
 public:
  Reader(std::string path, const YAML::Node& root) : path_(std::move(path)), root_(root) {}

  CameraFile read() const {
    if (!root_.IsMap()) {
      fail(root_, "must hold keys: fx, fy, cx, cy, width and height, or OpenCV's camera_matrix");
    }
    check_duplicates();
    CameraFile file = root_["camera_matrix"] ? read_matrices() : read_plain();
    const bool ideal = std::all_of(file.coefficients.begin(), file.coefficients.end(),
                                   [](double k) { return k == 0.0; });
    if (ideal) file.model = Distortion::none;
    return file;
  }

 private:
  [[noreturn]] void fail(const YAML::Node& node, const std::string& message) const {
    fail_at(path_, node, message);
  }

  /// yaml-cpp keeps both values of a key that is given twice and answers with the first.
  void check_duplicates() const {
    std::set<std::string> keys;
    for (const auto& entry : root_) {
      if (entry.first.IsScalar() && !keys.insert(entry.first.Scalar()).second) {
        fail(entry.first, "'" + entry.first.Scalar() + "' is given twice: remove one");
      }
    }
  }

  YAML::Node at(const YAML::Node& map, const std::string& key) const {
    const YAML::Node node = map[key];
    if (node.IsDefined() && !node.IsNull()) return node;
    fail(map, "has no '" + key +
                  "'; a camera file has fx, fy, cx, cy, width and height, or image_width, "
                  "image_height and camera_matrix (OpenCV, ROS)");
  }

  double number(const YAML::Node& node, const std::string& name) const {
    if (!node.IsScalar()) fail(node, "'" + name + "' must be a number");
    const std::string& text = node.Scalar();
    double value = 0.0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
      fail(node, "'" + name + "' must be a finite number, not '" + text + "'");
    }
    return value;
  }

  std::int64_t size(const std::string& key) const {
    const YAML::Node node = at(root_, key);
    const double value = number(node, key);
    if (value != std::floor(value) || value < 1.0 || value > kLargestSize) {
      fail(node,
           "'" + key + "' must be a whole number of pixels from 1 to 32767, not " + node.Scalar());
    }
    return static_cast<std::int64_t>(value);
  }

  double focal_length(const YAML::Node& node, const std::string& name) const {
    const double value = number(node, name);
    if (!(value > 0.0)) {
      fail(node,
           "'" + name + "' must be a focal length in pixels, larger than 0, not " + node.Scalar());
    }
    return value;
  }

  std::vector<double> numbers(const YAML::Node& node, const std::string& name) const {
    if (!node.IsSequence()) fail(node, "'" + name + "' must be a list of numbers");
    std::vector<double> values;
    for (const auto& item : node) values.push_back(number(item, name));
    return values;
  }

  /// The numbers of {rows, cols, data}, which OpenCV and ROS write alike.
  std::vector<double> matrix(const std::string& key) const {
    const YAML::Node node = at(root_, key);
    if (!node.IsMap()) fail(node, "'" + key + "' must have rows, cols and data");
    std::vector<double> values = numbers(at(node, "data"), key + ".data");
    const double rows = number(at(node, "rows"), key + ".rows");
    const double cols = number(at(node, "cols"), key + ".cols");
    if (rows * cols != static_cast<double>(values.size())) {
      fail(node, "'" + key + "' has " + std::to_string(values.size()) +
                     " numbers in data, which is not rows x cols");
    }
    return values;
  }

  CameraFile read_plain() const {
    CameraFile file;
    file.camera.fx = focal_length(at(root_, "fx"), "fx");
    file.camera.fy = focal_length(at(root_, "fy"), "fy");
    file.camera.cx = number(at(root_, "cx"), "cx");
    file.camera.cy = number(at(root_, "cy"), "cy");
    file.camera.width_px = size("width");
    file.camera.height_px = size("height");
    const YAML::Node distortion = root_["distortion"];
    if (!distortion.IsDefined() || distortion.IsNull()) return file;
    if (!distortion.IsMap()) {
      set_distortion(file, distortion, "brown", numbers(distortion, "distortion"));
      return file;
    }
    const YAML::Node model = at(distortion, "model");
    if (!model.IsScalar()) fail(model, "'distortion.model' must be brown or fisheye");
    set_distortion(file, model, model.Scalar(),
                   numbers(at(distortion, "coefficients"), "distortion.coefficients"));
    return file;
  }

  CameraFile read_matrices() const {
    CameraFile file;
    file.camera.width_px = size("image_width");
    file.camera.height_px = size("image_height");
    const std::vector<double> k = matrix("camera_matrix");
    const YAML::Node data = root_["camera_matrix"]["data"];
    if (k.size() != 9) fail(root_["camera_matrix"], "'camera_matrix' must be 3 x 3");
    if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
      fail(data, "'camera_matrix' must be [fx 0 cx; 0 fy cy; 0 0 1]: calibrate without skew");
    }
    file.camera.fx = focal_length(data[0], "camera_matrix.data[0]");
    file.camera.fy = focal_length(data[4], "camera_matrix.data[4]");
    file.camera.cx = k[2];
    file.camera.cy = k[5];
    const YAML::Node coefficients = root_["distortion_coefficients"];
    if (!coefficients.IsDefined() || coefficients.IsNull()) return file;
    set_distortion(file, coefficients, model_name(), matrix("distortion_coefficients"));
    return file;
  }

  /// ROS names the model; OpenCV's calibration program says `fisheye_model: 1` or nothing.
  std::string model_name() const {
    const YAML::Node named = root_["distortion_model"], fisheye = root_["fisheye_model"];
    if (named.IsDefined() && named.IsScalar()) return named.Scalar();
    if (fisheye.IsDefined() && number(fisheye, "fisheye_model") != 0.0) return "fisheye";
    return "brown";
  }

  void set_distortion(CameraFile& file, const YAML::Node& place, const std::string& model,
                      std::vector<double> values) const {
    const bool fisheye = model == "fisheye" || model == "equidistant";
    if (!fisheye && model != "brown" && model != "plumb_bob" && model != "rational_polynomial") {
      fail(place, "the distortion model '" + model +
                      "' is unknown; known are brown (plumb_bob, rational_polynomial) and fisheye "
                      "(equidistant)");
    }
    const std::size_t given = values.size();
    // OpenCV pads the rational model with the zeros of models that it did not fit.
    while (!fisheye && values.size() > 8 && values.back() == 0.0) values.pop_back();
    if (!fisheye && values.size() == 4) values.push_back(0.0);
    const std::size_t n = values.size();
    if (fisheye ? n != 4 && n != 0 : n != 5 && n != 8 && n != 0) {
      fail(place, std::to_string(given) + " distortion coefficients do not fit the model '" +
                      model +
                      "': brown has 5 (k1 k2 p1 p2 k3) or 8 (and k4 k5 k6), fisheye has 4; "
                      "calibrate with one of these");
    }
    file.model = fisheye ? Distortion::fisheye : Distortion::brown;
    file.coefficients = std::move(values);
  }

  std::string path_;
  YAML::Node root_;
};

}  // namespace

Result<CameraFile> read_camera_file(const std::string& path) {
  auto text = read_text_file(path, "camera");
  if (!text) return text.error();
  // OpenCV's first line is no directive of YAML; a comment in its place keeps the line numbers.
  if (text->starts_with("%YAML:")) text->front() = '#';
  return read_yaml(path, *text, [&](const YAML::Node& root) { return Reader(path, root).read(); });
}

}  // namespace weft::sources
