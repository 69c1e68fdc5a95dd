// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/mistakes.hpp>
#include <weft/core/params.hpp>
#include <weft/data/camera.hpp>

#include "choreography.hpp"
#include "degradation.hpp"
#include "film/sways.hpp"

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

/// The parameters of a pattern.
struct PatternSettings {
  Pattern pattern = MotionSettings{}.pattern;
  double bend = MotionSettings{}.bend;
  double stretch = MotionSettings{}.stretch;

  /// Declares or reads all of them.
  void read(Params& p);
  MotionSettings with(const SwaySettings& sways) const;
};

/// The parameters of a film, for any object.
struct Settings {
  std::int64_t frames = 60;
  double fps = 30.0;
  Camera camera{820.0, 820.0, 0.0, 0.0, 640, 480};
  SwaySettings sways;
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

  /// Declares or reads them in the order of the tables: `read_deformation` does so with those of
  /// the deformation in between.
  template <class ReadDeformation>
  void read(Params& p, const ReadDeformation& read_deformation) {
    read_camera(p);
    read_deformation(p);
    read_movement(p);
    read_looks(p);
  }
  /// Checks the rules that a range cannot express: returns the first error, or all of them and
  /// those of the files.
  Result<void> check() const;
  void check(Mistakes& mistakes) const;

 private:
  void read_camera(Params& p);
  void read_movement(Params& p);
  void read_looks(Params& p);
  Result<void> check_frames(const char* name, const std::vector<std::int64_t>& values) const;
  Result<void> check_background() const;
};

}  // namespace weft::frex
