// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/generators/sheet_motion.hpp>
#include <weft/images/image_file.hpp>
#include <weft/sdk/source.hpp>

#include "background.hpp"
#include "common/images/picture_file.hpp"
#include "common/scene/sensor.hpp"
#include "common/scene/sheet_renderer.hpp"
#include "sheet_mesh.hpp"

namespace weft::synthetic {
namespace {

constexpr double kJumpInPeriods = 0.73;

Result<cv::Mat> read_texture(const std::string& path) {
  return image_files::read_pixels("texture", path, image_files::Channels::grey);
}

/// Fails where read_texture() would fail, but does not decode a PNG.
Result<void> check_texture(const std::string& path) {
  const auto file = read_image_bytes(path);
  if (!file) return image_files::at_parameter(file.error(), "texture");
  if (image_files::is_surely_whole(*file)) return {};
  const auto texture = read_texture(path);
  return texture ? Result<void>() : texture.error();
}

/// Renders a textured surface that moves and bends without stretching, with exact ground truth.
class Synthetic final : public Source {
 public:
  static constexpr About kAbout{.produces = "image time ground_truth", .random = true};

  explicit Synthetic(Params& p) {
    p.input_path("texture", texture_path_, "image printed on the surface, from edge to edge",
                 Need::required);
    p.read("width_m", motion_.width_m, "m", {0.001, 1000.0}, "width of the surface");
    p.read("height_m", height_m_, "m", {0.0, 1000.0}, "height of the surface; 0: square texels");
    p.read("frames", frames_, "", {1, 1000000}, "number of frames");
    p.read("fps", fps_, "1/s", {0.001, 10000.0}, "frame rate");
    p.read("image_width_px", camera_.width_px, "px", {16, 8192}, "width of the images");
    p.read("image_height_px", camera_.height_px, "px", {16, 8192}, "height of the images");
    p.read("focal_px", focal_px_, "px", {1.0, 100000.0}, "focal length");
    p.read("distance_m", motion_.distance_m, "m", {0.01, 1000.0},
           "distance from the camera to the centre of the surface");
    p.read("bend_per_m", motion_.bend_per_m, "1/m", {0.0, 1000.0},
           "maximum curvature of the surface");
    p.read("tilt_rad", motion_.tilt_rad, "rad", {0.0, 1.5}, "maximum rotation about each axis");
    p.read("travel_m", motion_.travel_m, "m", {0.0, 1000.0},
           "maximum displacement of the surface to the side");
    p.read("period_s", motion_.period_s, "s", {0.001, 1000000.0}, "duration of one movement");
    p.read("noise_grey", noise_grey_, "grey level", {0.0, 255.0},
           "standard deviation of the pixel noise");
    p.read("cut_frames", cut_frames_, "", {0, 1000000},
           "indices of frames before which the surface jumps to a later pose of its movement");
    p.read("invisible_frames", invisible_frames_, "", {0, 1000000},
           "indices of frames that show only the background; the true shape is where the surface "
           "would be");
    p.read("background_seed", background_seed_, "", {0, 1000000}, "seed of the background");
    p.read("truth_columns", truth_columns_, "", {2, 1000}, "number of true points along the width");
    p.read("truth_rows", truth_rows_, "", {2, 1000}, "number of true points along the height");
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("texture", check_texture(texture_path_));
    mistakes.expect("cut_frames", frame_set("cut_frames", cut_frames_));
    mistakes.expect("invisible_frames", frame_set("invisible_frames", invisible_frames_));
  }

  Result<Camera> open(const Call&) override {
    auto cuts = frame_set("cut_frames", cut_frames_);
    if (!cuts) return cuts.error();
    auto invisible = frame_set("invisible_frames", invisible_frames_);
    if (!invisible) return invisible.error();
    auto texture = read_texture(texture_path_);
    if (!texture) return texture.error();
    cuts_ = *std::move(cuts);
    invisible_ = *std::move(invisible);
    camera_.fx = camera_.fy = focal_px_;
    camera_.cx = 0.5 * static_cast<double>(camera_.width_px - 1);
    camera_.cy = 0.5 * static_cast<double>(camera_.height_px - 1);
    texture_size_ = {texture->cols, texture->rows};
    pitch_m_[0] = motion_.width_m / texture_size_[0];
    pitch_m_[1] = height_m_ > 0.0 ? height_m_ / texture_size_[1] : pitch_m_[0];
    motion_.height_m = pitch_m_[1] * texture_size_[1];
    motion_.centre_m = {0.5 * (motion_.width_m - pitch_m_[0]),
                        0.5 * (motion_.height_m - pitch_m_[1])};
    mesh_.emplace(texture_size_[0], texture_size_[1], pitch_m_);
    auto renderer = scene::SheetRenderer::create(
        camera_, scene::MipTexture(*texture), mesh_->uv_px(), mesh_->faces(),
        draw_background(static_cast<int>(camera_.width_px), static_cast<int>(camera_.height_px),
                        static_cast<std::uint64_t>(background_seed_)));
    if (!renderer) return renderer.error();
    renderer_.emplace(*std::move(renderer));
    constexpr double kNoBlur_px = 0.0;
    sensor_.emplace(kNoBlur_px, noise_grey_);
    return camera_;
  }

  std::int64_t count() const override { return frames_; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    if (!renderer_) return Error{Errc::invalid_value, "the source is not open: open it first"};
    if (index < 0 || index >= frames_) {
      return Error{Errc::invalid_value, "there is no frame " + std::to_string(index) +
                                            ": the source has " + std::to_string(frames_) +
                                            ", counted from 0"};
    }
    auto sheet = motion_.at(clock_s(index));
    if (!sheet) return sheet.error();
    SourceFrame frame;
    frame.image = picture(index, *sheet, call.rng());
    frame.time = Time{static_cast<double>(index) / fps_};
    frame.ground_truth = truth(*sheet);
    return frame;
  }

 private:
  Result<std::set<std::int64_t>> frame_set(const std::string& name,
                                           const std::vector<std::int64_t>& values) const {
    for (const std::int64_t value : values) {
      if (value >= frames_) {
        return Error{Errc::invalid_value, "'" + name + "' holds " + std::to_string(value) +
                                              ", which is no frame: give numbers from 0 to " +
                                              std::to_string(frames_ - 1)};
      }
    }
    return std::set<std::int64_t>(values.begin(), values.end());
  }

  /// Time in the movement of the surface, which each cut advances.
  double clock_s(std::int64_t index) const {
    const auto cuts = std::distance(cuts_.begin(), cuts_.upper_bound(index));
    return static_cast<double>(index) / fps_ +
           kJumpInPeriods * motion_.period_s * static_cast<double>(cuts);
  }

  Image picture(std::int64_t index, const DevelopableSheet& sheet, Rng noise) {
    const scene::View view =
        invisible_.count(index) > 0
            ? renderer_->render_nothing()
            : renderer_->render(mesh_->vertices_m(sheet), room_light(), std::nullopt,
                                scene::SheetRenderer::Scope::pixels);
    Image image;
    std::array<char, 24> stem{};
    std::snprintf(stem.data(), stem.size(), "%06lld", static_cast<long long>(index));
    image.stem = stem.data();
    image.pixels = sensor_->expose(view.image, true, noise);
    return image;
  }

  GroundTruth truth(const DevelopableSheet& sheet) const {
    GroundTruth truth;
    const std::int64_t count = std::int64_t{truth_columns_} * truth_rows_;
    truth.kind = "synthetic";
    truth.template_xy_m = Array<double>({count, 2});
    truth.points_m = Array<double>({count, 3});
    for (std::int64_t k = 0; k < count; ++k) {
      const std::int64_t column = k % truth_columns_, row = k / truth_columns_;
      const auto i = static_cast<double>(column), j = static_cast<double>(row);
      const double x = pitch_m_[0] * (i * texture_size_[0] / (truth_columns_ - 1) - 0.5);
      const double y = pitch_m_[1] * (j * texture_size_[1] / (truth_rows_ - 1) - 0.5);
      truth.template_xy_m.matrix<2>().row(k) << x, y;
      truth.points_m.matrix<3>().row(k) = sheet.at(x, y).transpose();
    }
    return truth;
  }

  std::string texture_path_;
  SheetMotion motion_;
  double height_m_ = 0.0;
  std::int64_t frames_ = 60;
  double fps_ = 30.0;
  double focal_px_ = 820.0;
  double noise_grey_ = 1.5;
  std::vector<std::int64_t> cut_frames_;
  std::vector<std::int64_t> invisible_frames_;
  std::int64_t background_seed_ = 1;
  int truth_columns_ = 15;
  int truth_rows_ = 11;

  Camera camera_{0.0, 0.0, 0.0, 0.0, 640, 480};
  Pitch pitch_m_{};
  std::array<int, 2> texture_size_{};
  std::set<std::int64_t> cuts_;
  std::set<std::int64_t> invisible_;
  std::optional<SheetMesh> mesh_;
  std::optional<scene::SheetRenderer> renderer_;
  std::optional<scene::Sensor> sensor_;
};

}  // namespace
}  // namespace weft::synthetic

using weft::synthetic::Synthetic;
WEFT_PLUGIN(
    Synthetic, "sources/synthetic", "1.0.0",
    "Renders a printed surface that moves and bends without stretching, with exact ground truth.")
