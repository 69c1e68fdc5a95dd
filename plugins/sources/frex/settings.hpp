// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/mistakes.hpp>
#include <weft/core/params.hpp>
#include <weft/data/camera.hpp>

#include "choreography.hpp"
#include "degradation.hpp"

namespace weft::frex {

enum class Background { plain, clutter, look_alike, image };

/// The parameters of a rectangular surface.
struct RectangleSettings {
  std::string texture_path;
  double width_m = 0.297;
  double height_m = 0.0;
  int columns = 64;
  int rows = 41;

  /// Declares or reads all of them.
  void read(Params& p);
};

/// The parameters of a film, for any surface.
struct Settings {
  std::int64_t frames = 60;
  double fps = 30.0;
  Camera camera{820.0, 820.0, 0.0, 0.0, 640, 480};
  MotionSettings motion;
  Background background = Background::plain;
  std::string background_path;
  double copy_size = 0.55;
  bool occluder = false;
  std::vector<std::int64_t> invisible_frames;
  std::vector<std::int64_t> cut_frames;
  double ambient = 0.45;
  double light_drift_rad = 0.2;
  double noise_grey = 2.0;
  double blur_px = 0.5;
  DegradationSettings degradation;
  bool dense_truth = true;
  bool mask = false;

  /// Declares or reads all of them.
  void read(Params& p);
  /// Checks the rules that a range cannot express: returns the first error, or all of them and
  /// those of the files.
  Result<void> check() const;
  void check(Mistakes& mistakes) const;

 private:
  Result<void> check_frames(const char* name, const std::vector<std::int64_t>& values) const;
  Result<void> check_background() const;
};

}  // namespace weft::frex
