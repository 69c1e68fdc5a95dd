// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <weft/data/camera.hpp>
#include <weft/data/ground_truth.hpp>

#include "located_sheet.hpp"
#include "sheet_renderer.hpp"

namespace weft::frex_video {

enum class Truth { surface, markers };

struct SceneOptions {
  Truth truth = Truth::surface;
  double truth_spacing_mm = 5.0;
  std::int64_t lighting_seed = 1;
  double ambient = 0.4;  ///< [] share of light without a direction
  double blur_px = 0.5;  ///< px, sigma
};

/// The sheet with its new print, and what is true of it.
struct Scene {
  SheetLayer layer;
  GroundTruth truth;
};

/// Puts a texture on a sheet that was located. The texture is as large as fits on the sheet, in the
/// middle; its texels are square.
class SceneMaker {
 public:
  SceneMaker(const MarkerSheet& sheet, scene::MipTexture texture, const Camera& camera,
             const SceneOptions& options);

  Scene make(const LocatedSheet& sheet, double t_s) const;

  Eigen::Vector2d texture_size_m() const;

 private:
  Eigen::Vector2d texel_at(const Eigen::Vector2d& point_mm) const;
  Eigen::Vector2d point_mm_of(const Eigen::Vector2d& texel) const;
  /// Towards the light, unit, camera frame; it sways slowly.
  Eigen::Vector3d light_at(double t_s) const;
  std::vector<ScreenVertex> mesh(const LocatedSheet& sheet, double t_s) const;
  GroundTruth surface_truth(const LocatedSheet& sheet, const SheetLayer& layer) const;
  GroundTruth marker_truth(const LocatedSheet& sheet) const;
  void add_images(const LocatedSheet& sheet, const SheetLayer& layer, GroundTruth& truth) const;
  bool is_visible(const Eigen::Vector3d& point_m, const Eigen::Vector3d& normal,
                  const SheetLayer& layer) const;

  const MarkerSheet sheet_;
  Pinhole camera_;
  SceneOptions options_;
  double mm_per_px_ = 1.0;
  Eigen::Vector2d corner_mm_;  ///< of the texture on the sheet
  int columns_ = 2;            ///< of the mesh that is drawn
  int rows_ = 2;
  SheetRenderer renderer_;
};

}  // namespace weft::frex_video
