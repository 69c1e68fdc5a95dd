// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/data/template.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "common/cameras/tests/frame_folder.hpp"
#include "tools/photographed.hpp"

namespace weft::photo {

/// The invented map of the other tests, 842 x 595 px.
inline cv::Mat sheet_print() {
  cv::Mat print = cv::imread(WEFT_SHEET_TEXTURE, cv::IMREAD_COLOR);
  if (print.empty()) throw std::runtime_error("no texture");
  return print;
}

/// The map on a surface of its shape on a table, by a camera of `width` px.
inline Still still_of(int width, bool with_lens) {
  Still still;
  still.print = sheet_print();
  still.height_m = still.width_m * still.print.rows / still.print.cols;
  still.camera = make_camera(width, 3 * width / 4, with_lens);
  return still;
}

/// Photographs with their cameras as files, and the templates made of them.
class PhotoFolder {
 public:
  std::string path(const std::string& name) const { return folder_.path(name); }
  const testing::FrameFolder& files() const { return folder_; }

  /// Writes photo.png and camera.yaml.
  void take(const Still& still) const {
    folder_.write_image("photo.png", photographed(still));
    write_camera(still.camera);
  }

  void write_camera(const cameras::CameraFile& file) const {
    const Camera& c = file.camera;
    std::string lens = "null";
    if (!file.coefficients.empty()) {
      lens.clear();
      for (const double k : file.coefficients) {
        lens += (lens.empty() ? "[" : ", ") + std::to_string(k);
      }
      lens += "]";
    }
    const auto line = [](const char* key, const std::string& value) {
      return std::string(key) + ": " + value + "\n";
    };
    folder_.write("camera.yaml",
                  line("fx", std::to_string(c.fx)) + line("fy", std::to_string(c.fy)) +
                      line("cx", std::to_string(c.cx)) + line("cy", std::to_string(c.cy)) +
                      line("width", std::to_string(c.width_px)) +
                      line("height", std::to_string(c.height_px)) + line("distortion", lens));
  }

  /// Builds from photo.png; `more` are further parameters.
  testing::PluginAnswer build(const std::string& more) {
    plugins_.push_back(std::make_unique<testing::PluginUnderTest>(
        "templates/photo", "{photo: '" + path("photo.png") + "'" + more + "}"));
    return plugins_.back()->process(0, {});
  }

  std::string with_camera() const { return ", camera: '" + path("camera.yaml") + "'"; }

 private:
  testing::FrameFolder folder_;
  std::vector<std::unique_ptr<testing::PluginUnderTest>> plugins_;  // the templates live in them
};

}  // namespace weft::photo
