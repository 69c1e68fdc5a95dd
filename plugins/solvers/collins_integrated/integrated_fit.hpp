// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

#include "energy.hpp"
#include "mesh_model.hpp"
#include "minimiser.hpp"
#include "texture/line_search.hpp"
#include "texture/samples.hpp"

namespace weft::collins_integrated {

struct FitOptions {
  int samples = 1000;             ///< [] of the texture
  int levels = 3;                 ///< [] of the image
  int rounds = 2;                 ///< [] looks at each level
  int reach_px = 6;               ///< [] px of the level
  double min_zncc = 0.6;          ///< [] of a sample that is found
  double texture_noise_px = 0.5;  ///< [] px, of a sample along its normal
  double outlier = 4.7;           ///< [] standard deviations, of Tukey's loss
  int max_iterations = 5;         ///< [] of a round
  Scales scales;                  ///< but for the loss
};

/// How well a shape explains matches and image, and keeps lengths.
struct Fit {
  double residual_px = 0.0;  ///< [] px, median of the matches; infinite behind the camera, 0: none
  int agreeing = 0;          ///< [] matches within 3 px
  double median_zncc = 0.0;  ///< [] median over the visible samples, where the shape has them
  int in_sight = 0;          ///< [] samples whose patch could be compared
  int turned = 0;            ///< [] samples of faces that show their back or are seen from the side
  int alike = 0;             ///< [] number of visible samples that correlate well enough
  int found = 0;             ///< [] samples of the last look
  int folds = 0;             ///< [] pairs of faces that are turned against each other
  double strain = 0.0;       ///< [] mean |l / l0 - 1| over the edges
  int iterations = 0;        ///< [] factorisations
  double energy = 0.0;       ///< [] at the end

  /// The number of measurements that support the shape.
  int support() const { return agreeing + alike; }
  /// True if nearly all of the object is seen where it should be.
  bool looks_right() const { return in_sight > 0 && alike >= 0.97 * (in_sight + turned); }
};

/// The integrated method fits a shape to the matches of a frame, then, from coarse to fine, to the
/// texture as well. Parts that do not look as they should are placed where the other parts lead,
/// and the search runs once more. The shape with the larger support is kept. Memory is kept between
/// runs; the result depends on the arguments alone.
class IntegratedFit {
 public:
  explicit IntegratedFit(const FitOptions& options) : options_(options) {}

  /// Prepares the data that are the same in all frames of a camera. The mesh must outlive it. Fails
  /// on a mesh that cannot be used.
  Result<void> prepare(const Template& templ, const Camera& camera, const MeshModel& mesh);

  /// Reads the image of a frame.
  void load(const Image& image) { image_.load(image.pixels, options_.levels); }

  /// Moves a finite shape [V,3] m, camera frame. Matches are fitted as they are; the texture is not
  /// looked at where that is not wanted.
  Fit run(bool with_texture, FrameData& frame, Points3& vertices_m);

  /// [V] 1 for vertices of faces with a match or a sample that supports the shape of the last run.
  const std::vector<std::uint8_t>& observed() const { return observed_; }

 private:
  Scales exact_scales() const;
  Scales soft_scales() const;
  void settle(const FrameData& frame, const Scales& scales, int max_iterations, Fit& fit,
              Points3& vertices_m);
  void search_coarse_to_fine(FrameData& frame, Fit& fit, Points3& vertices_m);
  void search_again(FrameData& frame, Fit& fit, Points3& vertices_m);
  bool smooth_once(const FrameData& frame, Fit& fit, Points3& vertices_m);
  void look(int level, const Points3& vertices_m, FrameData& frame, Fit& fit);
  void measure(const FrameData& frame, const Points3& vertices_m, Fit& fit);
  void compare(const FrameData& frame, const Points3& vertices_m, Fit& fit);
  void measure_matches(const FrameData& frame, const Points3& vertices_m, Fit& fit);
  void measure_mesh(const Points3& vertices_m, Fit& fit) const;
  void hold(std::int32_t face);

  FitOptions options_;
  const MeshModel* mesh_ = nullptr;
  Pyramid texture_, image_;
  std::vector<Sample> samples_;
  LineSearch search_;
  Minimiser minimiser_;
  Points3 other_m_;  ///< [V,3]
  std::vector<double> values_;
  std::vector<std::uint8_t> observed_;  ///< [V]
};

}  // namespace weft::collins_integrated
