// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/camera_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <weft/core/suggest.hpp>
#include <weft/geometry/camera_check.hpp>

#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {
namespace {

// Of what OpenCV's and ROS's calibration programs write, most is not read.
const std::vector<std::string> kOwnKeys{"fx",         "fy",     "cx",         "cy",
                                        "width",      "height", "distortion", "comment",
                                        "convention", "name",   "calibration"};
const std::vector<std::string> kForeignKeys{"image_width",
                                            "image_height",
                                            "camera_matrix",
                                            "distortion_coefficients",
                                            "distortion_model",
                                            "fisheye_model",
                                            "camera_name",
                                            "rectification_matrix",
                                            "projection_matrix",
                                            "binning_x",
                                            "binning_y",
                                            "roi",
                                            "header",
                                            "calibration_time",
                                            "nframes",
                                            "nr_of_frames",
                                            "board_width",
                                            "board_height",
                                            "square_size",
                                            "marker_size",
                                            "aspectRatio",
                                            "fix_aspect_ratio",
                                            "flags",
                                            "avg_reprojection_error",
                                            "per_view_reprojection_errors",
                                            "extrinsic_parameters",
                                            "image_points",
                                            "grid_points",
                                            "comment"};

constexpr double kLargestSize = 32767;  // the remapping of OpenCV counts pixels in 16 bits

constexpr double kLeastShown = 0.1;
constexpr int kProbes = 16;

/// Where the lens puts a point of the ideal image.
Eigen::Vector2d distorted(const CameraFile& file, const Eigen::Vector2d& p) {
  const std::vector<double>& k = file.coefficients;
  const double r2 = p.squaredNorm(), r = std::sqrt(r2);
  if (file.model == Distortion::fisheye) {
    const double theta = std::atan(r), t2 = theta * theta;
    const double scale = 1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])));
    return r > 0.0 ? Eigen::Vector2d(theta * scale / r * p) : p;
  }
  const double over = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double under = k.size() == 8 ? 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])) : 1.0;
  const double both = 2.0 * p.x() * p.y();
  return over / under * p + Eigen::Vector2d(k[2] * both + k[3] * (r2 + 2.0 * p.x() * p.x()),
                                            k[3] * both + k[2] * (r2 + 2.0 * p.y() * p.y()));
}

/// Share of the ideal image that the camera's image shows, by probes.
double shown_share(const CameraFile& file) {
  if (file.coefficients.empty()) return 1.0;
  const Camera& camera = file.camera;
  int shown = 0;
  for (int i = 0; i < kProbes * kProbes; ++i) {
    const int column = i % kProbes, row = i / kProbes;
    const double x_px = (column + 0.5) / kProbes * static_cast<double>(camera.width_px) - 0.5;
    const double y_px = (row + 0.5) / kProbes * static_cast<double>(camera.height_px) - 0.5;
    const Eigen::Vector2d seen = seen_px(file, {x_px, y_px});
    shown += camera.shows(seen.x(), seen.y());
  }
  return static_cast<double>(shown) / (kProbes * kProbes);
}

class Reader {
 public:
  explicit Reader(const YAML::Node& root) : root_(root) {}

  CameraFile read() const {
    if (!root_.IsMap()) {
      fail(root_, "must hold keys: fx, fy, cx, cy, width and height, or OpenCV's camera_matrix");
    }
    const bool foreign = root_["camera_matrix"].IsDefined();
    check_keys(foreign ? kForeignKeys : kOwnKeys);
    CameraFile file = foreign ? read_matrices() : read_plain();
    check_ranges(file.camera, foreign);
    if (shown_share(file) < kLeastShown) {
      fail(
          root_[foreign ? "distortion_coefficients" : "distortion"],
          "the distortion leaves less than a tenth of the image: are the coefficients in the order "
          "of the model, and of these fx, fy, cx and cy?");
    }
    // A fisheye lens bends rays with coefficients of 0 too.
    const bool ideal = file.coefficients.empty() ||
                       (file.model == Distortion::brown &&
                        std::all_of(file.coefficients.begin(), file.coefficients.end(),
                                    [](double k) { return k == 0.0; }));
    if (ideal) file.model = Distortion::none;
    return file;
  }

 private:
  [[noreturn]] void fail(const YAML::Node& node, const std::string& message) const {
    yaml_files::fail_at(node, message);
  }

  /// yaml-cpp keeps both values of a key that is given twice and answers with the first.
  void check_keys(const std::vector<std::string>& known) const {
    std::set<std::string> keys;
    for (const auto& entry : root_) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (!keys.insert(key).second) fail(entry.first, "'" + key + "' is given twice: remove one");
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      fail(entry.first, "a camera file has no key '" + key + "'" +
                            did_you_mean(key, known, "; notes belong under 'comment'"));
    }
  }

  void check_ranges(const Camera& camera, bool foreign) const {
    const auto mistake = camera_mistake(camera);
    if (!mistake) return;
    if (!foreign) fail(root_[mistake->field], mistake->message);
    static const std::map<std::string, int> kPlaces{{"fx", 0}, {"cx", 2}, {"fy", 4}, {"cy", 5}};
    const auto place = kPlaces.find(mistake->field);
    const YAML::Node data = root_["camera_matrix"]["data"];
    fail(place == kPlaces.end() ? root_["image_" + mistake->field] : data[place->second],
         mistake->message);
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

  YAML::Node root_;
};

}  // namespace

Eigen::Vector2d seen_px(const CameraFile& file, const Eigen::Vector2d& ideal_px) {
  if (file.model == Distortion::none) return ideal_px;
  const Camera& c = file.camera;
  const Eigen::Vector2d seen =
      distorted(file, {(ideal_px.x() - c.cx) / c.fx, (ideal_px.y() - c.cy) / c.fy});
  return {c.fx * seen.x() + c.cx, c.fy * seen.y() + c.cy};
}

Result<CameraFile> read_camera_file(const std::string& path) {
  auto text = yaml_files::read_yaml_text(path, "camera");
  if (!text) return text.error();
  // OpenCV's first line is no directive of YAML; a comment in its place keeps the line numbers.
  if (text->starts_with("%YAML:")) text->front() = '#';
  return yaml_files::read_yaml(path, *text,
                               [&](const YAML::Node& root) { return Reader(root).read(); });
}

}  // namespace weft::cameras
