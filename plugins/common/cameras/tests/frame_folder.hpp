// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>

namespace weft::testing {

/// An empty folder that disappears with the object, and what the tests put into it.
class FrameFolder {
 public:
  FrameFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~FrameFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  FrameFolder(const FrameFolder&) = delete;
  FrameFolder& operator=(const FrameFolder&) = delete;

  std::string path(const std::string& name) const { return (path_ / name).string(); }

  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << content;
  }

  void write_image(const std::string& name, const cv::Mat& image) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    if (!cv::imwrite(path(name), image)) throw std::runtime_error("cannot write " + name);
  }

  /// A colour image of 8 x 6 px whose first blue value distinguishes it from others.
  void write_frame(const std::string& name, int blue = 10) const {
    write_image(name, cv::Mat(6, 8, CV_8UC3, cv::Scalar(blue, 20, 30)));
  }

  /// The camera of write_frame().
  void write_camera() const {
    write("camera.yaml", "fx: 10\nfy: 11\ncx: 3.5\ncy: 2.5\nwidth: 8\nheight: 6\n");
  }

 private:
  std::filesystem::path path_;
};

constexpr int kOpen = 0, kCount = 1, kRead = 2;

}  // namespace weft::testing
