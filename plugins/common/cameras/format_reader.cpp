// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <initializer_list>
#include <utility>

#include "common/cameras/camera_builder.hpp"
#include "common/cameras/camera_formats.hpp"
#include "common/cameras/camera_reader.hpp"
#include "common/cameras/format_values.hpp"
#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {
namespace {

using yaml_files::FileMistake;

/// "fx" of "fx|focal_x".
std::string first_of(const std::string& paths) { return paths.substr(0, paths.find('|')); }

/// Reads the numbers of one format below one path.
class Reader : FormatValues {
 public:
  explicit Reader(const FormatValues& values) : FormatValues(values) {}

  CameraFile read() {
    check_model();
    read_pinhole();
    Camera& camera = result_.camera;
    camera.width_px = read_size(0, "width");
    camera.height_px = read_size(1, "height");
    if (format_.metashape) {
      camera.cx += 0.5 * static_cast<double>(camera.width_px);
      camera.cy += 0.5 * static_cast<double>(camera.height_px);
    }
    camera.cx -= format_.first_centre;
    camera.cy -= format_.first_centre;
    check_part_of_image();
    read_lens(*this, result_);
    return result_.finish();
  }

 private:
  YAML::Mark place() const {
    const Value* map = values_.find("", std::string_view(prefix_).substr(0, prefix_.rfind('/')));
    return prefix_.empty() || map == nullptr ? values_.place() : map->place;
  }

  const Word& needed(const std::string& paths) const {
    const Value* value = find(paths);
    if (value != nullptr) return word(*value);
    const std::string what =
        &format_ == &own_format() ? "; a camera file has fx, fy, cx, cy, width and height" : "";
    throw FileMistake(place(), "has no '" + prefix_ + first_of(paths) + "'" + what);
  }

  /// The models of Kalibr that are no pinhole have other intrinsics.
  void check_model() const {
    const Value* model = find("camera_model");
    if (format_.signature != "intrinsics" || model == nullptr || model->words.empty()) return;
    const Word& name = model->words.front();
    if (name.text == "pinhole") return;
    throw FileMistake(name.place, "this is " + format_.title + " with the camera model '" +
                                      name.text +
                                      "', which is not read: calibrate with pinhole-radtan or "
                                      "pinhole-equi, or " +
                                      keys_to_write());
  }

  void set(const std::string& name, double& target, const Word& from, bool is_focal) {
    const std::string title = prefix_.empty() ? name : prefix_ + name;
    target = is_focal ? focal_length_px(from, title) : number(from, title);
    result_.places[name] = from.place;
  }

  void read_pinhole() {
    Camera& camera = result_.camera;
    std::array<const Word*, 4> words{};
    if (format_.pinhole[1].empty()) {
      words = words_of_matrix();
    } else {
      for (std::size_t i = 0; i < 4; ++i) words[i] = &needed(format_.pinhole[i]);
    }
    set("fx", camera.fx, *words[0], true);
    set("fy", camera.fy, *words[1], true);
    set("cx", camera.cx, *words[2], false);
    set("cy", camera.cy, *words[3], false);
    if (!format_.metashape) return;
    camera.fx += optional_number("b1");
    for (const char* unknown : {"b2", "skew"}) {
      if (optional_number(unknown) == 0.0) continue;
      throw FileMistake(find(unknown)->place, "'" + std::string(unknown) +
                                                  "' is skew, which Weft's cameras do not have: "
                                                  "calibrate without it");
    }
  }

  /// fx, fy, cx, cy of a list of four, or of [fx 0 cx; 0 fy cy; 0 0 1].
  std::array<const Word*, 4> words_of_matrix() const {
    const Value& given = *find(format_.pinhole[0]);
    const Value& value = *list(format_.pinhole[0]);
    const std::vector<Word>& words = value.words;
    if (format_.signature == "intrinsics" && words.size() == 4) {
      return {&words[0], &words[1], &words[2], &words[3]};
    }
    if (words.size() != 9) {
      throw FileMistake(given.place, "'" + given.path +
                                         "' must be 3 x 3: rows, cols and data, or a list of nine "
                                         "numbers");
    }
    const std::vector<double> k = numbers(value);
    const auto fits = [&](std::initializer_list<std::size_t> zeros) {
      return k[8] == 1.0 &&
             std::all_of(zeros.begin(), zeros.end(), [&](std::size_t i) { return k[i] == 0.0; });
    };
    if (fits({1, 3, 6, 7})) return {&words[0], &words[4], &words[2], &words[5]};
    // Open3D writes the matrix by columns.
    const bool by_columns = given.path.ends_with("intrinsic_matrix") && fits({1, 2, 3, 5});
    if (by_columns) return {&words[0], &words[4], &words[6], &words[7]};
    throw FileMistake(value.place, "'" + given.path +
                                       "' must be [fx 0 cx; 0 fy cy; 0 0 1]: calibrate without "
                                       "skew");
  }

  /// Width (0) or height (1): a single value, or an entry of a list of both.
  std::int64_t read_size(std::size_t side, const std::string& name) {
    const auto is_pair = [](const Value* value) {
      return value != nullptr && value->kind == Value::Kind::list && value->words.size() == 2;
    };
    const Value* value = find(format_.size[side]);
    if (const Value* both = find(format_.size[0]); value == nullptr && is_pair(both)) value = both;
    if (value == nullptr) value = values_.find("", format_.size[side]);
    if (value == nullptr) fail_without_size(side, name);
    const Word& from = is_pair(value) ? value->words[side] : word(*value);
    result_.places[name] = from.place;
    return size_px(from, value->path);
  }

  [[noreturn]] void fail_without_size(std::size_t side, const std::string& name) const {
    const std::string& paths = format_.size[format_.size[1].empty() ? 0 : side];
    const std::string key = prefix_ + first_of(paths);
    const std::string line = values_.is_xml()          ? "<" + key + ">N</" + key + ">"
                             : format_.size[1].empty() ? "'" + key + ": [WIDTH, HEIGHT]'"
                                                       : "'" + key + ": N'";
    throw FileMistake(place(), "has no '" + key + "': add " + line + ", the " +
                                   (format_.size[1].empty() ? "size" : name) +
                                   " of the images in pixels");
  }

  /// A ROS driver that delivers a part of the image, or fewer pixels, states that beside the
  /// camera.
  void check_part_of_image() const {
    const auto other = [&](const std::string& path, std::initializer_list<double> whole) {
      const Value* value = find(path);
      if (value == nullptr || value->kind != Value::Kind::scalar) return;
      const double given = number(value->words.front(), value->path);
      if (std::find(whole.begin(), whole.end(), given) != whole.end()) return;
      throw FileMistake(value->place, "'" + value->path +
                                          "': images of a part of the sensor, or with joined "
                                          "pixels, are not read: let the driver give whole images");
    };
    const Camera& camera = result_.camera;
    if (format_.model != "distortion_model") return;
    for (const char* path : {"binning_x", "binning_y"}) other(path, {0.0, 1.0});
    other("roi/width", {0.0, static_cast<double>(camera.width_px)});
    other("roi/height", {0.0, static_cast<double>(camera.height_px)});
  }

  CameraBuilder result_;
};

}  // namespace

CameraFile read_format(const CameraValues& values, const Format& format,
                       const std::string& prefix) {
  return Reader(FormatValues(values, format, prefix)).read();
}

}  // namespace weft::cameras
