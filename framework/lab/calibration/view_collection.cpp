// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/view_collection.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace weft::calibration {
namespace {

constexpr double kStill_px = 1.5, kNew = 0.3;

/// True if both show the same corners, at about the same positions.
bool is_motionless(const View& before, const View& now) {
  if (before.board_m.rows() != now.board_m.rows() || before.board_m != now.board_m) return false;
  return (before.image_px - now.image_px).rowwise().norm().maxCoeff() < kStill_px;
}

}  // namespace

Result<void> ViewCollection::check_size(const Frame& frame) {
  const ImageSize size{frame.grey.cols, frame.grey.rows};
  if (frames_++ == 0) {
    size_ = size;
    first_ = frame.name;
  }
  if (size == size_) return {};
  return Error{Errc::invalid_data,
               fmt::format("{} has {} x {} px, and {} has {} x {}: calibrate images of one camera, "
                           "in one size, at a time",
                           frame.name, size.width_px, size.height_px, first_, size_.width_px,
                           size_.height_px),
               {}};
}

/// The first, second, fourth and so on: few, whatever the length of a film.
void ViewCollection::keep_unexplained(const Frame& frame) {
  constexpr std::size_t kMost = 6;
  const std::size_t number = ++frames_without_;
  if ((number & (number - 1)) == 0 && unexplained_.size() < kMost) {
    unexplained_.push_back(frame.grey.clone());
  }
}

Result<void> ViewCollection::add(const Frame& frame) {
  if (auto checked = check_size(frame); !checked) return checked;
  auto view = finder_.find(frame.grey, frame.name);
  if (view) {
    views_.push_back(*std::move(view));
  } else {
    without_.push_back({frame.name, view.error().message});
    keep_unexplained(frame);
  }
  return {};
}

Result<bool> ViewCollection::add_if_new(const Frame& frame) {
  if (auto checked = check_size(frame); !checked) return checked.error();
  auto view = finder_.find(frame.grey, frame.name);
  if (!view) {
    keep_unexplained(frame);
    before_.reset();
    last_fault_ = view.error().message;
    return false;
  }
  const bool still = before_ && is_motionless(*before_, *view);
  before_ = *view;
  last_fault_.clear();
  if (!still) return false;
  const Placement now = placement_of(*view, size_);
  const bool known = std::any_of(views_.begin(), views_.end(), [&](const View& kept) {
    return difference(placement_of(kept, size_), now) < kNew;
  });
  if (!known) views_.push_back(*std::move(view));
  return !known;
}

}  // namespace weft::calibration
