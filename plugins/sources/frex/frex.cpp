// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <utility>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/sdk/source.hpp>

#include "arm.hpp"
#include "backdrop.hpp"
#include "common/picture_file.hpp"
#include "common/random_stream.hpp"
#include "common/sensor.hpp"
#include "common/sheet_renderer.hpp"
#include "lamp.hpp"
#include "settings.hpp"
#include "sheet_film.hpp"

namespace weft::frex {
namespace {

constexpr std::uint64_t kNoiseStream = 6;
constexpr std::int64_t kCutAway = 25;  // frames of the film that a cut leaves out

bool holds(const std::vector<double>& frames, std::int64_t index) {
  return std::find(frames.begin(), frames.end(), static_cast<double>(index)) != frames.end();
}

/// The texel of each vertex [V,2] px of a grid from edge to edge of the print.
Points2 grid_px(int columns, int rows, const sources::MipTexture& print) {
  Points2 uv_px(Eigen::Index{columns} * rows, 2);
  for (Eigen::Index v = 0; v < uv_px.rows(); ++v) {
    const Eigen::Index i = v % columns, j = v / columns;
    uv_px.row(v) << static_cast<double>(i) * print.width() / (columns - 1) - 0.5,
        static_cast<double>(j) * print.height() / (rows - 1) - 0.5;
  }
  return uv_px;
}

/// What is ready once the source is open.
struct Studio {
  sources::SheetRenderer renderer;
  SheetFilm film;
  Lamp lamp;
  std::optional<Arm> arm;
  sources::Sensor sensor;
  bool is_grey;
  Eigen::RowVector2d pitch_m;  ///< size of a texel
  Array<double> flat_m;        ///< [V,2] m, template frame
  Array<std::int32_t> faces;
};

/// A simulated printed sheet, ray-cast, with everything known about each pixel and vertex.
class Frex final : public Source {
 public:
  static constexpr About kAbout{
      .reference = "Shetab-Bushehri et al., ROBUSfT (2023), section IV; XPBD: Macklin et al. 2016",
      .produces = "image time ground_truth"};

  explicit Frex(Params& p) { settings_.read(p); }

  Result<Camera> open(const Call&) override {
    if (auto legal = settings_.check(); !legal) return legal.error();
    Camera camera = settings_.camera;
    camera.fy = camera.fx;
    camera.cx = 0.5 * static_cast<double>(camera.width_px - 1);
    camera.cy = 0.5 * static_cast<double>(camera.height_px - 1);
    const auto print = sources::read_picture("texture", settings_.texture_path);
    if (!print) return print.error();
    auto studio = furnish(camera, sources::MipTexture(*print));
    if (!studio) return studio.error();
    studio_.emplace(*std::move(studio));
    return camera;
  }

  std::int64_t count() const override { return settings_.frames; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    if (!studio_) return Error{Errc::invalid_value, "the source is not open: open it first", {}};
    if (index < 0 || index >= settings_.frames) {
      return Error{Errc::invalid_value,
                   "there is no frame " + std::to_string(index) + ": the source has " +
                       std::to_string(settings_.frames) + ", counted from 0",
                   {}};
    }
    const std::int64_t moment = index + kCutAway * cuts_until(index);
    const auto state = studio_->film.at(moment, call);
    if (!state) return state.error();
    const sources::View view = look(index, static_cast<double>(moment) / settings_.fps, **state);
    SourceFrame frame;
    frame.image = picture(index, view);
    frame.time = Time{static_cast<double>(index) / settings_.fps};
    frame.ground_truth = truth(**state, view);
    return frame;
  }

 private:
  Result<Studio> furnish(const Camera& camera, sources::MipTexture print) const {
    const Settings& s = settings_;
    const bool is_grey = print.is_grey();
    const double pitch_m = s.width_m / print.width();
    const Eigen::RowVector2d pitch(pitch_m,
                                   s.height_m > 0.0 ? s.height_m / print.height() : pitch_m);
    const Points2 uv_px = grid_px(s.columns, s.rows, print);
    const Points2 flat_m = uv_px.array().rowwise() * pitch.array();
    const auto faces = rectangular_grid_faces(s.columns, s.rows);
    if (!faces) return faces.error();
    auto backdrop = make_backdrop(camera, print, pitch_m);
    if (!backdrop) return backdrop.error();
    Picture behind = is_grey ? sources::without_colour(*std::move(backdrop)) : *std::move(backdrop);
    auto film = SheetFilm::create(s.motion, s.columns, s.rows, flat_m, s.fps);
    if (!film) return film.error();
    auto renderer =
        sources::SheetRenderer::create(camera, std::move(print), uv_px, *faces, std::move(behind));
    if (!renderer) return renderer.error();
    std::optional<Arm> arm;
    if (s.occluder) arm.emplace(camera, s.motion.distance_m, s.motion.period_s, s.motion.seed);
    return Studio{*std::move(renderer),
                  *std::move(film),
                  Lamp(s.ambient, s.light_drift_rad, s.motion.period_s, s.motion.seed),
                  arm,
                  sources::Sensor(s.blur_px, s.noise_grey),
                  is_grey,
                  pitch,
                  make_array<double>(flat_m),
                  make_array<std::int32_t>(*faces)};
  }

  Result<Picture> make_backdrop(const Camera& camera, const sources::MipTexture& print,
                                double pitch_m) const {
    const std::uint64_t seed = settings_.motion.seed;
    if (settings_.background == Background::plain) return plain_backdrop(camera, seed);
    if (settings_.background == Background::clutter) return cluttered_backdrop(camera, seed);
    if (settings_.background == Background::look_alike) {
      const double pitch_px = pitch_m * camera.fx / settings_.motion.distance_m;
      return look_alike_backdrop(camera, print, pitch_px, seed);
    }
    const auto wall = sources::read_picture("background_image", settings_.background_path);
    if (!wall) return wall.error();
    return picture_backdrop(camera, sources::MipTexture(*wall));
  }

  std::int64_t cuts_until(std::int64_t index) const {
    return std::count_if(settings_.cut_frames.begin(), settings_.cut_frames.end(),
                         [&](double cut) { return cut <= static_cast<double>(index); });
  }

  sources::View look(std::int64_t index, double t_s, const SheetState& state) {
    if (holds(settings_.invisible_frames, index)) return studio_->renderer.render_nothing();
    std::optional<sources::Solid> arm;
    if (studio_->arm) arm = studio_->arm->at(t_s);
    return studio_->renderer.render(state.vertices_m, studio_->lamp.at(t_s), std::move(arm));
  }

  Image picture(std::int64_t index, const sources::View& view) const {
    Image image;
    std::array<char, 24> stem{};
    std::snprintf(stem.data(), stem.size(), "%06lld", static_cast<long long>(index));
    image.stem = stem.data();
    image.pixels =
        studio_->sensor.expose(view.image, studio_->is_grey,
                               sources::random_stream(settings_.motion.seed, kNoiseStream,
                                                      static_cast<std::uint64_t>(index)));
    return image;
  }

  GroundTruth truth(const SheetState& state, const sources::View& view) const {
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

}  // namespace
}  // namespace weft::frex

using weft::frex::Frex;
WEFT_PLUGIN(Frex, "sources/frex", "1.0.0",
            "Simulates a printed sheet of paper or cloth before a camera, with dense exact truth.")
