// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/sdk/sink.hpp>

#include "drawing.hpp"
#include "video_file.hpp"

namespace weft::overlay {
namespace {

namespace fs = std::filesystem;

/// A video of the frames with the estimated mesh drawn over them.
class Overlay final : public Sink {
 public:
  static constexpr About kAbout{.needs = "image camera template",
                                .reads = "shape visibility correspondences time"};

  explicit Overlay(Params& p) {
    p.output_path("path", path_, "video file, .avi or .mkv");
    p.read("fps", fps_, "1/s", {0.1, 1000.0}, "frames a second of the video");
    p.read("stills_every", stills_every_, "frames", {0, 1'000'000},
           "also keep every n-th frame as PNG; 0: none");
    p.output_path("stills", stills_path_, "folder of these; named like the video by default");
    p.read("stills_width_px", stills_width_px_, "px", {0, 10'000},
           "width of these; 0: that of the frames");
    p.read("draw_matches", draw_matches_, "draw the kept matches as dots");
    p.read("line_width_px", line_width_px_, "px", {1, 20}, "width of the mesh's lines");
  }

  void check(Mistakes& mistakes) const { mistakes.expect("path", VideoFile::check_format(path_)); }

  Result<void> prepare(const PrepareInput& in) override {
    auto topology = build_topology(in.templ.faces.matrix<3>(), in.templ.vertices_m.rows());
    if (!topology) return topology.error();
    topology_ = *std::move(topology);
    frame_size_ = {static_cast<int>(in.camera.width_px), static_cast<int>(in.camera.height_px)};
    return {};
  }

  Result<void> open(const Call&) override { return video_.open(path_, fps_, frame_size_); }

  Result<void> write(const SinkInput& in) override {
    if (!video_.is_open()) return Error{Errc::io, "the video " + path_ + " is not open", {}};
    const Array<std::uint8_t>& pixels = in.image->pixels;
    const cv::Size size(static_cast<int>(pixels.dim(1)), static_cast<int>(pixels.dim(0)));
    if (size != frame_size_) {
      return Error{Errc::invalid_data,
                   "the frame is " + text_of(size) + " px, but the video " + path_ + " is " +
                       text_of(frame_size_) + " px, as the camera",
                   {}};
    }
    cv::Mat canvas = to_canvas(pixels, size);
    if (auto drawn = draw(in, canvas); !drawn) return drawn.error();
    if (auto written = video_.write(canvas); !written) return written.error();
    if (stills_every_ > 0 && in.call.frame() % static_cast<std::uint64_t>(stills_every_) == 0) {
      return write_still(canvas, in.call.frame());
    }
    return {};
  }

  Result<void> finish(const Call&) override { return video_.close(); }

 private:
  static std::string text_of(cv::Size size) {
    return std::to_string(size.width) + " x " + std::to_string(size.height);
  }

  static cv::Mat to_canvas(const Array<std::uint8_t>& pixels, cv::Size size) {
    const bool grey = pixels.ndim() == 2;
    const cv::Mat image(size, grey ? CV_8UC1 : CV_8UC3, const_cast<std::uint8_t*>(pixels.data()),
                        static_cast<std::size_t>(pixels.row_stride()));
    cv::Mat canvas;
    if (grey) {
      cv::cvtColor(image, canvas, cv::COLOR_GRAY2BGR);
    } else {
      image.copyTo(canvas);
    }
    return canvas;
  }

  Result<void> draw(const SinkInput& in, cv::Mat& canvas) const {
    if (draw_matches_ && in.correspondences) draw_points(canvas, kept_points(*in.correspondences));
    cv::Scalar caption_colour(220, 220, 220);
    if (in.shape) {
      const Shape& shape = *in.shape;
      if (shape.vertices_m.rows() != in.templ->vertices_m.rows()) {
        return Error{Errc::invalid_data,
                     "the shape has " + std::to_string(shape.vertices_m.rows()) +
                         " vertices, the template " + std::to_string(in.templ->vertices_m.rows()),
                     {}};
      }
      const Pinhole pinhole{in.camera->fx, in.camera->fy, in.camera->cx, in.camera->cy};
      const MeshStyle style = style_of(shape.shape_state(), line_width_px_);
      draw_mesh(canvas, project_points(pinhole, shape.vertices_m.matrix<3>()),
                in.templ->faces.matrix<3>(), topology_, visible_in(in), style);
      caption_colour = style.colour;
    }
    draw_caption(canvas, caption(in), caption_colour);
    return {};
  }

  /// [V] what is said of this very shape; empty where nothing is.
  static std::span<const std::uint8_t> visible_in(const SinkInput& in) {
    if (!in.visibility || in.visibility->visible.rows() != in.shape->vertices_m.rows()) return {};
    return {in.visibility->visible.data(), static_cast<std::size_t>(in.visibility->visible.rows())};
  }

  static std::vector<cv::Point2d> kept_points(const Correspondences& matches) {
    std::vector<cv::Point2d> points;
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      if (matches.kept(i) != 0) points.emplace_back(matches.image_px(i, 0), matches.image_px(i, 1));
    }
    return points;
  }

  /// "009   estimated   143 matches   0.27 s"
  static std::string caption(const SinkInput& in) {
    constexpr const char* kGap = "   ";
    std::string text = in.image->stem.empty() ? std::to_string(in.call.frame()) : in.image->stem;
    text += kGap;
    text += in.shape ? to_string(in.shape->shape_state()) : "no shape";
    if (in.shape && in.shape->age_frames > 0) {
      text += " for " + std::to_string(in.shape->age_frames) +
              (in.shape->age_frames == 1 ? " frame" : " frames");
    }
    if (in.correspondences) {
      text += kGap + std::to_string(kept_points(*in.correspondences).size()) + " matches";
    }
    if (in.time) {
      char seconds[32];
      std::snprintf(seconds, sizeof seconds, "%.2f s", in.time->t_s);
      text += kGap + std::string(seconds);
    }
    return text;
  }

  cv::Mat still_of(const cv::Mat& canvas) const {
    if (stills_width_px_ == 0 || stills_width_px_ >= canvas.cols) return canvas;
    cv::Mat still;
    const int height = std::max(1, canvas.rows * stills_width_px_ / canvas.cols);
    cv::resize(canvas, still, {stills_width_px_, height}, 0, 0, cv::INTER_AREA);
    return still;
  }

  Result<void> write_still(const cv::Mat& canvas, std::uint64_t frame) const {
    char name[32];
    std::snprintf(name, sizeof name, "%06llu.png", static_cast<unsigned long long>(frame));
    const fs::path path = fs::path(stills_path_) / name;
    std::vector<std::uint8_t> bytes;
    if (!cv::imencode(".png", still_of(canvas), bytes)) {
      return Error{Errc::unsupported, "OpenCV cannot write the frame as PNG", {}};
    }
    std::error_code status;
    fs::create_directories(path.parent_path(), status);  // writing says why it cannot
    return write_whole({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
  }

  std::string path_ = "overlay.avi";
  double fps_ = 30.0;
  int stills_every_ = 0;
  std::string stills_path_ = "{path}";
  int stills_width_px_ = 0;
  bool draw_matches_ = true;
  int line_width_px_ = 1;

  MeshTopology topology_;
  cv::Size frame_size_;
  VideoFile video_;
};

}  // namespace
}  // namespace weft::overlay

using weft::overlay::Overlay;
WEFT_PLUGIN(Overlay, "sinks/overlay", "1.0.0",
            "Writes a video of the frames with the mesh and the kept matches drawn over them.")
