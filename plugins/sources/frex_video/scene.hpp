// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/ground_truth.hpp>

#include "common/scene/sheet_renderer.hpp"
#include "located_sheet.hpp"

namespace weft::frex_video {

enum class Truth { surface, markers };

struct SceneOptions {
  Truth truth = Truth::surface;
  double truth_spacing_mm = 5.0;
  std::int64_t lighting_seed = 1;
  double ambient = 0.4;  ///< [] share of light without a direction
  double blur_px = 0.5;  ///< px, sigma
};

/// The surface with its new texture, and its ground truth.
struct Scene {
  cv::Mat4f layer;  ///< [H,W] BGR grey levels times coverage, and the coverage, 0 to 1
  GroundTruth truth;
};

/// Puts a texture on a sheet of paper that was located. The texture is as large as fits on the
/// paper, in the middle; its texels are square. Around it the paper is white, and so is its back.
class SceneMaker {
 public:
  /// Fails where Embree cannot be started.
  static Result<SceneMaker> create(const MarkerSheet& sheet, scene::MipTexture texture,
                                   const Camera& camera, const SceneOptions& options);

  Scene make(const LocatedSheet& sheet, double t_s);

  Eigen::Vector2d texture_size_m() const;

 private:
  /// The place of the texture on the paper.
  struct Place {
    double mm_per_px = 1.0;
    Eigen::Vector2d corner_mm = Eigen::Vector2d::Zero();

    Eigen::Vector2d texel_at(const Eigen::Vector2d& point_mm) const;
    Eigen::Vector2d point_mm_of(const Eigen::Vector2d& texel) const;
  };

  SceneMaker(const MarkerSheet& sheet, const Place& place, const Camera& camera,
             const SceneOptions& options, Points2 mesh_mm, scene::SheetRenderer renderer);
  /// Towards the light, unit, camera frame; it sways slowly.
  Eigen::Vector3d light_at(double t_s) const;
  Points3 vertices_m(const LocatedSheet& sheet) const;
  cv::Mat4f layer_of(const scene::View& view) const;
  GroundTruth surface_truth(const LocatedSheet& sheet, const scene::View& view) const;
  GroundTruth marker_truth(const LocatedSheet& sheet) const;
  void add_images(const LocatedSheet& sheet, const scene::View& view, GroundTruth& truth) const;
  bool is_visible(const Eigen::Vector3d& point_m, const Eigen::Vector3d& normal,
                  const scene::View& view) const;

  MarkerSheet sheet_;
  Pinhole camera_;
  SceneOptions options_;
  Place place_;
  Points2 mesh_mm_;  ///< [V,2] mm, rendered vertices, on the paper
  scene::SheetRenderer renderer_;
};

}  // namespace weft::frex_video
