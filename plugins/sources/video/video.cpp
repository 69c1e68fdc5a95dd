// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>
#include <weft/core/quote.hpp>
#include <weft/sdk/source.hpp>

#include "common/assumed_cameras/assumed_camera.hpp"
#include "common/cameras/calibrated_camera.hpp"
#include "frame_stream.hpp"
#include "pipeline_text.hpp"

namespace weft::video {
namespace {

/// The frames of a video file or of a camera, undistorted.
class Video final : public Source {
 public:
  static constexpr About kAbout{.produces = "image time"};

  explicit Video(Params& p) {
    p.input_path("path", path_, "video file, in any format that FFmpeg reads");
    p.read("device", device_, "", {-1, 1023},
           "camera that replaces a file: N of /dev/videoN; -1: none");
    p.text("address", address_,
           "stream that replaces a file: rtsp://..., a pipe, or a GStreamer pipeline to appsink");
    p.input_path(
        "camera", camera_path_,
        "camera file: Weft's own (YAML or JSON), OpenCV's YAML or ROS camera_info; auto: assumed "
        "focal length, with one warning; empty: the same, with a warning per frame",
        Need::optional, {"auto"});
    cameras::declare(p, focal_);
    p.read("start_s", start_s_, "s", {0.0, 1e6}, "time before which frames are skipped");
    p.read("step", step_, "", {1, 1'000'000}, "interval of the frames that are used");
    p.read("max_frames", max_frames_, "", {0, 1'000'000'000}, "maximum number of frames; 0: all");
    p.read("width_px", size_px_.width, "px", {0, 65'535},
           "width requested from a device; 0: that of the camera file, else 640");
    p.read("height_px", size_px_.height, "px", {0, 65'535},
           "height requested from a device; 0: that of the camera file, else 480");
    p.text("format", settings_.format,
           "pixel format requested from a device, four characters such as MJPG");
    p.read("fps", settings_.fps, "1/s", {0.0, 10'000.0},
           "frame rate requested from a device; 0: its default");
    p.read("exposure_ms", settings_.exposure_ms, "ms", {-1.0, 10'000.0},
           "exposure time requested from a device; 0: as it is set, below 0: automatic");
    p.read("rotation_deg", rotation_deg_, "deg", {0, 270},
           "clockwise rotation of the images, with their camera: 0, 90, 180 or 270");
    p.formerly("patience_s")
        .read("timeout_s", patience_s_, "s", {0.0, 86'400.0},
              "maximum time without frames before a camera is given up");
    p.read("longest_px", longest_px_, "px", {0, 65'535},
           "maximum length of a frame side; larger frames are scaled down, with their camera; 0: "
           "no limit");
  }

  /// A camera is not opened, and where 'start_s' leads is not decoded.
  void check(Mistakes& mistakes) const {
    mistakes.expect("focal_by_side", cameras::check(focal_, camera_path_ == "auto"));
    const auto camera = is_calibrated() ? cameras::CalibratedCamera::read_sizes(camera_path_)
                                        : cameras::CalibratedCamera();
    const bool calibrated = mistakes.expect("camera", camera) && is_calibrated();
    mistakes.expect("rotation_deg", check_rotation());
    mistakes.expect("format", check_format());
    mistakes.expect("width_px", check_size(camera));
    if (!mistakes.expect(given(), check_choice())) return;
    if (live()) return;
    auto stream = FrameStream::open_file(path_);
    if (!mistakes.expect("path", stream)) return;
    if (!stream->advance()) return mistakes.add("path", no_frame());
    const auto stored = stream->stored();
    if (stored && calibrated) mistakes.expect("camera", camera->of_images(*stored, path_));
  }

  Result<Camera> open(const Call& call) override {
    if (auto chosen = check_choice(); !chosen) return about(given(), chosen.error());
    if (is_calibrated()) {
      auto camera = cameras::CalibratedCamera::read(camera_path_);
      if (!camera) return about("camera", camera.error());
      camera_ = *std::move(camera);
    }
    end_.reset();
    if (auto started = start(call); !started) return about(given(), started.error());
    const auto stored = stream_.stored();
    if (!stored) return stored.error();
    if (auto sent = check_sent(stored->size_px); !sent) return about("width_px", sent.error());
    if (!is_calibrated()) {
      const auto assumed = cameras::assume_camera({{stream_.name(), stored->size_px}}, focal_);
      if (!assumed) return assumed.error();
      camera_ = cameras::CalibratedCamera::assumed(*assumed);
    }
    auto upright = camera_.of_images(*stored, stream_.name());
    if (!upright) return about("camera", upright.error());
    camera_ = upright->at_most(longest_px_);
    camera_.report_orientation(call, stream_.name());
    if (!camera_path_.empty() && !is_calibrated()) {
      call.log_warning(cameras::assumption_text(camera_.pinhole()));
    }
    return camera_.pinhole();
  }

  /// Unknown even for a file: the count in its header is an estimate, or wrong if the file was cut
  /// off.
  std::int64_t count() const override { return -1; }

  bool live() const override { return path_.empty(); }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    if (index < 0) return Error{Errc::invalid_value, "frames are counted from 0"};
    if (max_frames_ > 0 && index >= max_frames_) return no_more_frames("'max_frames' were read");
    if (auto found = go_to(index, call); !found) return found.error();
    const auto stored = stream_.image();
    if (!stored) return stored.error();
    const std::string stem = std::filesystem::path(stream_.name()).stem().string();
    auto image = camera_.undistorted(*stored, stream_.name(),
                                     fmt::format("{}_{:06}", stem, stream_.number()));
    if (!image) return image.error();
    SourceFrame frame;
    frame.image = *std::move(image);
    frame.time = Time{stream_.time_s() - first_time_s_};
    if (std::string damage = stream_.damage(); !damage.empty()) {
      return degenerate(std::move(frame), stream_.name() + ": " + damage);
    }
    if (!gap_.empty()) return degenerate(std::move(frame), std::exchange(gap_, {}));
    if (camera_path_.empty()) {
      return degenerate(std::move(frame),
                        "not calibrated: the focal length is a guess, so depths are too; make a "
                        "camera file with `weft calibrate`");
    }
    return frame;
  }

 private:
  static constexpr int kUsualWidth_px = 640, kUsualHeight_px = 480;  // requested from a device

  bool is_calibrated() const { return !camera_path_.empty() && camera_path_ != "auto"; }

  static Error cancelled() { return {Errc::cancelled, "cancelled", {}}; }

  /// Opens the stream and goes to frame 0 of this source.
  Result<void> start(const Call& call) {
    is_at_a_frame_ = false;
    stream_ = {};  // a camera cannot be opened twice
    gap_.clear();
    auto opened = open_stream(patience_s_, call);
    if (!opened) return opened.error();
    stream_ = *std::move(opened);
    stream_.turn(rotation_deg_ / 90);
    do {
      if (call.cancelled()) return cancelled();
      if (!stream_.advance()) return no_start();
    } while (stream_.time_s() + kTimeTolerance_s < start_s_);
    first_number_ = stream_.number();
    first_time_s_ = stream_.time_s();
    is_at_a_frame_ = true;
    return {};
  }

  Result<FrameStream> open_stream(double patience_s, const Call& call) const {
    if (!path_.empty()) return FrameStream::open_file(path_);
    if (!address_.empty()) {
      return FrameStream::open_address(address_, patience_s, [&] { return call.cancelled(); });
    }
    CameraSettings settings = settings_;
    settings.size_px = {kUsualWidth_px, kUsualHeight_px};
    if (is_calibrated()) settings.size_px = camera_.size_px();
    if (size_px_.area() > 0) settings.size_px = size_px_;
    return FrameStream::open_device(device_, settings);
  }

  Result<void> check_rotation() const {
    if (rotation_deg_ % 90 == 0) return {};
    return Error{Errc::invalid_value,
                 fmt::format("is {}: give 0, 90, 180 or 270 degrees", rotation_deg_)};
  }

  Result<void> check_format() const {
    if (settings_.format.empty() || settings_.format.size() == 4) return {};
    return Error{Errc::invalid_value,
                 quote(settings_.format) + " has not four characters; see v4l2-ctl --list-formats"};
  }

  template <class SizeRead>
  Result<void> check_size(const SizeRead& camera) const {
    if ((size_px_.width > 0) != (size_px_.height > 0)) {
      return Error{Errc::invalid_value, "give 'width_px' and 'height_px', both or none"};
    }
    if (size_px_.width == 0 || !is_calibrated() || !camera || camera->size_px() == size_px_) {
      return {};
    }
    return Error{Errc::invalid_value,
                 fmt::format("the camera file describes images of {} x {} px: leave 'width_px' and "
                             "'height_px' out, or calibrate the camera at this size",
                             camera->size_px().width, camera->size_px().height)};
  }

  /// A camera that lacks the requested size sends another one.
  Result<void> check_sent(const cv::Size& size_px) const {
    if (device_ < 0 || size_px_.area() == 0 || size_px == size_px_) return {};
    return Error{
        Errc::invalid_value,
        fmt::format("{}: the camera sends {} x {} px instead of {} x {}: choose a size and "
                    "a 'format' of v4l2-ctl --list-formats-ext",
                    stream_.name(), size_px.width, size_px.height, size_px_.width,
                    size_px_.height)};
  }

  Result<void> check_choice() const {
    const int given = (path_.empty() ? 0 : 1) + (device_ < 0 ? 0 : 1) + (address_.empty() ? 0 : 1);
    if (given != 1) return Error{Errc::invalid_value, "give one of 'path', 'device' and 'address'"};
    return is_pipeline(address_) ? check_pipeline(address_) : Result<void>();
  }

  /// The parameter that selects the input.
  const char* given() const {
    if (!path_.empty()) return "path";
    return address_.empty() ? "device" : "address";
  }

  std::string no_frame() const { return path_ + ": holds no frame that can be decoded"; }

  Error no_start() const {
    if (live()) return stream_.ending().error();
    if (stream_.number() < 0) return {Errc::invalid_data, no_frame(), {}};
    return {Errc::invalid_value,
            fmt::format("{}: its last frame is at {:.3f} s, before 'start_s': make that smaller",
                        path_, stream_.time_s()),
            {}};
  }

  Result<void> go_to(std::int64_t index, const Call& call) {
    if (end_ && index >= *end_) return end_at(index);
    const bool is_past = passed() / step_ + (passed() % step_ == 0 ? 0 : 1) > index;
    if (!is_at_a_frame_ || is_past) {
      if (live()) {
        return Error{Errc::invalid_value,
                     stream_.name() + ": a camera cannot give an earlier frame again"};
      }
      if (auto started = start(call); !started) return started;
    }
    while (passed() / step_ < index) {
      if (call.cancelled()) return cancelled();
      if (stream_.advance()) continue;
      if (live()) {
        if (try_again(call)) continue;
        if (call.cancelled()) return cancelled();
      }
      is_at_a_frame_ = false;
      end_ = passed() / step_ + 1;
      ending_ = stream_.ending();
      return end_at(index);
    }
    return {};
  }

  /// A camera that gives no more frames is opened anew, as often as patience lasts, up to its next
  /// frame. False where that fails.
  bool try_again(const Call& call) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const auto away_s = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    stream_.close();  // a camera cannot be opened twice
    while (!call.cancelled() && away_s() < patience_s_) {
      auto opened = open_stream(patience_s_ - away_s(), call);
      if (opened && opened->advance()) {
        opened->turn(rotation_deg_ / 90);
        opened->continue_from(stream_, away_s());
        stream_ = *std::move(opened);
        gap_ = fmt::format("{}: the camera gave no frames for {:.1f} s and was opened again",
                           stream_.name(), away_s());
        return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }

  /// Frames of the stream since frame 0 of this source.
  std::int64_t passed() const { return stream_.number() - first_number_; }

  /// A stream that broke off is an error of the first frame that is missing, then the end.
  Result<void> end_at(std::int64_t index) const {
    if (!ending_ && index == *end_) return ending_;
    return no_more_frames(stream_.name() + ": has no more frames");
  }

  static constexpr double kTimeTolerance_s = 1e-6;  // times were rounded in the container

  std::string path_;
  int device_ = -1;
  std::string address_;
  std::string camera_path_;
  cameras::KnownFocal focal_;
  double start_s_ = 0.0;
  int step_ = 1;
  std::int64_t max_frames_ = 0;
  CameraSettings settings_;
  cv::Size size_px_;  ///< requested; 0 x 0: not given
  double patience_s_ = 5.0;
  int rotation_deg_ = 0, longest_px_ = 0;

  cameras::CalibratedCamera camera_;
  FrameStream stream_;
  bool is_at_a_frame_ = false;       // true if the stream has a current frame
  std::int64_t first_number_ = 0;    // number of frame 0 of this source in the stream
  double first_time_s_ = 0.0;        // time of the same
  std::optional<std::int64_t> end_;  // the first frame that the stream lacks, once known
  Result<void> ending_;
  std::string gap_;  // why frames are missing before the next one
};

}  // namespace
}  // namespace weft::video

using weft::video::Video;
WEFT_PLUGIN(Video, "sources/video", "1.4.0", "Reads a video file or a camera, undistorted.")
