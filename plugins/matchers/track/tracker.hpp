// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/view/coarse_search.hpp"
#include "common/view/patch.hpp"
#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"
#include "common/workers/workers.hpp"
#include "motion.hpp"
#include "texture_points.hpp"

namespace weft::track {

/// Level from which on the view is rendered; finer pieces are rendered on demand.
inline constexpr int kFinestDrawn = 2;

/// The state of a point after the search.
enum class Fate {
  found,
  hidden,     ///< its patch is not completely on the surface, in the image and visible
  flat,       ///< its patch has no structure at this size
  unlike,     ///< the image does not look like its patch, or the search did not converge
  uncertain,  ///< its place is not determined well
  astray,     ///< it moved otherwise than the others
};
inline constexpr int kFates = 6;

/// A point that is looked for.
struct Target {
  TexturePoint point;
  bool is_refill = false;  ///< no match of the previous frame
  Fate fate = Fate::hidden;
  Eigen::Vector2d expected_px = Eigen::Vector2d::Zero();  ///< by the predicted view
  Eigen::Vector2d by_px = Eigen::Vector2d::Zero();        ///< found so far from there
  float correlation = 0.0F;                               ///< at the last level it was found in
};

struct TrackerOptions {
  double search_px = 48.0;         ///< [] px, reach of the search for the whole surface
  double min_correlation = 0.8;    ///< []
  double max_deviation_px = 12.0;  ///< [] px
};

/// Finds points of a predicted view in an image, from coarse to fine. It first finds the
/// displacement of the whole surface, then each patch in the image at a quarter of its size. The
/// last search is in the image itself, for patches that were not found there at half its size
/// before. Between the levels an affine field is fitted to the found patches. It predicts the
/// others, and rotates and scales the patches.
class Tracker {
 public:
  /// The same on any number of threads.
  void find(const view::PredictedView& view, const view::Pyramid& image,
            const TrackerOptions& options, int threads, std::vector<Target>& targets);

  /// Shift of the whole surface in the last call.
  const view::CoarseShift& shift() const { return shift_; }
  /// The change of the surface in the image since the prediction by rotation, scale or shear: the
  /// largest stretch of the last affine field.
  double change() const;

 private:
  /// The buffers of a thread.
  struct Bench {
    view::Patch patch;
    view::Samples samples;
  };

  void align(const view::PredictedView& view, const view::Pyramid& image, int level, int threads,
             std::vector<Target>& targets);
  void align(const view::PredictedView& view, const view::Pyramid& image, int level, Bench& bench,
             Target& target, float& deviation_px) const;
  view::Patch::Fit take(const view::PredictedView& view, int level, const Target& target,
                        Bench& bench) const;
  view::Patch::Fit take(const view::PredictedView& view, int level, const Target& target, int dx,
                        int dy, Bench& bench) const;
  void lead(std::vector<Target>& targets, int level);
  void judge(const TrackerOptions& options, std::vector<Target>& targets);

  view::CoarseSearch search_;
  view::CoarseShift shift_;
  Workers workers_;
  std::vector<Bench> benches_;  ///< one for each thread
  Motion motion_;               ///< by the levels so far
  std::vector<Moved> moved_;
  std::vector<double> scratch_;
  std::vector<float> deviations_px_;  ///< deviations of the targets at the finest level
};

}  // namespace weft::track
