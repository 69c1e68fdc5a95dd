// SPDX-License-Identifier: Apache-2.0
// cameras.txt of COLMAP: a camera a line, "ID MODEL WIDTH HEIGHT PARAMETERS...".
#include <algorithm>
#include <iterator>
#include <sstream>
#include <utility>

#include "common/cameras/camera_builder.hpp"
#include "common/cameras/camera_formats.hpp"
#include "common/cameras/camera_reader.hpp"
#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {
namespace {

using yaml_files::FileMistake;

/// Its parameters are one or two focal lengths, the principal point and coefficients in the order
/// of `lens`. The last coefficients may be missing.
struct ColmapModel {
  std::string_view name;
  std::size_t focal_lengths, coefficients;
  Distortion lens;
};

const ColmapModel* model_named(std::string_view name) {
  static constexpr ColmapModel kModels[] = {{"SIMPLE_PINHOLE", 1, 0, Distortion::none},
                                            {"PINHOLE", 2, 0, Distortion::none},
                                            {"SIMPLE_RADIAL", 1, 1, Distortion::brown},
                                            {"RADIAL", 1, 2, Distortion::brown},
                                            {"OPENCV", 2, 4, Distortion::brown},
                                            {"FULL_OPENCV", 2, 8, Distortion::brown},
                                            {"OPENCV_FISHEYE", 2, 4, Distortion::fisheye},
                                            {"SIMPLE_RADIAL_FISHEYE", 1, 1, Distortion::fisheye},
                                            {"RADIAL_FISHEYE", 1, 2, Distortion::fisheye}};
  const auto* found = std::find_if(std::begin(kModels), std::end(kModels),
                                   [&](const ColmapModel& model) { return model.name == name; });
  return found == std::end(kModels) ? nullptr : found;
}

}  // namespace

CameraValues CameraValues::of_colmap(const std::string& text) {
  CameraValues values;
  std::istringstream lines(text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text);
  int number = 0;
  for (std::string line; std::getline(lines, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == line.npos || line[first] == '#') continue;
    std::vector<Word> words;
    for (std::size_t at = first; at < line.size();) {
      const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
      YAML::Mark place;
      place.line = number, place.column = static_cast<int>(at);
      words.push_back({line.substr(at, end - at), place});
      at = std::min(line.find_first_not_of(" \t\r", end), line.size());
    }
    const auto is_digits = [](const std::string& word) {
      return word.find_first_not_of("0123456789") == word.npos;
    };
    const bool is_camera =
        words.size() >= 4 && is_digits(words[0].text) &&
        words[1].text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") == line.npos &&
        !is_digits(words[1].text);
    if (!is_camera) return {};
    values.place_ = words[0].place;
    const char* names[] = {"model", "width", "height"};
    for (std::size_t i = 0; i < 3; ++i) {
      const Word& word = words[i + 1];
      values.values_.push_back({names[i], Value::Kind::scalar, word.place, word.place, {word}});
    }
    values.values_.push_back({"params", Value::Kind::list, words[3].place, words[3].place,
                              std::vector<Word>(words.begin() + 4, words.end())});
    return values;
  }
  return {};
}

CameraFile read_colmap(const CameraValues& values) {
  const Word& name = values.find("", "model")->words.front();
  const std::vector<Word>& words = values.find("", "params")->words;
  const ColmapModel* model = model_named(name.text);
  if (model == nullptr) {
    throw FileMistake(name.place, "this is a COLMAP camera with the model '" + name.text +
                                      "', which is not read: export it as OPENCV or "
                                      "OPENCV_FISHEYE, or " +
                                      keys_to_write());
  }
  const std::size_t before = model->focal_lengths + 2;
  if (words.size() != before + model->coefficients) {
    throw FileMistake(name.place, std::string(model->name) + " has " +
                                      std::to_string(before + model->coefficients) +
                                      " parameters, not " + std::to_string(words.size()));
  }
  CameraBuilder result;
  Camera& camera = result.camera;
  const Word& fy = words[model->focal_lengths - 1];
  camera.fx = focal_length_px(words[0], "fx");
  camera.fy = focal_length_px(fy, "fy");
  constexpr double kFirstCentre = 0.5;  // COLMAP's pixels have their corners at integers
  camera.cx = number(words[before - 2], "cx") - kFirstCentre;
  camera.cy = number(words[before - 1], "cy") - kFirstCentre;
  const Word& width = values.find("", "width")->words.front();
  const Word& height = values.find("", "height")->words.front();
  camera.width_px = size_px(width, "width");
  camera.height_px = size_px(height, "height");
  result.places = {{"fx", words[0].place},          {"fy", fy.place},
                   {"cx", words[before - 2].place}, {"cy", words[before - 1].place},
                   {"width", width.place},          {"height", height.place}};
  std::vector<double> coefficients;
  for (std::size_t i = before; i < words.size(); ++i) {
    coefficients.push_back(number(words[i], "params"));
  }
  if (model->lens != Distortion::none) {
    coefficients.resize(std::max<std::size_t>(coefficients.size(), 4));
    result.set_lens(words.back().place, model->lens == Distortion::fisheye ? "fisheye" : "brown",
                    std::move(coefficients));
  }
  return result.finish();
}

}  // namespace weft::cameras
