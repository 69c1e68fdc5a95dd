// SPDX-License-Identifier: Apache-2.0
#include "frame_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

namespace weft::video {

Result<FrameStream> FrameStream::open_file(const std::string& path) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) {
    return Error{Errc::not_found, path + ": is no regular file: correct 'path'"};
  }
  FrameStream stream;
  stream.name_ = path;
  if (!stream.capture_.open(path, cv::CAP_FFMPEG)) {
    return Error{Errc::invalid_data,
                 path +
                     ": is no video that can be read (empty, damaged, cut off, unreadable or of "
                     "an unknown format): check it with another player, or convert it"};
  }
  stream.capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);  // the calibration ignores it too
  stream.fps_ = stream.capture_.get(cv::CAP_PROP_FPS);
  if (!std::isfinite(stream.fps_) || stream.fps_ <= 0.0) {
    return Error{Errc::invalid_data, path + ": has no frame rate: convert it to another format"};
  }
  const double promised = stream.capture_.get(cv::CAP_PROP_FRAME_COUNT);
  if (std::isfinite(promised)) stream.promised_s_ = std::max(0.0, promised / stream.fps_);
  return stream;
}

Result<FrameStream> FrameStream::open_device(int number, const cv::Size& size_px) {
  FrameStream stream;
  stream.is_live_ = true;
  stream.name_ = "/dev/video" + std::to_string(number);
  std::error_code status;
  if (!std::filesystem::exists(stream.name_, status)) {
    return Error{Errc::not_found,
                 stream.name_ + ": there is no such camera: connect it or correct 'device'"};
  }
  if (!stream.capture_.open(number, cv::CAP_V4L2)) {
    return Error{Errc::io, stream.name_ +
                               ": cannot be opened as a camera: end other programs that use it, "
                               "and check that you may read it (group video)"};
  }
  stream.capture_.set(cv::CAP_PROP_FRAME_WIDTH, size_px.width);
  stream.capture_.set(cv::CAP_PROP_FRAME_HEIGHT, size_px.height);
  return stream;
}

bool FrameStream::advance() {
  if (!capture_.grab()) return false;
  stamp_s_ = next_stamp_s();
  if (++number_ == 0) first_stamp_s_ = stamp_s_;
  return true;
}

double FrameStream::next_stamp_s() {
  const double stated_s = capture_.get(cv::CAP_PROP_POS_MSEC) / 1e3;
  if (stated_s > stamp_s_) return stated_s;
  if (!is_live_) return stamp_s_ + 1.0 / fps_;
  // The clock of the drivers' times, too.
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Result<void> FrameStream::ending() const {
  if (is_live_) {
    return Error{Errc::io, name_ + ": the camera gives no more frames: is it still connected?"};
  }
  // Some headers count the sound's last moment or frames that were dropped.
  const double tolerance_s = std::max(2.0 / fps_, 0.02 * promised_s_);
  const double length_s = time_s() + 1.0 / fps_;
  if (length_s + tolerance_s >= promised_s_) return {};
  return Error{
      Errc::invalid_data,
      fmt::format("{}: ends after {:.3f} s of the {:.3f} s that its header promises: it is "
                  "cut off or damaged; get the whole file, or set 'max_frames'",
                  name_, length_s, promised_s_)};
}

Result<cv::Mat> FrameStream::image() {
  cv::Mat image;
  try {
    capture_.retrieve(image);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (!image.empty() && image.type() == CV_8UC3) return image;
  return Error{Errc::invalid_data,
               name_ + ": frame " + std::to_string(number_) + " cannot be decoded"};
}

}  // namespace weft::video
