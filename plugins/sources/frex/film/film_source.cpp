// SPDX-License-Identifier: Apache-2.0
#include "film/film_source.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>
#include <weft/core/index.hpp>

#include "common/images/picture_file.hpp"
#include "common/scene/random_stream.hpp"
#include "exact_mask.hpp"

namespace weft::frex {
namespace {

constexpr std::uint64_t kNoiseStream = 6;
constexpr std::int64_t kCutAway = 25;  // frames of the film that a cut skips

bool holds(const std::vector<std::int64_t>& frames, std::int64_t index) {
  return std::find(frames.begin(), frames.end(), index) != frames.end();
}

}  // namespace

Result<Camera> FilmSource::open(const Call& call) {
  if (auto legal = settings_.check(); !legal) return legal.error();
  Camera camera = settings_.camera;
  camera.fy = camera.fx;
  camera.cx = 0.5 * static_cast<double>(camera.width_px - 1);
  camera.cy = 0.5 * static_cast<double>(camera.height_px - 1);
  auto subject = make_subject(call);
  if (!subject) return subject.error();
  auto studio = furnish(camera, *std::move(subject));
  if (!studio) return studio.error();
  studio_.emplace(*std::move(studio));
  return camera;
}

Result<SourceFrame> FilmSource::read(std::int64_t index, const Call& call) {
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
  const auto state = studio_->film->at(moment, call);
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

Result<FilmSource::Studio> FilmSource::furnish(const Camera& camera, Subject&& subject) const {
  const Settings& s = settings_;
  const bool is_grey = subject.print.is_grey();
  auto backdrop = make_backdrop(camera, subject.print, subject.pitch_m.x());
  if (!backdrop) return backdrop.error();
  Picture behind = is_grey ? scene::without_colour(*std::move(backdrop)) : *std::move(backdrop);
  auto renderer = scene::SheetRenderer::create(camera, std::move(subject.print), subject.uv_px,
                                               subject.faces, std::move(behind));
  if (!renderer) return renderer.error();
  std::optional<Arm> arm;
  if (s.occluder) arm.emplace(camera, s.sways.distance_m, s.sways.period_s, s.sways.seed);
  const Points2 flat_m =
      subject.uv_px.topRows(subject.truth_points).array().rowwise() * subject.pitch_m.array();
  return Studio{*std::move(renderer),
                Pinhole{camera.fx, camera.fy, camera.cx, camera.cy},
                std::move(subject.film),
                Lamp(s.ambient, s.light_drift_rad, s.sways.period_s, s.sways.seed),
                arm,
                scene::Sensor(s.blur_px, s.noise_grey),
                is_grey,
                {make_array<double>(flat_m), make_array<std::int32_t>(subject.truth_faces),
                 subject.pitch_m, s.dense_truth}};
}

Result<Picture> FilmSource::make_backdrop(const Camera& camera, const scene::MipTexture& print,
                                          double pitch_m) const {
  const std::uint64_t seed = settings_.sways.seed;
  if (settings_.background == Background::plain) return plain_backdrop(camera, seed);
  if (settings_.background == Background::clutter) return cluttered_backdrop(camera, seed);
  if (settings_.background == Background::look_alike) {
    const double pitch_px = settings_.copy_size * pitch_m * camera.fx / settings_.sways.distance_m;
    return look_alike_backdrop(camera, print, pitch_px, seed);
  }
  const auto wall = image_files::read_picture("background_image", settings_.background_path);
  if (!wall) return wall.error();
  return picture_backdrop(camera, scene::MipTexture(*wall));
}

std::int64_t FilmSource::cuts_until(std::int64_t index) const {
  return std::count_if(settings_.cut_frames.begin(), settings_.cut_frames.end(),
                       [&](std::int64_t cut) { return cut <= index; });
}

/// The surface of a frame and of those beside it; before the first one it moves as after it.
Result<Movement> FilmSource::movement_at(std::int64_t moment, const Call& call) {
  std::array<Points3, 3> places;
  for (std::int64_t k = 0; k < 3; ++k) {
    const auto state = studio_->film->at(std::max(moment + k - 1, std::int64_t{0}), call);
    if (!state) return state.error();
    places[to_index(k)] = (*state)->vertices_m;
  }
  if (moment == 0) places[0] = 2.0 * places[1] - places[2];
  return Movement{std::move(places[0]), std::move(places[1]), std::move(places[2]),
                  1.0 / settings_.fps};
}

scene::View FilmSource::look(std::int64_t index, double t_s, const FilmState& state,
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
    cover_by_hand(worse.hand_share, studio_->is_grey, project_points(studio_->pinhole, vertices_m),
                  view);
  }
  return view;
}

Result<Image> FilmSource::picture(std::int64_t index, const std::optional<Movement>& movement,
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
  image.pixels = studio_->sensor.expose(
      light, studio_->is_grey,
      scene::random_stream(settings_.sways.seed, kNoiseStream, static_cast<std::uint64_t>(index)));
  if (worse.jpeg_quality > 0) {
    if (auto kept = compress(worse.jpeg_quality, image.pixels); !kept) return kept.error();
  }
  return image;
}

GroundTruth FilmSource::truth(const FilmState& state, const scene::View& view) const {
  GroundTruth truth = truth_of(studio_->truth, state.vertices_m, view);
  if (state.residual_strain) truth.diag.set("edge_strain", *state.residual_strain);
  truth.diag.set("stretch_mean", state.true_strain.mean);
  truth.diag.set("stretch_max", state.true_strain.max);
  return truth;
}

}  // namespace weft::frex
