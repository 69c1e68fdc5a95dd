// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/frame_reader.hpp"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <utility>

#include "common/films/film.hpp"
#include "common/images/decoder.hpp"

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
    const auto decoded = image_files::decode_stored(*file, image_files::Channels::grey);
    const auto grey = image_files::whole_pixels(decoded, path);
    if (!grey) return grey.error();
    return std::optional(Frame{path, *grey, file->header.orientation});
  }

 private:
  std::vector<std::string> paths_;
  std::size_t next_ = 0;
};

cv::Mat grey_of(const cv::Mat& bgr) {
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

std::string numbered(const std::string& name, std::int64_t number) {
  return name + " frame " + std::to_string(number);
}

/// Every `step`-th frame; those that are damaged are passed over.
class FilmFrames final : public FrameReader {
 public:
  FilmFrames(std::string name, films::Film film, std::int64_t step)
      : name_(std::move(name)), film_(std::move(film)), step_(step) {}

  Result<std::optional<Frame>> next() override {
    for (;;) {
      const films::Film::Step taken = film_.advance();
      if (taken == films::Film::Step::end) return std::optional<Frame>();
      if (film_.number() < next_ || taken == films::Film::Step::refused) continue;
      if (!film_.damage().empty()) continue;
      next_ = film_.number() + step_;
      const auto image = film_.image();
      if (!image) return image.error();
      return std::optional(
          Frame{numbered(name_, film_.number()), grey_of(*image), film_.orientation()});
    }
  }

 private:
  std::string name_;
  films::Film film_;
  std::int64_t step_;
  std::int64_t next_ = 0;  ///< the first frame that may be given
};

class CameraFrames final : public FrameReader {
 public:
  CameraFrames(std::string name, const cv::VideoCapture& capture)
      : name_(std::move(name)), capture_(capture) {}

  Result<std::optional<Frame>> next() override {
    if (!capture_.grab()) return std::optional<Frame>();
    cv::Mat image;
    try {
      capture_.retrieve(image);
    } catch (const cv::Exception&) {
      image.release();
    }
    const std::string name = numbered(name_, ++number_);
    if (image.empty() || image.type() != CV_8UC3) {
      return Error{Errc::invalid_data, name + " cannot be decoded", {}};
    }
    return std::optional(Frame{name, grey_of(image)});
  }

 private:
  std::string name_;
  cv::VideoCapture capture_;
  std::int64_t number_ = -1;  ///< number of the last frame that was read
};

}  // namespace

std::unique_ptr<FrameReader> read_images(std::vector<std::string> paths) {
  return std::make_unique<ImageFiles>(std::move(paths));
}

Result<std::unique_ptr<FrameReader>> open_film(const std::string& path, int frames) {
  if (!is_file(path)) {
    return Error{Errc::not_found, path + ": there is no such file; correct its name", {}};
  }
  auto film = films::Film::open(path);
  auto first = films::Film::open(path);  // FFmpeg opens some files without a readable frame
  if (!film || !first || first->advance() == films::Film::Step::end) {
    return Error{Errc::invalid_data,
                 path +
                     ": is neither an image nor a video that can be read: check it with another "
                     "program, or convert it",
                 {}};
  }
  const std::int64_t step = std::max<std::int64_t>(film->promised() / frames, 1);
  return std::unique_ptr<FrameReader>(std::make_unique<FilmFrames>(path, *std::move(film), step));
}

Result<std::unique_ptr<FrameReader>> open_camera(int number) {
  const std::string name = "/dev/video" + std::to_string(number);
  std::error_code status;
  if (!std::filesystem::exists(name, status)) {
    return Error{
        Errc::not_found, name + ": there is no such camera: connect it, or correct --camera", {}};
  }
  films::quiet_decoders();
  cv::VideoCapture capture;
  if (!capture.open(number, cv::CAP_V4L2)) {
    return Error{Errc::io,
                 name +
                     ": cannot be opened as a camera: end other programs that use it, and check "
                     "that you may read it (group video)",
                 {}};
  }
  return std::unique_ptr<FrameReader>(std::make_unique<CameraFrames>(name, capture));
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
