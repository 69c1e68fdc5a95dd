// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <deque>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <weft/core/index.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/sdk/sink.hpp>

#include "caption.hpp"
#include "common/images/jpeg_encoder.hpp"
#include "common/images/opencv_codecs.hpp"
#include "drawing.hpp"
#include "job_thread.hpp"
#include "side_view.hpp"
#include "video_file.hpp"

namespace weft::overlay {
namespace {

namespace fs = std::filesystem;

enum class View { side, image };
enum class Format { png, jpg };

/// The content of the image of a frame, copied from the inputs.
struct Scene {
  std::uint64_t frame = 0;
  cv::Mat canvas;  ///< the camera's image in the upper left
  Caption caption;
  std::vector<cv::Point2d> matches_px;
  bool has_shape = false;             ///< if not, the rest is not set
  Points3 vertices_m;                 ///< [V,3]
  Points2 vertices_px;                ///< [V,2]
  std::vector<std::uint8_t> visible;  ///< [V], empty where unknown
  std::vector<double> measured;       ///< [V]
  double confidence = 0.0;
  MeshStyle style;
};

/// A video of the frames with the estimated mesh over them, the mesh from the side beside them, and
/// a description in words below. A thread renders and writes the images, so that a frame does not
/// wait for them.
class Overlay final : public Sink {
 public:
  static constexpr About kAbout{.needs = "image camera template",
                                .reads = "shape visibility correspondences time"};

  explicit Overlay(Params& p) {
    p.output_path("path", path_, "path of the video file, .avi, .mkv or .mp4");
    p.read("fps", fps_, "1/s", {0.1, 1000.0}, "frame rate of the video");
    p.read("stills_every", stills_every_, "frames", {0, 1'000'000},
           "interval at which frames are also written as image files; 0: none");
    p.choice("stills_format", stills_format_, {{"png", Format::png}, {"jpg", Format::jpg}},
             "file format of the stills; png: lossless; jpg: smaller files");
    p.output_path("stills", stills_path_, "folder of the stills; by default named after the video");
    p.read("stills_width_px", stills_width_px_, "px", {0, 10'000},
           "width of the stills; 0: width of the video");
    p.read("draw_matches", draw_matches_, "rendering of the kept matches as dots");
    p.read("line_width_px", line_width_px_, "px", {0, 20},
           "width of the mesh lines; 0: derived from the image size");
    p.choice("view", view_, {{"side", View::side}, {"image", View::image}},
             "content of the video; side: the image beside a side view of the mesh; image: the "
             "image only");
    p.read("turn_frames", turn_frames_, "frames", {0, 1'000'000},
           "period of the swinging side view; 0: fixed view");
  }

  void check(Mistakes& mistakes) const { mistakes.expect("path", VideoFile::check_format(path_)); }

  Result<void> prepare(const PrepareInput& in) override {
    auto topology = build_topology(in.templ.faces.matrix<3>(), in.templ.vertices_m.rows());
    if (!topology) return topology.error();
    topology_ = *std::move(topology);
    faces_ = in.templ.faces.matrix<3>();
    frame_size_ = {static_cast<int>(in.camera.width_px), static_cast<int>(in.camera.height_px)};
    drawn_ = drawn_edges(in.templ.vertices_m.matrix<3>(), topology_);
    canvas_size_ = {frame_size_.width, frame_size_.height + caption_height_px(frame_size_)};
    if (view_ == View::image) return {};
    const int side_px = std::min(frame_size_.width, frame_size_.height);
    const cv::Size panel(side_px + side_px % 2, frame_size_.height);
    canvas_size_.width += panel.width;
    side_view_ = SideView(in.templ, topology_, drawn_, panel, turn_frames_);
    return {};
  }

  Result<void> open(const Call&) override {
    if (auto opened = video_.open(path_, fps_, canvas_size_); !opened) return opened;
    thread_ = std::make_unique<JobThread<Scene>>([this](Scene& scene) { finish_scene(scene); });
    return {};
  }

  Result<void> write(const SinkInput& in) override {
    if (!thread_) return Error{Errc::io, "the video " + path_ + " is not open"};
    const Array<std::uint8_t>& pixels = in.image->pixels;
    const cv::Size size(static_cast<int>(pixels.dim(1)), static_cast<int>(pixels.dim(0)));
    if (size != frame_size_) {
      return Error{Errc::invalid_data, "the frame is " + text_of(size) + " px, but the video " +
                                           path_ + " is " + text_of(frame_size_) +
                                           " px, as the camera"};
    }
    if (in.shape && in.shape->vertices_m.rows() != in.templ->vertices_m.rows()) {
      return Error{Errc::invalid_data,
                   "the shape has " + std::to_string(in.shape->vertices_m.rows()) +
                       " vertices, the template " + std::to_string(in.templ->vertices_m.rows())};
    }
    fill_scene(in, thread_->next());
    thread_->submit();
    return oldest_failure();
  }

  Result<void> finish(const Call&) override {
    thread_.reset();  // renders and writes the remaining scenes
    auto closed = video_.close();
    return closed ? oldest_failure() : closed;
  }

 private:
  static std::string text_of(cv::Size size) {
    return std::to_string(size.width) + " x " + std::to_string(size.height);
  }

  void fill_scene(const SinkInput& in, Scene& scene) const {
    scene.frame = in.call.frame();
    scene.canvas.create(canvas_size_, CV_8UC3);
    cv::Mat frame = scene.canvas(cv::Rect({}, frame_size_));
    copy_pixels(in.image->pixels, frame);
    scene.caption = caption_of(in);
    scene.matches_px.clear();
    if (draw_matches_ && in.correspondences) scene.matches_px = kept_points(*in.correspondences);
    scene.has_shape = in.shape.has_value();
    if (!scene.has_shape) return;
    constexpr int kHeightOfOneLine_px = 900;
    const int width_px = line_width_px_ > 0 ? line_width_px_ : 1 + frame.rows / kHeightOfOneLine_px;
    const Pinhole pinhole{in.camera->fx, in.camera->fy, in.camera->cx, in.camera->cy};
    scene.vertices_m = in.shape->vertices_m.matrix<3>();
    scene.vertices_px = project_points(pinhole, scene.vertices_m);
    const auto visible = visible_in(in);
    scene.visible.assign(visible.begin(), visible.end());
    scene.measured = measured_in(in);
    scene.confidence = in.shape->confidence;
    scene.style = style_of(*in.shape, width_px);
  }

  /// Runs in the thread.
  void finish_scene(Scene& scene) {
    Result<void> done;
    try {
      render(scene);
      done = video_.write(scene.canvas);
      if (done && stills_every_ > 0 &&
          scene.frame % static_cast<std::uint64_t>(stills_every_) == 0) {
        done = write_still(scene.canvas, scene.frame);
      }
    } catch (const std::exception& error) {
      done = Error{Errc::plugin_failure, std::string("rendering failed: ") + error.what()};
    }
    if (done) return;
    Error error = done.error();
    error.message = "frame " + std::to_string(scene.frame) + ": " + error.message;
    const std::lock_guard lock(failures_mutex_);
    failures_.push_back(std::move(error));
  }

  /// The oldest failure of the thread that was not returned yet.
  Result<void> oldest_failure() {
    const std::lock_guard lock(failures_mutex_);
    if (failures_.empty()) return {};
    Error error = std::move(failures_.front());
    failures_.pop_front();
    return error;
  }

  void render(Scene& scene) {
    cv::Mat frame = scene.canvas(cv::Rect({}, frame_size_));
    draw_points(frame, scene.matches_px);
    if (scene.has_shape) {
      draw_mesh(frame, scene.vertices_px, faces_, topology_, drawn_, scene.visible, scene.style);
    }
    draw_caption(scene.canvas.rowRange(frame_size_.height, scene.canvas.rows), scene.caption);
    if (view_ == View::image) return;
    const cv::Mat panel = scene.canvas(cv::Range(0, frame_size_.height),
                                       cv::Range(frame_size_.width, scene.canvas.cols));
    if (scene.has_shape) {
      side_view_.draw(panel, scene.vertices_m, scene.confidence, scene.measured, scene.frame);
    } else {
      side_view_.draw_nothing(panel, "no shape has been found yet", scene.frame);
    }
  }

  static void copy_pixels(const Array<std::uint8_t>& pixels, cv::Mat& frame) {
    const bool grey = pixels.ndim() == 2;
    const cv::Mat image(frame.size(), grey ? CV_8UC1 : CV_8UC3,
                        const_cast<std::uint8_t*>(pixels.data()), to_index(pixels.row_stride()));
    if (grey) {
      cv::cvtColor(image, frame, cv::COLOR_GRAY2BGR);
    } else {
      image.copyTo(frame);
    }
  }

  /// [V] 1 where the surface was seen and measured in this frame, as far as is known.
  static std::vector<double> measured_in(const SinkInput& in) {
    const Shape& shape = *in.shape;
    const bool is_new =
        shape.shape_state() == ShapeState::estimated || shape.shape_state() == ShapeState::weak;
    const auto visible = visible_in(in);
    std::vector<double> measured(to_index(shape.vertices_m.rows()), 0.0);
    for (std::size_t v = 0; is_new && v < measured.size(); ++v) {
      const bool is_seen = visible.empty() || visible[v] != 0;
      measured[v] = is_seen && shape.source(static_cast<std::int64_t>(v)) != 0 ? 1.0 : 0.0;
    }
    return measured;
  }

  /// [V] visibility of this very shape; empty where unknown.
  static std::span<const std::uint8_t> visible_in(const SinkInput& in) {
    if (!in.visibility || in.visibility->visible.rows() != in.shape->vertices_m.rows()) return {};
    return {in.visibility->visible.data(), to_index(in.visibility->visible.rows())};
  }

  static std::vector<cv::Point2d> kept_points(const Correspondences& matches) {
    std::vector<cv::Point2d> points;
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      if (matches.kept(i) != 0) points.emplace_back(matches.image_px(i, 0), matches.image_px(i, 1));
    }
    return points;
  }

  cv::Mat still_of(const cv::Mat& canvas) const {
    if (stills_width_px_ == 0 || stills_width_px_ >= canvas.cols) return canvas;
    cv::Mat still;
    const int height = std::max(1, canvas.rows * stills_width_px_ / canvas.cols);
    cv::resize(canvas, still, {stills_width_px_, height}, 0, 0, cv::INTER_AREA);
    return still;
  }

  Result<void> write_still(const cv::Mat& canvas, std::uint64_t frame) const {
    const std::string extension = stills_format_ == Format::png ? ".png" : ".jpg";
    char name[32];
    std::snprintf(name, sizeof name, "%06llu", static_cast<unsigned long long>(frame));
    const fs::path path = fs::path(stills_path_) / (name + extension);
    constexpr int kQuality = 95;
    const std::vector<std::uint8_t> bytes =
        stills_format_ == Format::png ? image_files::encode_by_opencv(extension, still_of(canvas))
                                      : image_files::encode_jpeg(still_of(canvas), kQuality);
    if (bytes.empty()) {
      return Error{Errc::unsupported, "the frame cannot be written as " + extension};
    }
    std::error_code status;
    fs::create_directories(path.parent_path(), status);  // writing reports why it cannot
    return write_whole({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path,
                       Durability::unsynced);
  }

  std::string path_ = "overlay.avi";
  double fps_ = 30.0;
  int stills_every_ = 0;
  Format stills_format_ = Format::png;
  std::string stills_path_ = "{path}";
  int stills_width_px_ = 0;
  bool draw_matches_ = false;
  int line_width_px_ = 0;
  View view_ = View::side;
  int turn_frames_ = 360;

  MeshTopology topology_;
  std::vector<std::uint8_t> drawn_;  ///< [E] edges that become lines
  cv::Size frame_size_, canvas_size_;
  Faces faces_;  ///< [F,3]
  SideView side_view_;
  VideoFile video_;
  std::mutex failures_mutex_;
  std::deque<Error> failures_;
  std::unique_ptr<JobThread<Scene>> thread_;  // the last member: it uses the others
};

}  // namespace
}  // namespace weft::overlay

using weft::overlay::Overlay;
WEFT_PLUGIN(Overlay, "sinks/overlay", "1.0.0",
            "Writes a video of the frames with the mesh overlaid and a side view of the mesh.")
