// SPDX-License-Identifier: Apache-2.0
#include "calibration/frame_reader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <utility>
#include <weft/core/image_file.hpp>

namespace weft::calibration {
namespace {

constexpr int kFilmFrames = 300;

bool is_file(const std::string& path) {
  std::error_code status;
  return std::filesystem::is_regular_file(path, status);
}

class ImageFiles final : public FrameReader {
 public:
  explicit ImageFiles(std::vector<std::string> paths) : paths_(std::move(paths)) {}

  Result<std::optional<Frame>> next() override {
    if (next_ == paths_.size()) return std::optional<Frame>();
    const std::string& path = paths_[next_++];
    const auto file = read_image_bytes(path);
    if (!file) return file.error();
    Frame frame{path, {}};
    const cv::Mat bytes(1, static_cast<int>(file->bytes.size()), CV_8U,
                        const_cast<char*>(file->bytes.data()));
    try {
      frame.grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    } catch (const cv::Exception&) {  // said below: the file is at fault
    }
    if (frame.grey.empty()) return no_image(path);
    return std::optional(std::move(frame));
  }

 private:
  std::vector<std::string> paths_;
  std::size_t next_ = 0;
};

class Capture final : public FrameReader {
 public:
  Capture(std::string name, const cv::VideoCapture& capture, int step)
      : name_(std::move(name)), capture_(capture), step_(step) {}

  Result<std::optional<Frame>> next() override {
    const int last = number_;
    do {
      if (!capture_.grab()) return std::optional<Frame>();
      ++number_;
    } while (last >= 0 && number_ < last + step_);
    cv::Mat image;
    try {
      capture_.retrieve(image);
    } catch (const cv::Exception&) {
      image.release();
    }
    const std::string name = name_ + " frame " + std::to_string(number_);
    if (image.empty() || image.type() != CV_8UC3) {
      return Error{Errc::invalid_data, name + " cannot be decoded", {}};
    }
    Frame frame{name, {}};
    cv::cvtColor(image, frame.grey, cv::COLOR_BGR2GRAY);
    return std::optional(std::move(frame));
  }

 private:
  std::string name_;
  cv::VideoCapture capture_;
  int step_;
  int number_ = -1;  ///< of the last frame that was read
};

}  // namespace

std::unique_ptr<FrameReader> read_images(std::vector<std::string> paths) {
  return std::make_unique<ImageFiles>(std::move(paths));
}

Result<std::unique_ptr<FrameReader>> open_film(const std::string& path, int frames) {
  if (!is_file(path)) {
    return Error{Errc::not_found, path + ": there is no such file; correct its name", {}};
  }
  cv::VideoCapture capture;
  // FFmpeg opens some files of which it can read no frame.
  const auto open = [&] { return capture.open(path, cv::CAP_FFMPEG); };
  if (!open() || !capture.grab() || !open()) {
    return Error{Errc::invalid_data,
                 path +
                     ": is neither an image nor a video that can be read: check it with another "
                     "program, or convert it",
                 {}};
  }
  capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);  // as sources read it
  const double count = capture.get(cv::CAP_PROP_FRAME_COUNT);
  const int step =
      std::isfinite(count) ? static_cast<int>(std::clamp(count / frames, 1.0, 1e6)) : 1;
  return std::unique_ptr<FrameReader>(std::make_unique<Capture>(path, capture, step));
}

Result<std::unique_ptr<FrameReader>> open_camera(int number) {
  const std::string name = "/dev/video" + std::to_string(number);
  std::error_code status;
  if (!std::filesystem::exists(name, status)) {
    return Error{
        Errc::not_found, name + ": there is no such camera: connect it, or correct --camera", {}};
  }
  cv::VideoCapture capture;
  if (!capture.open(number, cv::CAP_V4L2)) {
    return Error{Errc::io,
                 name +
                     ": cannot be opened as a camera: end other programs that use it, and check "
                     "that you may read it (group video)",
                 {}};
  }
  return std::unique_ptr<FrameReader>(std::make_unique<Capture>(name, capture, 1));
}

Result<std::unique_ptr<FrameReader>> open_files(const std::vector<std::string>& paths) {
  if (paths.size() == 1) {
    const std::string& path = paths.front();
    // It reads the first bytes alone, and complains itself where there is no file.
    if (!is_file(path) || !cv::haveImageReader(path)) return open_film(path, kFilmFrames);
  }
  return read_images(paths);
}

}  // namespace weft::calibration
