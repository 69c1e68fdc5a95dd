// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/cameras/camera_file.hpp"
#include "common/cameras/camera_values.hpp"

namespace weft::cameras {

/// The number that a word spells, with or without a plus sign. These throw FileMistake at its
/// place.
double number(const Word& word, const std::string& name);
std::int64_t size_px(const Word& word, const std::string& name);
double focal_length_px(const Word& word, const std::string& name);

/// A camera that is put together from the numbers of a file.
class CameraBuilder {
 public:
  Camera camera;
  std::map<std::string, YAML::Mark> places;  ///< the places of fx, fy, cx, cy, width and height

  /// The lens by the name that a program gives to its model, and coefficients in the order of that
  /// model. Throws FileMistake at `place`.
  void set_lens(YAML::Mark place, const std::string& name, std::vector<double> values);

  /// The camera. Throws FileMistake at the number that no camera has.
  CameraFile finish() const;

 private:
  Distortion model_ = Distortion::none;
  std::vector<double> coefficients_;
  YAML::Mark lens_place_;
};

}  // namespace weft::cameras
