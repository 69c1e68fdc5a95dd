// SPDX-License-Identifier: Apache-2.0
#include "frame_stream.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "pipeline_text.hpp"

namespace weft::video {
namespace {

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A pipe of the file system, open for reading without waiting for a writer.
class Pipe {
 public:
  explicit Pipe(const std::string& path)
      : number_(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {}
  ~Pipe() {
    if (number_ >= 0) ::close(number_);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int number() const { return number_; }
  void wait_in_reads() const { fcntl(number_, F_SETFL, 0); }

 private:
  int number_;
};

/// Waits until a program has written into a pipe; false where the patience ends before.
bool comes_to_life(int pipe, double patience_s, const std::function<bool()>& cancelled) {
  constexpr int kLook_ms = 20;
  for (const double end_s = steady_s() + patience_s; !cancelled();) {
    pollfd look{pipe, POLLIN, 0};
    const int ready = poll(&look, 1, kLook_ms);
    if (ready > 0 && (look.revents & POLLIN) != 0) return true;
    if (steady_s() >= end_s) return false;
    if (ready > 0) usleep(1000 * kLook_ms);  // its writer has gone, which poll() reports at once
  }
  return false;
}

}  // namespace

Result<FrameStream> FrameStream::open_file(const std::string& path) {
  auto film = films::Film::open(path);
  if (!film) return film.error();
  FrameStream stream;
  stream.name_ = path;
  stream.fps_ = film->fps();
  stream.promised_s_ = static_cast<double>(film->promised()) / stream.fps_;
  stream.film_ = *std::move(film);
  return stream;
}

Result<FrameStream> FrameStream::open_device(int number, const CameraSettings& settings) {
  films::quiet_decoders();
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
  const auto refused = [&](const char* parameter) {
    return Error{Errc::invalid_value, stream.name_ + ": the camera does not take '" + parameter +
                                          "': leave it out, or see v4l2-ctl --list-ctrls-menus"};
  };
  if (settings.format.size() == 4) {
    const char* const format = settings.format.c_str();
    const int code = cv::VideoWriter::fourcc(format[0], format[1], format[2], format[3]);
    if (!stream.capture_.set(cv::CAP_PROP_FOURCC, code)) return refused("format");
  }
  stream.capture_.set(cv::CAP_PROP_FRAME_WIDTH, settings.size_px.width);
  stream.capture_.set(cv::CAP_PROP_FRAME_HEIGHT, settings.size_px.height);
  if (settings.fps > 0.0 && !stream.capture_.set(cv::CAP_PROP_FPS, settings.fps)) {
    return refused("fps");
  }
  constexpr double kManual = 1.0, kAutomatic = 3.0, kUnits_per_ms = 10.0;  // values of V4L2
  if (settings.exposure_ms < 0.0 && !stream.capture_.set(cv::CAP_PROP_AUTO_EXPOSURE, kAutomatic)) {
    return refused("exposure_ms");
  }
  if (settings.exposure_ms > 0.0) {
    const bool taken =
        stream.capture_.set(cv::CAP_PROP_AUTO_EXPOSURE, kManual) &&
        stream.capture_.set(cv::CAP_PROP_EXPOSURE, kUnits_per_ms * settings.exposure_ms);
    if (!taken) return refused("exposure_ms");
  }
  return stream;
}

Result<FrameStream> FrameStream::open_address(const std::string& address, double patience_s,
                                              const std::function<bool()>& cancelled) {
  films::quiet_decoders();
  FrameStream stream;
  stream.is_live_ = true;
  stream.name_ = address;
  const bool by_gstreamer = is_pipeline(address);
  const bool is_file = !by_gstreamer && address.find("://") == std::string::npos;
  std::error_code status;
  if (is_file && !std::filesystem::is_fifo(address, status)) {
    return Error{Errc::not_found,
                 address +
                     ": is no address (rtsp://...), pipe or pipeline of GStreamer (a ! "
                     "appsink): correct 'address', or give a file as 'path'"};
  }
  std::string source = address;
  if (is_file) {
    // Opened by its name it would wait for a writer, and for another one where the first has gone.
    const auto pipe = std::make_shared<Pipe>(address);
    if (pipe->number() < 0) return Error{Errc::io, address + ": the pipe cannot be read"};
    if (!comes_to_life(pipe->number(), patience_s, cancelled)) {
      return Error{Errc::io, address + ": no data was written into the pipe"};
    }
    pipe->wait_in_reads();
    source = "pipe:" + std::to_string(pipe->number());
    stream.pipe_ = pipe;
  }
  const int patience_ms = static_cast<int>(std::clamp(1000.0 * patience_s, 1.0, 1e6));
  const bool opened = by_gstreamer
                          ? stream.capture_.open(source, cv::CAP_GSTREAMER)
                          : stream.capture_.open(source, cv::CAP_FFMPEG,
                                                 {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, patience_ms,
                                                  cv::CAP_PROP_READ_TIMEOUT_MSEC, patience_ms});
  if (!opened) {
    return Error{Errc::io, address +
                               ": sends no video that can be read: is it right, and is the "
                               "camera on?"};
  }
  return stream;
}

bool FrameStream::advance() {
  if (film_ ? film_->advance() == films::Film::Step::end : !capture_.grab()) return false;
  stamp_s_ = next_stamp_s();
  if (++number_ == 0) first_stamp_s_ = stamp_s_;
  return true;
}

double FrameStream::next_stamp_s() {
  const double stated_s = film_ ? film_->stamp_s() : capture_.get(cv::CAP_PROP_POS_MSEC) / 1e3;
  if (stated_s > stamp_s_) return stated_s;
  if (!is_live_) return stamp_s_ + 1.0 / fps_;
  return std::max(steady_s(), std::nextafter(stamp_s_, HUGE_VAL));  // the clock of the drivers, too
}

void FrameStream::close() {
  capture_.release();
  film_.reset();
  pipe_.reset();
}

void FrameStream::continue_from(const FrameStream& before, double gap_s) {
  number_ += before.number_ + 1;
  first_stamp_s_ = stamp_s_ - before.time_s() - gap_s;
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
  if (film_) {
    auto image = film_->image();
    if (image) *image = image_files::upright(*image, orientation());
    return image;
  }
  cv::Mat image;
  try {
    capture_.retrieve(image);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (!image.empty() && image.type() == CV_8UC3) {
    return image_files::upright(image, orientation());
  }
  return Error{Errc::invalid_data,
               name_ + ": frame " + std::to_string(number_) + " cannot be decoded"};
}

/// The orientation that the file demands, followed by the quarter turns; 1 to 8 as in EXIF.
int FrameStream::orientation() const {
  constexpr int kTurned[] = {1, 6, 7, 8, 5,
                             2, 3, 4, 1};  // each one, turned clockwise by 90 degrees
  int orientation = film_ ? film_->orientation() : 1;
  for (int turn = 0; turn < quarter_turns_; ++turn) orientation = kTurned[orientation];
  return orientation;
}

std::string FrameStream::damage() { return film_ ? film_->damage() : std::string(); }

Result<cameras::StoredImages> FrameStream::stored() {
  if (film_) return cameras::StoredImages{film_->size_px(), orientation()};
  const auto first = image();
  if (!first) return first.error();
  const bool is_sideways = quarter_turns_ % 2 != 0;
  return cameras::StoredImages{
      is_sideways ? cv::Size(first->rows, first->cols) : cv::Size(first->cols, first->rows),
      orientation()};
}

}  // namespace weft::video
