// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/source.hpp>
#include <weft/sdk/template_builder.hpp>

#include "arm.hpp"
#include "backdrop.hpp"
#include "common/images/picture_file.hpp"
#include "common/scene/random_stream.hpp"
#include "common/scene/sensor.hpp"
#include "common/scene/sheet_renderer.hpp"
#include "degradation.hpp"
#include "exact_mask.hpp"
#include "lamp.hpp"
#include "rest_sheet.hpp"
#include "settings.hpp"
#include "sheet_film.hpp"

namespace weft::frex {
namespace {

constexpr std::uint64_t kNoiseStream = 6;
constexpr std::int64_t kCutAway = 25;  // frames of the film that a cut skips

bool holds(const std::vector<std::int64_t>& frames, std::int64_t index) {
  return std::find(frames.begin(), frames.end(), index) != frames.end();
}

/// The objects that are ready once the source is open.
struct Studio {
  scene::SheetRenderer renderer;
  Pinhole pinhole;
  SheetFilm film;
  Lamp lamp;
  std::optional<Arm> arm;
  scene::Sensor sensor;
  bool is_grey;
  Eigen::RowVector2d pitch_m;  ///< size of a texel
  Array<double> flat_m;        ///< [V,2] m, template frame
  Array<std::int32_t> faces;
};

/// The filmed object.
struct PrintedSheet {
  scene::MipTexture print;
  RestSheet sheet;
};

/// A simulated textured surface, ray-cast, with the ground truth of each pixel and vertex.
class SheetSource : public Source {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Shetab-Bushehri et al., ROBUSfT (2023), section IV; XPBD: Macklin et al. 2016",
      .produces = "image time ground_truth object_mask"};

  void check(Mistakes& mistakes) const { settings_.check(mistakes); }

  Result<Camera> open(const Call& call) override {
    if (auto legal = settings_.check(); !legal) return legal.error();
    Camera camera = settings_.camera;
    camera.fy = camera.fx;
    camera.cx = 0.5 * static_cast<double>(camera.width_px - 1);
    camera.cy = 0.5 * static_cast<double>(camera.height_px - 1);
    auto printed = make_sheet(call);
    if (!printed) return printed.error();
    auto studio = furnish(camera, *std::move(printed));
    if (!studio) return studio.error();
    studio_.emplace(*std::move(studio));
    return camera;
  }

  std::int64_t count() const override { return settings_.frames; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    if (!studio_) return Error{Errc::invalid_value, "the source is not open: open it first"};
    if (index < 0 || index >= settings_.frames) {
      return Error{Errc::invalid_value, "there is no frame " + std::to_string(index) +
                                            ": the source has " + std::to_string(settings_.frames) +
                                            ", counted from 0"};
    }
    const std::int64_t moment = index + kCutAway * cuts_until(index);
    std::optional<Movement> movement;
    if (settings_.degradation.needs_movement()) {
      auto around = movement_at(moment, call);
      if (!around) return around.error();
      movement.emplace(*std::move(around));
    }
    const auto state = studio_->film.at(moment, call);
    if (!state) return state.error();
    scene::View view = look(index, static_cast<double>(moment) / settings_.fps, **state, movement);
    auto image = picture(index, movement, view.image);
    if (!image) return image.error();
    SourceFrame frame;
    frame.image = *std::move(image);
    frame.time = Time{static_cast<double>(index) / settings_.fps};
    frame.ground_truth = truth(**state, view);
    if (settings_.mask) frame.object_mask = exact_mask(view);
    return frame;
  }

 protected:
  /// Reads the parameters that all surfaces have.
  void read_settings(Params& p) { settings_.read(p); }
  virtual Result<PrintedSheet> make_sheet(const Call& call) const = 0;

 private:
  Result<Studio> furnish(const Camera& camera, PrintedSheet&& printed) const {
    const Settings& s = settings_;
    auto& [print, sheet] = printed;
    const bool is_grey = print.is_grey();
    const double pitch_m = sheet.pitch_m.x();
    auto backdrop = make_backdrop(camera, print, pitch_m);
    if (!backdrop) return backdrop.error();
    Picture behind = is_grey ? scene::without_colour(*std::move(backdrop)) : *std::move(backdrop);
    auto film = SheetFilm::create(s.motion, sheet, s.fps);
    if (!film) return film.error();
    auto renderer = scene::SheetRenderer::create(camera, std::move(print), sheet.uv_px, sheet.faces,
                                                 std::move(behind));
    if (!renderer) return renderer.error();
    std::optional<Arm> arm;
    if (s.occluder) arm.emplace(camera, s.motion.distance_m, s.motion.period_s, s.motion.seed);
    return Studio{*std::move(renderer),
                  Pinhole{camera.fx, camera.fy, camera.cx, camera.cy},
                  *std::move(film),
                  Lamp(s.ambient, s.light_drift_rad, s.motion.period_s, s.motion.seed),
                  arm,
                  scene::Sensor(s.blur_px, s.noise_grey),
                  is_grey,
                  sheet.pitch_m,
                  make_array<double>(sheet.flat_m()),
                  make_array<std::int32_t>(sheet.faces)};
  }

  Result<Picture> make_backdrop(const Camera& camera, const scene::MipTexture& print,
                                double pitch_m) const {
    const std::uint64_t seed = settings_.motion.seed;
    if (settings_.background == Background::plain) return plain_backdrop(camera, seed);
    if (settings_.background == Background::clutter) return cluttered_backdrop(camera, seed);
    if (settings_.background == Background::look_alike) {
      const double pitch_px =
          settings_.copy_size * pitch_m * camera.fx / settings_.motion.distance_m;
      return look_alike_backdrop(camera, print, pitch_px, seed);
    }
    const auto wall = image_files::read_picture("background_image", settings_.background_path);
    if (!wall) return wall.error();
    return picture_backdrop(camera, scene::MipTexture(*wall));
  }

  std::int64_t cuts_until(std::int64_t index) const {
    return std::count_if(settings_.cut_frames.begin(), settings_.cut_frames.end(),
                         [&](std::int64_t cut) { return cut <= index; });
  }

  /// The surface of a frame and of those beside it; before the first one it moves as after it.
  Result<Movement> movement_at(std::int64_t moment, const Call& call) {
    std::array<Points3, 3> places;
    for (std::int64_t k = 0; k < 3; ++k) {
      const auto state = studio_->film.at(std::max(moment + k - 1, std::int64_t{0}), call);
      if (!state) return state.error();
      places[to_index(k)] = (*state)->vertices_m;
    }
    if (moment == 0) places[0] = 2.0 * places[1] - places[2];
    return Movement{std::move(places[0]), std::move(places[1]), std::move(places[2]),
                    1.0 / settings_.fps};
  }

  scene::View look(std::int64_t index, double t_s, const SheetState& state,
                   const std::optional<Movement>& movement) {
    if (holds(settings_.invisible_frames, index)) return studio_->renderer.render_nothing();
    std::optional<scene::Solid> arm;
    if (studio_->arm) arm = studio_->arm->at(t_s);
    const DegradationSettings& worse = settings_.degradation;
    const Points3 vertices_m =
        worse.readout_s > 0.0
            ? as_read(studio_->pinhole, settings_.camera.height_px, worse.readout_s, *movement)
            : state.vertices_m;
    scene::View view = studio_->renderer.render(vertices_m, studio_->lamp.at(t_s), std::move(arm));
    if (worse.hand_share > 0.0) {
      cover_by_hand(worse.hand_share, studio_->is_grey,
                    project_points(studio_->pinhole, vertices_m), view);
    }
    return view;
  }

  Result<Image> picture(std::int64_t index, const std::optional<Movement>& movement,
                        scene::Picture& light) const {
    const DegradationSettings& worse = settings_.degradation;
    if (worse.motion_blur_px > 0.0) {
      blur_along(worse.motion_blur_px * direction_of(studio_->pinhole, *movement), light);
    }
    if (worse.exposure_stops > 0.0) {
      const auto gain = static_cast<float>(exposure_gain(worse.exposure_stops, index));
      for (scene::Colour& colour : light.pixels) colour *= gain;
    }
    Image image;
    std::array<char, 24> stem{};
    std::snprintf(stem.data(), stem.size(), "%06lld", static_cast<long long>(index));
    image.stem = stem.data();
    image.pixels = studio_->sensor.expose(light, studio_->is_grey,
                                          scene::random_stream(settings_.motion.seed, kNoiseStream,
                                                               static_cast<std::uint64_t>(index)));
    if (worse.jpeg_quality > 0) {
      if (auto kept = compress(worse.jpeg_quality, image.pixels); !kept) return kept.error();
    }
    return image;
  }

  GroundTruth truth(const SheetState& state, const scene::View& view) const {
    GroundTruth truth;
    truth.kind = "frex";
    truth.template_xy_m = studio_->flat_m;
    truth.points_m = make_array<double>(state.vertices_m);
    truth.faces = studio_->faces;
    truth.visible = Array<std::uint8_t>({truth.count()});
    std::copy(view.is_visible.begin(), view.is_visible.end(), truth.visible.data());
    truth.diag.set("edge_strain", state.residual_strain);
    truth.diag.set("stretch_mean", state.true_strain.mean);
    truth.diag.set("stretch_max", state.true_strain.max);
    if (!settings_.dense_truth) return truth;
    truth.depth_m = view.depth_m;
    truth.uv_m = view.uv_px;
    for (std::int64_t y = 0; y < truth.uv_m.rows(); ++y) {
      ask_to_go_on();
      float* row = truth.uv_m.row(y);
      for (std::int64_t x = 0; x < truth.uv_m.dim(1); ++x) {
        row[2 * x] *= static_cast<float>(studio_->pitch_m.x());
        row[2 * x + 1] *= static_cast<float>(studio_->pitch_m.y());
      }
    }
    return truth;
  }

  Settings settings_;
  std::optional<Studio> studio_;
};

/// A rectangular surface that its texture fills.
class Frex final : public SheetSource {
 public:
  explicit Frex(Params& p) {
    rectangle_.read(p);
    read_settings(p);
  }

  void check(Mistakes& mistakes) const {
    mistakes.expect("texture", image_files::check_picture("texture", rectangle_.texture_path));
    SheetSource::check(mistakes);
  }

 private:
  Result<PrintedSheet> make_sheet(const Call&) const override {
    const auto picture = image_files::read_picture("texture", rectangle_.texture_path);
    if (!picture) return picture.error();
    scene::MipTexture print(*picture);
    auto sheet = rectangle(print, rectangle_.width_m, rectangle_.height_m, rectangle_.columns,
                           rectangle_.rows);
    if (!sheet) return sheet.error();
    return PrintedSheet{std::move(print), *std::move(sheet)};
  }

  RectangleSettings rectangle_;
};

/// The object of a template: of any outline, flat or curved at rest.
class FrexObject final : public SheetSource {
 public:
  explicit FrexObject(Params& p) {
    p.component("object", object_,
                "template of the filmed object; a mesh finer than the tracked one gives finer "
                "ground truth");
    read_settings(p);
  }

 private:
  Result<PrintedSheet> make_sheet(const Call& call) const override {
    const auto templ = object_.build(call);
    if (!templ) return templ.error();
    auto sheet = sheet_of(*templ);
    if (!sheet) return sheet.error();
    const auto& texture = templ->texture;
    const cv::Mat picture(static_cast<int>(texture.dim(0)), static_cast<int>(texture.dim(1)),
                          texture.ndim() == 3 ? CV_8UC3 : CV_8UC1,
                          const_cast<std::uint8_t*>(texture.data()));
    return PrintedSheet{scene::MipTexture(picture), *std::move(sheet)};
  }

  TemplateComponent object_{"templates/outline"};
};

}  // namespace
}  // namespace weft::frex

using weft::frex::Frex;
using weft::frex::FrexObject;
WEFT_LIBRARY(
    WEFT_COMPONENT(Frex, "sources/frex", "1.0.0",
                   "Simulates a printed sheet of paper or cloth in front of a camera, with dense "
                   "exact ground truth."),
    WEFT_COMPONENT(
        FrexObject, "sources/frex_object", "1.0.0",
        "Simulates a flat or curved object, given as a template, in the same way as sources/frex."))
