// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/known_points.hpp>

#include "point_row.hpp"

namespace weft::known_points {

/// The rows of each point of the surface in the order of time.
class PointTracks {
 public:
  /// A frame ignores rows further than `tolerance_s` in time.
  explicit PointTracks(double tolerance_s) : tolerance_s_(tolerance_s) {}

  /// Fails where rows go back, a point is given twice at a moment, and times are mixed with frames.
  Result<void> add(const PointRow& row);

  bool empty() const { return tracks_.empty(); }
  /// True if rows have frame numbers instead of times; meaningless while there are none.
  bool by_frame() const { return by_frame_; }
  /// The last row's; meaningless while there are none.
  double newest() const { return newest_; }

  /// The points at a moment, in the order of their first rows. With frame numbers, the rows of that
  /// frame. With times, the interpolation of the rows before and after if both are within the
  /// tolerance, else the one that is. Nothing if no point has such a row.
  std::optional<KnownPoints> at(double moment) const;

  /// Drops rows that no moment from this one on needs.
  void forget_before(double moment);

 private:
  struct Sample {
    double moment;
    Eigen::Vector3d point_m;
    double radius_m;
  };
  struct Track {
    std::int32_t vertex;
    Eigen::Vector2d template_xy_m;
    std::vector<Sample> samples;

    std::optional<Sample> at(double moment, double tolerance) const;
  };

  double tolerance() const { return by_frame_ ? 0.0 : tolerance_s_; }
  Track& track_of(const PointRow& row);

  double tolerance_s_;
  bool by_frame_ = false;
  double newest_ = 0.0;
  std::vector<Track> tracks_;
};

}  // namespace weft::known_points
