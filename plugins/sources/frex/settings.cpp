// SPDX-License-Identifier: Apache-2.0
#include "settings.hpp"

#include "common/images/picture_file.hpp"

namespace weft::frex {

void RectangleSettings::read(Params& p) {
  p.input_path("texture", texture_path, "image printed on the surface, from edge to edge",
               Need::required);
  p.read("width_m", width_m, "m", {0.001, 1000.0}, "width of the surface");
  p.read("height_m", height_m, "m", {0.0, 1000.0}, "height of the surface; 0: square texels");
  p.read("columns", columns, "", {3, 400},
         "number of vertices of the simulated mesh along the width");
  p.read("rows", rows, "", {3, 400}, "number of vertices of the simulated mesh along the height");
}

void PatternSettings::read(Params& p) {
  p.choice("pattern", pattern,
           {{"roll", Pattern::roll},
            {"s_bend", Pattern::s_bend},
            {"corner_fold", Pattern::corner_fold},
            {"wave", Pattern::wave},
            {"handles", Pattern::handles},
            {"bulge", Pattern::bulge},
            {"folds", Pattern::folds}},
           "deformation pattern");
  p.read("bend", bend, "", {0.0, 1.5}, "size of the deformation, relative to the usual one");
  p.read("stretch", stretch, "", {0.0, 0.2},
         "maximum elastic strain along the width; 0: no stretching");
}

MotionSettings PatternSettings::with(const SwaySettings& sways) const {
  MotionSettings motion;
  static_cast<SwaySettings&>(motion) = sways;
  motion.pattern = pattern;
  motion.bend = bend;
  motion.stretch = stretch;
  return motion;
}

void Settings::read_camera(Params& p) {
  p.read("frames", frames, "", {1, 10000}, "number of frames");
  p.read("fps", fps, "1/s", {1.0, 1000.0}, "frame rate");
  p.read("image_width_px", camera.width_px, "px", {16, 8192}, "width of the images");
  p.read("image_height_px", camera.height_px, "px", {16, 8192}, "height of the images");
  p.read("focal_px", camera.fx, "px", {1.0, 100000.0}, "focal length");
  p.read("distance_m", sways.distance_m, "m", {0.01, 1000.0},
         "distance from the camera to the centre of the surface");
}

void Settings::read_movement(Params& p) {
  p.read("tilt_rad", sways.tilt_rad, "rad", {0.0, 1.5},
         "maximum rotation of the whole surface about each axis");
  p.read("travel_m", sways.travel_m, "m", {0.0, 1000.0},
         "maximum displacement of the whole surface to the side");
  p.read("period_s", sways.period_s, "s", {0.1, 10000.0}, "time from rest to rest");
}

void Settings::read_looks(Params& p) {
  p.choice("background", background,
           {{"plain", Background::plain},
            {"clutter", Background::clutter},
            {"look_alike", Background::look_alike},
            {"image", Background::image}},
           "background of the surface; plain: empty table; clutter: full table; look_alike: copies "
           "of the texture; image: background_image");
  p.input_path("background_image", background_path, "background image; for background: image");
  p.read("copy_size", copy_size, "", {0.2, 2.0},
         "size of the copies of the texture, relative to the flat surface; for background: "
         "look_alike");
  p.read("occluder", occluder, "arm that hides parts of the surface");
  p.read("invisible_frames", invisible_frames, "", {0, 1000000},
         "indices of frames that show only the background; the true shape is where the surface "
         "would be");
  p.read("cut_frames", cut_frames, "", {0, 1000000},
         "indices of frames before which a part of the video is missing");
  p.read("ambient", ambient, "", {0.0, 1.0}, "share of ambient light");
  p.read("light_drift_rad", light_drift_rad, "rad", {0.0, 0.5},
         "maximum angle by which the light wanders");
  p.read("noise_grey", noise_grey, "grey level", {0.0, 255.0},
         "standard deviation of the pixel noise");
  p.read("blur_px", blur_px, "px", {0.0, 20.0}, "standard deviation of the lens blur");
  degradation.read(p);
  p.read("dense_truth", dense_truth, "depth and template point of each pixel in the ground truth");
  p.read("mask", mask, "exact mask of the surface in each frame");
  std::int64_t seed = 1;
  p.read("seed", seed, "", {0, 9007199254740992.0},
         "seed of movement, light, background and noise, independent of the run's seed");
  sways.seed = static_cast<std::uint64_t>(seed);
}

Result<void> Settings::check_frames(const char* name,
                                    const std::vector<std::int64_t>& values) const {
  for (const std::int64_t value : values) {
    if (value < frames) continue;
    return Error{Errc::invalid_value, std::string("'") + name + "' holds " + std::to_string(value) +
                                          ", which is no frame: give numbers from 0 to " +
                                          std::to_string(frames - 1)};
  }
  return {};
}

Result<void> Settings::check() const {
  if (auto legal = check_frames("cut_frames", cut_frames); !legal) return legal;
  if (auto legal = check_frames("invisible_frames", invisible_frames); !legal) return legal;
  return check_background();
}

void Settings::check(Mistakes& mistakes) const {
  mistakes.expect("cut_frames", check_frames("cut_frames", cut_frames));
  mistakes.expect("invisible_frames", check_frames("invisible_frames", invisible_frames));
  const char* culprit = background_path.empty() ? "background" : "background_image";
  if (mistakes.expect(culprit, check_background()) && background == Background::image) {
    mistakes.expect("background_image",
                    image_files::check_picture("background_image", background_path));
  }
}

Result<void> Settings::check_background() const {
  if ((background == Background::image) != background_path.empty()) return {};
  return Error{Errc::invalid_value,
               background_path.empty()
                   ? "'background: image' needs 'background_image'"
                   : "'background_image' needs 'background: image', or leave it out"};
}

}  // namespace weft::frex
