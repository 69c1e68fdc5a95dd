// SPDX-License-Identifier: Apache-2.0
#include "tracker.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/stop_check.hpp>

#include "common/view/beside.hpp"
#include "common/workers/sharing.hpp"

namespace weft::track {
namespace {

constexpr int kFirstLevel = 2;             // where patches are looked for first
constexpr float kAlike = 0.6F;             // [] correlation of a patch that may lead others
constexpr double kFollowsOthers_px = 2.5;  // [px of the level] from the affine field
constexpr float kReach_px = 6.0F;          // [px of the level] half a patch
constexpr float kLargestDeviation_px = 0.35F;

bool is_found(const Target& target) {
  return target.fate == Fate::found && target.correlation >= kAlike;
}

bool is_inside(const Eigen::Vector2d& place_px, const view::Picture& image) {
  return place_px.x() >= 0.0 && place_px.y() >= 0.0 &&
         place_px.x() < static_cast<double>(image.width) &&
         place_px.y() < static_cast<double>(image.height);
}

}  // namespace

void Tracker::find(const view::PredictedView& view, const view::Pyramid& image,
                   const TrackerOptions& options, int threads, std::vector<Target>& targets) {
  shift_ = search_.find(view, image, options.search_px);
  const Eigen::Vector2d shift_px = shift_.by_px();
  for (Target& target : targets) {
    target.expected_px = view.place_px(target.point.face, target.point.weights);
    target.by_px = shift_px;
    target.fate = Fate::hidden;
    target.correlation = 0.0F;
  }
  deviations_px_.resize(targets.size());
  motion_ = Motion(shift_px);
  for (int level = kFirstLevel; level >= 0; --level) {
    align(view, image, level, threads, targets);
    if (level > 0) lead(targets, level);
  }
  judge(options, targets);
}

/// The patch of a target for pixels of a level, at the predicted place of the target. Beside the
/// border of the rendered part it is the nearest piece that was rendered completely.
view::Patch::Fit Tracker::take(const view::PredictedView& view, int level, const Target& target,
                               Bench& bench) const {
  return view::take_beside([&](const view::Aside& aside) {
    return take(view, level, target, aside.dx, aside.dy, bench);
  });
}

/// The patch at this offset, in px of the level.
view::Patch::Fit Tracker::take(const view::PredictedView& view, int level, const Target& target,
                               int dx, int dy, Bench& bench) const {
  const double scale = 1 << level;
  const auto first = [&](double place_px, int aside) {
    return static_cast<int>(std::lround(view::at_level(place_px, level))) - view::Patch::kSide / 2 +
           aside;
  };
  const Eigen::Vector2d& expected_px = target.expected_px;
  if (level >= view.finest()) {
    return bench.patch.take(view.level(level), first(expected_px.x(), dx),
                            first(expected_px.y(), dy));
  }
  const Eigen::Matrix2d to_view = (Eigen::Matrix2d::Identity() + motion_.slope()).inverse();
  const Eigen::Vector2d middle_px = expected_px + to_view * (scale * Eigen::Vector2d(dx, dy));
  if (!view.is_drawn(middle_px, scale * (0.5 * view::Patch::kSide)))
    return view::Patch::Fit::not_drawn;
  const Eigen::Vector2d place_px = expected_px + target.by_px;
  const int x = first(place_px.x(), dx), y = first(place_px.y(), dy);
  const Eigen::Vector2d corner_px =
      scale * Eigen::Vector2d(x - 0.5, y - 0.5) - Eigen::Vector2d::Constant(0.5);  // corner of the
                                                                                   // border
  const view::Lattice lattice{expected_px + to_view * (corner_px - place_px),
                              scale * to_view.col(0), scale * to_view.col(1)};
  view.sample(target.point.face, level, lattice, bench.samples);
  return bench.patch.take(bench.samples, x, y);
}

void Tracker::align(const view::PredictedView& view, const view::Pyramid& image, int level,
                    int threads, std::vector<Target>& targets) {
  constexpr int kShare = 16;  // targets that a thread takes at a time
  const Shares shares{static_cast<int>(targets.size()), kShare, threads};
  if (benches_.size() < to_index(shares.workers())) benches_.resize(to_index(shares.workers()));
  share_out(workers_, shares, [&](int worker, int begin, int end) {
    worked(std::int64_t{100} * kShare * shares.workers());
    for (std::size_t i = to_index(begin); i < to_index(end); ++i) {
      // A point found at a quarter of the size is near enough for the full one.
      if (level > 0 && level < kFirstLevel && is_found(targets[i])) continue;
      align(view, image, level, benches_[to_index(worker)], targets[i], deviations_px_[i]);
    }
    return true;
  });
}

void Tracker::align(const view::PredictedView& view, const view::Pyramid& image, int level,
                    Bench& bench, Target& target, float& deviation_px) const {
  const double scale = 1 << level;
  const bool is_drawn = level >= view.finest();
  target.fate = Fate::hidden;
  if (!is_inside(target.expected_px + target.by_px, image.level(0))) return;
  const view::Patch::Fit fit = take(view, level, target, bench);
  if (fit != view::Patch::Fit::usable) {
    target.fate = fit == view::Patch::Fit::flat ? Fate::flat : Fate::hidden;
    return;
  }
  // A patch of the rendered view begins at the predicted place, and one that was made on demand at
  // the present place.
  const Eigen::Vector2d begin_px = is_drawn ? target.by_px : Eigen::Vector2d(0.0, 0.0);
  const Eigen::Vector2f start = (begin_px / scale).cast<float>();
  const view::Alignment found =
      bench.patch.find_in(image.level(level), start.x(), start.y(), kReach_px);
  target.correlation = found.correlation;
  if (found.end == view::Alignment::End::left_image) return;
  target.fate = found.end == view::Alignment::End::converged ? Fate::found : Fate::unlike;
  if (target.fate != Fate::found) return;
  target.by_px += scale * Eigen::Vector2d(found.dx, found.dy) - begin_px;
  deviation_px = bench.patch.deviation_px(found.correlation);
}

/// Puts those that were not found, or went elsewhere, where the others lead.
void Tracker::lead(std::vector<Target>& targets, int level) {
  moved_.clear();
  for (const Target& target : targets) {
    if (is_found(target)) moved_.push_back({target.expected_px, target.by_px});
  }
  if (moved_.empty()) return;
  const double scale = 1 << level;
  motion_ = Motion::fit(moved_, scale, scratch_);
  for (Target& target : targets) {
    if (!target.expected_px.allFinite()) continue;
    const Eigen::Vector2d led_px = motion_.at(target.expected_px);
    if (is_found(target) && (target.by_px - led_px).norm() < kFollowsOthers_px * scale) continue;
    target.by_px = led_px;
    target.correlation = 0.0F;  // not found yet
  }
}

double Tracker::change() const {
  const Eigen::Matrix2d slope = motion_.slope();
  // The larger singular value of a 2 x 2 matrix.
  const double square = slope.squaredNorm(), area = 2.0 * std::abs(slope.determinant());
  return 0.5 * (std::sqrt(square + area) + std::sqrt(std::max(square - area, 0.0)));
}

void Tracker::judge(const TrackerOptions& options, std::vector<Target>& targets) {
  moved_.clear();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    Target& target = targets[i];
    if (target.fate != Fate::found) continue;
    if (target.correlation < options.min_correlation) {
      target.fate = Fate::unlike;
    } else if (deviations_px_[i] > kLargestDeviation_px) {
      target.fate = Fate::uncertain;
    } else {
      moved_.push_back({target.expected_px, target.by_px});
    }
  }
  if (moved_.empty()) return;
  motion_ = Motion::fit(moved_, 1.0, scratch_);
  for (Target& target : targets) {
    if (target.fate != Fate::found) continue;
    const double off_px = (target.by_px - motion_.at(target.expected_px)).norm();
    if (off_px > options.max_deviation_px) target.fate = Fate::astray;
  }
}

}  // namespace weft::track
