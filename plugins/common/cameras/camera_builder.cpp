// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/camera_builder.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>
#include <weft/geometry/camera_check.hpp>

#include "common/cameras/camera_formats.hpp"
#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {
namespace {

using yaml_files::FileMistake;

constexpr double kLargestSize = 32767;  // the remapping of OpenCV counts pixels in 16 bits
constexpr double kLeastShown = 0.1;

}  // namespace

double number(const Word& word, const std::string& name) {
  if (!word.is_scalar) throw FileMistake(word.place, "'" + name + "' must be a number");
  std::string_view text = word.text;
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code == std::errc{} && end == text.data() + text.size() && std::isfinite(value)) {
    return value;
  }
  throw FileMistake(word.place, "'" + name + "' must be a finite number, not '" + word.text + "'");
}

std::int64_t size_px(const Word& word, const std::string& name) {
  const double value = number(word, name);
  if (value == std::floor(value) && value >= 1.0 && value <= kLargestSize) {
    return static_cast<std::int64_t>(value);
  }
  throw FileMistake(
      word.place,
      "'" + name + "' must be a whole number of pixels from 1 to 32767, not " + word.text);
}

double focal_length_px(const Word& word, const std::string& name) {
  const double value = number(word, name);
  if (value > 0.0) return value;
  throw FileMistake(
      word.place,
      "'" + name + "' must be a focal length in pixels, larger than 0, not " + word.text);
}

void CameraBuilder::set_lens(YAML::Mark place, const std::string& name,
                             std::vector<double> values) {
  lens_place_ = place;
  const bool zeros =
      std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
  if (name.empty() && zeros) return;
  const auto lens = lens_named(name);
  if (!lens) {
    throw FileMistake(place, "the distortion model '" + name +
                                 "' is unknown; known are brown (plumb_bob, radtan, "
                                 "rational_polynomial) and fisheye (equidistant, equi): "
                                 "calibrate with one of these");
  }
  if (lens->only_zeros && !zeros) {
    throw FileMistake(place, "the distortion model '" + name +
                                 "' is read only with coefficients of 0: calibrate the camera "
                                 "with one of brown or fisheye");
  }
  if (lens->model == Distortion::none && zeros) return;
  const bool fisheye = lens->model == Distortion::fisheye;
  const std::size_t given = values.size();
  // OpenCV pads the rational model with the zeros of models that it did not fit.
  while (!fisheye && values.size() > 8 && values.back() == 0.0) values.pop_back();
  if (!fisheye && values.size() == 4) values.push_back(0.0);
  const std::size_t n = values.size();
  if (lens->model == Distortion::none || (fisheye ? n != 4 : n != 5 && n != 8 && n != 0)) {
    throw FileMistake(place, std::to_string(given) +
                                 " distortion coefficients do not fit the model '" + name +
                                 "': brown has 5 (k1 k2 p1 p2 k3) or 8 (and k4 k5 k6), fisheye "
                                 "has 4; calibrate with one of these");
  }
  model_ = lens->model;
  coefficients_ = std::move(values);
}

CameraFile CameraBuilder::finish() const {
  if (const auto wrong = camera_mistake(camera)) {
    const auto place = places.find(wrong->field);
    throw FileMistake(place == places.end() ? YAML::Mark() : place->second, wrong->message);
  }
  CameraFile file{camera, model_, coefficients_};
  if (shown_share(file) < kLeastShown) {
    throw FileMistake(
        lens_place_,
        "the distortion leaves less than a tenth of the image: are the coefficients in the order "
        "of the model, and of these fx, fy, cx and cy?");
  }
  // A fisheye lens bends rays with coefficients of 0 too.
  const bool ideal =
      model_ != Distortion::fisheye &&
      std::all_of(coefficients_.begin(), coefficients_.end(), [](double k) { return k == 0.0; });
  if (ideal) file.model = Distortion::none;
  return file;
}

}  // namespace weft::cameras
