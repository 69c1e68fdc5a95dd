// SPDX-License-Identifier: Apache-2.0
#include "common/films/film.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/films/display_matrix.hpp"

namespace weft::films {
Result<Film> Film::open(const std::string& path) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) {
    return Error{Errc::not_found, path + ": is no regular file"};
  }
  quiet_decoders();
  Film film;
  film.path_ = path;
  if (!film.capture_.open(path, cv::CAP_FFMPEG)) {
    return Error{Errc::invalid_data,
                 path +
                     ": is no video that can be read (empty, damaged, cut off, unreadable or of "
                     "an unknown format): check it with another player, or convert it"};
  }
  cv::VideoCapture& capture = film.capture_;
  capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);  // frames and camera are turned together
  film.fps_ = capture.get(cv::CAP_PROP_FPS);
  if (!std::isfinite(film.fps_) || film.fps_ <= 0.0) {
    return Error{Errc::invalid_data, path + ": has no frame rate: convert it to another format"};
  }
  film.orientation_ = orientation_of_film(path);
  const bool is_turned_otherwise =
      film.orientation_ == 1 && capture.get(cv::CAP_PROP_ORIENTATION_META) != 0.0;
  if (film.orientation_ == 0 || is_turned_otherwise) {
    return Error{Errc::unsupported,
                 path +
                     ": its container specifies a rotation of the frames, by an angle or in a "
                     "format that is not supported: convert it to a video without rotation"};
  }
  const double promised = capture.get(cv::CAP_PROP_FRAME_COUNT);
  if (std::isfinite(promised)) film.promised_ = std::llround(std::clamp(promised, 0.0, 1e9));
  film.size_px_ = {static_cast<int>(capture.get(cv::CAP_PROP_FRAME_WIDTH)),
                   static_cast<int>(capture.get(cv::CAP_PROP_FRAME_HEIGHT))};
  film.packets_ = Packets::of_motion_jpeg(path, capture.get(cv::CAP_PROP_FOURCC));
  return film;
}

/// Goes to the next frame that can be decoded, and counts those before it; false if there is none.
bool Film::look_ahead() {
  constexpr std::int64_t kLeastTries = 100, kMostTries = 100'000;
  const std::int64_t missing = promised_ - number_;
  const std::int64_t tries = std::clamp(missing, kLeastTries, kMostTries);
  for (refused_ = 0; refused_ < tries; ++refused_) {
    if (capture_.grab()) return true;
  }
  // Frames at the end were refused if the header and the packets agree that there are some; of
  // other formats than Motion JPEG not every packet is a frame.
  refused_ = 0;
  if (number_ >= 0 && missing > 1 && packets_.are_known() && count_packets(path_) == promised_) {
    refused_ = missing - 1;
  }
  return false;
}

Film::Step Film::advance() {
  if (!is_ahead_ && !is_over_) {
    is_ahead_ = look_ahead();
    is_over_ = !is_ahead_;
  }
  is_refused_ = refused_ > 0;
  if (!is_refused_ && is_over_) return Step::end;
  ++number_;
  if (is_refused_) {
    --refused_;
    return Step::refused;
  }
  is_ahead_ = false;
  return Step::frame;
}

double Film::stamp_s() const {
  return is_refused_ ? 0.0 : capture_.get(cv::CAP_PROP_POS_MSEC) / 1e3;
}

Result<cv::Mat> Film::image() {
  if (is_refused_) return cv::Mat(size_px_, CV_8UC3, cv::Scalar::all(0));
  cv::Mat image;
  try {
    capture_.retrieve(image);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (!image.empty() && image.type() == CV_8UC3) return image;
  return Error{Errc::invalid_data,
               path_ + ": frame " + std::to_string(number_) + " cannot be decoded"};
}

std::string Film::damage() {
  const std::string damage = packets_.damage(number_);
  if (is_refused_) {
    return "frame " + std::to_string(number_) + " cannot be decoded and is black" +
           (damage.empty() ? "" : ": " + damage);
  }
  return damage.empty() ? damage : "frame " + std::to_string(number_) + " is damaged: " + damage;
}

}  // namespace weft::films
