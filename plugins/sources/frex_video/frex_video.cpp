// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/sdk/source.hpp>

#include "common/images/picture_file.hpp"
#include "layout_file.hpp"
#include "scene.hpp"

namespace weft::frex_video {
namespace {

enum class Background { original, white, image };

/// Converts recorded frames of a sheet of paper with markers into frames of the same paper with
/// another texture.
class FrexVideo final : public Source {
 public:
  static constexpr About kAbout{.reference =
                                    "paper: Shetab-Bushehri et al., ROBUSfT, arXiv:2301.04037 "
                                    "(2023), section IV; Garrido-Jurado et "
                                    "al., Pattern Recognition 47 (2014)",
                                .produces = "image time ground_truth",
                                .random = true};

  explicit FrexVideo(Params& p) {
    p.component("frames", frames_, "source of the recorded frames");
    p.input_path("layout", layout_path_,
                 "layout file of the printed markers, stored beside the PDF", Need::required);
    p.input_path("texture", texture_path_, "image that is rendered onto the surface",
                 Need::required);
    p.choice("background", background_,
             {{"original", Background::original},
              {"white", Background::white},
              {"image", Background::image}},
             "background of the surface; original: as recorded; white: empty; image: "
             "'background_image'");
    p.input_path("background_image", background_path_, "image around the surface");
    p.read("min_markers", min_markers_, "", {4, 250},
           "number of markers below which a frame is omitted");
    p.read("max_marker_error_px", locate_.max_marker_error_px, "px", {0.1, 1000.0},
           "distance from the warp of the other markers above which a marker is rejected");
    p.choice("truth", scene_.truth, {{"surface", Truth::surface}, {"markers", Truth::markers}},
             "true points; surface: points of the surface fitted to all markers; markers: each "
             "marker by itself");
    p.read("truth_spacing_mm", scene_.truth_spacing_mm, "mm", {0.5, 100.0},
           "spacing of the points of the true surface");
    p.read("lighting_seed", scene_.lighting_seed, "", {0, 1e15},
           "seed of the position of the light");
    p.read("ambient", scene_.ambient, "", {0.0, 1.0}, "share of light without direction");
    p.read("blur_px", scene_.blur_px, "px", {0.0, 20.0},
           "standard deviation of the blur of the rendered texture");
    p.read("noise_grey", noise_grey_, "grey level", {0.0, 255.0},
           "standard deviation of the noise of the rendered texture");
  }

  void check(Mistakes& mistakes) const {
    const auto layout = read_layout_file(layout_path_);
    if (mistakes.expect("layout", layout)) mistakes.expect("min_markers", check_count(*layout));
    mistakes.expect("texture", image_files::check_picture("texture", texture_path_));
    const char* culprit = background_path_.empty() ? "background" : "background_image";
    if (mistakes.expect(culprit, check_background()) && background_ == Background::image) {
      mistakes.expect("background_image",
                      image_files::check_picture("background_image", background_path_));
    }
  }

  Result<Camera> open(const Call& call) override {
    maker_.reset();
    auto layout = read_layout_file(layout_path_);
    if (!layout) return layout.error();
    locate_.min_markers = to_index(min_markers_);
    if (auto enough = check_count(*layout); !enough) return enough.error();
    const auto texture = image_files::read_picture("texture", texture_path_);
    if (!texture) return texture.error();
    auto camera = frames_.open(call);
    if (!camera) return camera.error();
    const auto count = frames_.count(call);
    if (!count) return count.error();
    count_ = *count;
    if (auto ready = make_background(*camera); !ready) return ready.error();
    pinhole_ = {camera->fx, camera->fy, camera->cx, camera->cy};
    auto maker = SceneMaker::create(*layout, scene::MipTexture(*texture), *camera, scene_);
    if (!maker) return maker.error();
    maker_.emplace(*std::move(maker));
    finder_.emplace(*std::move(layout));
    const Eigen::Vector2d size_m = maker_->texture_size_m();
    call.log_info(fmt::format("the texture is {:.6f} m wide and {:.6f} m high on the page",
                              size_m.x(), size_m.y()));
    return camera;
  }

  std::int64_t count() const override { return count_.frames; }
  bool live() const override { return count_.live != 0; }

  /// A frame in which the markers are not found has no image and no ground truth. It is degenerate
  /// rather than no_result, which would end a video.
  Result<SourceFrame> read(std::int64_t, const Call& call) override {
    if (!maker_) return Error{Errc::invalid_value, "the source is not open: open it first"};
    const auto recorded = frames_.read(call);
    if (!recorded) return recorded.error();
    SourceFrame frame;
    frame.time = recorded->time;
    if (!recorded->image) return degenerate(std::move(frame), "there is no recorded image");
    const cv::Mat pixels = view(recorded->image->pixels);
    cv::Mat grey = pixels, colour = pixels;
    if (pixels.channels() == 3) cv::cvtColor(pixels, grey, cv::COLOR_BGR2GRAY);
    if (pixels.channels() == 1) cv::cvtColor(pixels, colour, cv::COLOR_GRAY2BGR);
    const auto sheet = locate_sheet(*finder_, grey, pinhole_, locate_);
    if (!sheet && sheet.error().code != Errc::no_result) return sheet.error();
    if (!sheet) return degenerate(std::move(frame), sheet.error().message);
    const double t_s = frame.time ? frame.time->t_s : 0.0;
    Scene scene = maker_->make(*sheet, t_s);
    frame.image = compose(scene.layer, colour, call.rng());
    frame.image->stem = recorded->image->stem;
    frame.ground_truth = std::move(scene.truth);
    call.log_info(
        fmt::format("{} markers, leave-one-out {:.2f} px, reprojection {:.2f} px, strain "
                    "{:.3f} %",
                    sheet->warp.markers.size(), sheet->warp.leave_one_out_px,
                    sheet->surface.rms_px(), 100.0 * sheet->surface.rms_strain()));
    return frame;
  }

 private:
  /// The pixels without a copy.
  static cv::Mat view(const Array<std::uint8_t>& pixels) {
    return {static_cast<int>(pixels.dim(0)), static_cast<int>(pixels.dim(1)),
            pixels.ndim() == 2 ? CV_8UC1 : CV_8UC3, const_cast<std::uint8_t*>(pixels.data()),
            to_index(pixels.row_stride())};
  }

  Result<void> check_count(const MarkerSheet& layout) const {
    if (layout.markers.size() >= to_index(min_markers_)) return {};
    return Error{Errc::invalid_value,
                 fmt::format("{}: has {} markers, but 'min_markers' is {}: lower that",
                             layout_path_, layout.markers.size(), min_markers_)};
  }

  Result<void> check_background() const {
    if ((background_ == Background::image) != background_path_.empty()) return {};
    return Error{Errc::invalid_value,
                 "'background: image' and 'background_image' go together: give both or neither"};
  }

  Result<void> make_background(const Camera& camera) {
    const cv::Size size(static_cast<int>(camera.width_px), static_cast<int>(camera.height_px));
    if (auto legal = check_background(); !legal) return legal;
    if (background_ == Background::white) behind_ = cv::Mat(size, CV_8UC3, cv::Scalar::all(255));
    if (background_ != Background::image) return {};
    const auto picture = image_files::read_picture("background_image", background_path_);
    if (!picture) return picture.error();
    cv::resize(*picture, behind_, size, 0.0, 0.0, cv::INTER_AREA);
    if (behind_.channels() == 1) cv::cvtColor(behind_, behind_, cv::COLOR_GRAY2BGR);
    return {};
  }

  /// The rendered paper over its background. The recorded part has its noise already.
  Image compose(const cv::Mat4f& layer, const cv::Mat& recorded, Rng noise) const {
    const bool keep = background_ == Background::original;
    const cv::Mat3b behind = keep ? recorded : behind_;
    Image image;
    image.pixels = Array<std::uint8_t>({behind.rows, behind.cols, 3});
    cv::Mat3b result(behind.rows, behind.cols, reinterpret_cast<cv::Vec3b*>(image.pixels.data()));
    for (int y = 0; y < behind.rows; ++y) {
      ask_to_go_on();
      for (int x = 0; x < behind.cols; ++x) {
        const cv::Vec4f& ink = layer(y, x);
        const float coverage = ink[3];
        const double sigma = noise_grey_ * (keep ? coverage : 1.0);
        for (int c = 0; c < 3; ++c) {
          const double value = ink[c] + (1.0 - coverage) * behind(y, x)[c] +
                               (sigma > 0.0 ? sigma * noise.normal() : 0.0);
          result(y, x)[c] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
        }
      }
    }
    return image;
  }

  SourceComponent frames_{"sources/video"};
  std::string layout_path_;
  std::string texture_path_;
  Background background_ = Background::original;
  std::string background_path_;
  int min_markers_ = 30;
  LocateOptions locate_;
  SceneOptions scene_;
  double noise_grey_ = 2.0;

  Count count_;
  Pinhole pinhole_;
  cv::Mat behind_;
  std::optional<MarkerFinder> finder_;
  std::optional<SceneMaker> maker_;
};

}  // namespace
}  // namespace weft::frex_video

using weft::frex_video::FrexVideo;
WEFT_PLUGIN(FrexVideo, "sources/frex_video", "1.0.0",
            "Renders a texture onto a recorded page of ArUco markers, with 2D and 3D ground truth.")
