// SPDX-License-Identifier: Apache-2.0
#include "quadrilaterals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <weft/core/stop_check.hpp>

namespace weft::photo {
namespace {

constexpr double kLeastShare = 0.08;        // share of the image that the surface covers
constexpr double kLeastTurn = 0.5;          // sine: corners of 30 to 150 degrees
constexpr double kMostConvergence = 0.707;  // cosine: opposite sides within 45 degrees

/// Where two lines meet; not finite where they are nearly parallel.
Eigen::Vector2d meeting(const StraightLine& a, const StraightLine& b) {
  const double turn = cross(a.direction, b.direction);
  if (std::abs(turn) < kLeastTurn) {
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return a.point + cross(b.point - a.point, b.direction) / turn * a.direction;
}

/// For clockwise corners.
bool is_convex(const Corners& p) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (!(cross(p[k] - p[(k + 3) % 4], p[(k + 1) % 4] - p[k]) > 0.0)) return false;
  }
  return true;
}

/// All pairs of lines that meet in the image.
class Meetings {
 public:
  Meetings(const std::vector<StraightLine>& lines, const Eigen::Vector2d& whole_px,
           double beside_px)
      : count_(lines.size()), places_(count_ * count_) {
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < count_; ++k) {
        const Eigen::Vector2d place = meeting(lines[i], lines[k]);
        meet_.push_back(i != k && place.allFinite() && is_within(place, whole_px, beside_px) ? 1
                                                                                             : 0);
        places_[i * count_ + k] = place;
      }
    }
  }
  bool meet(std::size_t i, std::size_t k) const { return meet_[i * count_ + k] != 0; }
  const Eigen::Vector2d& at(std::size_t i, std::size_t k) const { return places_[i * count_ + k]; }

 private:
  std::size_t count_;
  std::vector<Eigen::Vector2d> places_;
  std::vector<std::uint8_t> meet_;
};

/// See Quadrilateral; 0 where a side has too few edges, or too many corners have none.
double merit_of(const Quadrilateral& shape, const std::vector<StraightLine>& lines, double area,
                const Needed& needed) {
  constexpr double kArm = 0.15, kLeastOfArm = 0.3;  // share of a side, next to its corners
  double sum = 0.0;
  std::array<int, 4> arms{};  // number of arms of each corner along which there are edges
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    const StraightLine& line = lines[shape.lines[k]];
    const Eigen::Vector2d &from = shape.corners_px[k], &to = shape.corners_px[next];
    const double covered = line.covered(from, to);
    if (covered < needed.share_of_side) return 0.0;
    sum += covered;
    arms[k] += line.covered(from, from + kArm * (to - from)) >= kLeastOfArm ? 1 : 0;
    arms[next] += line.covered(to, to + kArm * (from - to)) >= kLeastOfArm ? 1 : 0;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const bool is_border = needed.one_side_from && shape.lines[k] >= *needed.one_side_from;
    if (is_border && (arms[k] < 2 || arms[(k + 1) % 4] < 2)) return 0.0;
  }
  return std::count(arms.begin(), arms.end(), 2) >= needed.corners ? 0.25 * sum * area : 0.0;
}

bool has_one_side_from(std::optional<std::size_t> first, const Quadrilateral& shape) {
  return !first || std::count_if(shape.lines.begin(), shape.lines.end(),
                                 [&](std::size_t line) { return line >= *first; }) == 1;
}

/// Keeps the best of what is shown to it, in order.
class Best {
 public:
  explicit Best(std::size_t most) : most_(most) {}

  double least() const { return kept_.size() < most_ ? 0.0 : kept_.back().merit; }
  void add(const Quadrilateral& shape) {
    const auto at = std::upper_bound(
        kept_.begin(), kept_.end(), shape,
        [](const Quadrilateral& a, const Quadrilateral& b) { return a.merit > b.merit; });
    kept_.insert(at, shape);
    if (kept_.size() > most_) kept_.pop_back();
  }
  std::vector<Quadrilateral> take() { return std::move(kept_); }

 private:
  std::size_t most_;
  std::vector<Quadrilateral> kept_;
};

}  // namespace

bool is_within(const Eigen::Vector2d& place_px, const Eigen::Vector2d& whole_px, double beside_px) {
  return place_px.minCoeff() >= -beside_px && (place_px - whole_px).maxCoeff() <= beside_px;
}

std::array<StraightLine, 4> borders_of(const Eigen::Vector2d& whole_px) {
  std::array<StraightLine, 4> borders;
  for (std::size_t k = 0; k < 4; ++k) {
    const bool is_level = k < 2;
    borders[k].direction = is_level ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
    if (k % 2 == 1) borders[k].point = whole_px;
    const double length = whole_px.maxCoeff();
    borders[k].stretches.emplace_back(-length - 1.0, length + 1.0);
  }
  return borders;
}

std::vector<Quadrilateral> find_quadrilaterals(const std::vector<StraightLine>& lines,
                                               const Eigen::Vector2d& whole_px, std::size_t most,
                                               const Needed& needed) {
  const Meetings meetings(lines, whole_px, needed.beside_px);
  const double least_area = kLeastShare * whole_px.prod();
  Best best(most);
  const auto is_pair = [&](std::size_t a, std::size_t b) {
    return std::abs(lines[a].direction.dot(lines[b].direction)) >= kMostConvergence;
  };
  std::vector<std::size_t> across;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      if (!is_pair(i, j)) continue;
      across.clear();
      for (std::size_t k = 0; k < lines.size(); ++k) {
        if (meetings.meet(i, k) && meetings.meet(j, k)) across.push_back(k);
      }
      worked(static_cast<std::int64_t>(across.size() * across.size()));
      for (std::size_t a = 0; a < across.size(); ++a) {
        for (std::size_t b = a + 1; b < across.size(); ++b) {
          const std::size_t k = across[a], l = across[b];
          if (k < i || !is_pair(k, l)) continue;  // else the same four were looked at before
          Quadrilateral shape;
          shape.lines = {i, k, j, l};
          if (!has_one_side_from(needed.one_side_from, shape)) continue;
          shape.corners_px = {meetings.at(i, l), meetings.at(i, k), meetings.at(j, k),
                              meetings.at(j, l)};
          double area = signed_area_px2(shape.corners_px);
          if (area < 0.0) {
            std::reverse(shape.corners_px.begin() + 1, shape.corners_px.end());
            std::reverse(shape.lines.begin(), shape.lines.end());
            area = -area;
          }
          if (area <= std::max(least_area, best.least())) continue;
          if (!is_convex(shape.corners_px)) continue;
          shape.merit = merit_of(shape, lines, area, needed);
          if (shape.merit > best.least()) best.add(shape);
        }
      }
    }
  }
  return best.take();
}

}  // namespace weft::photo
