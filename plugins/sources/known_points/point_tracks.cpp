// SPDX-License-Identifier: Apache-2.0
#include "point_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>

namespace weft::known_points {

PointTracks::Track& PointTracks::track_of(const PointRow& row) {
  const auto found = std::find_if(tracks_.begin(), tracks_.end(), [&](const Track& track) {
    return track.vertex == row.vertex && track.template_xy_m == row.template_xy_m;
  });
  if (found != tracks_.end()) return *found;
  return tracks_.emplace_back(Track{row.vertex, row.template_xy_m, {}});
}

Result<void> PointTracks::add(const PointRow& row) {
  const auto mistake = [](const std::string& message) {
    return Error{Errc::invalid_data, message};
  };
  if (!empty() && row.by_frame != by_frame_) {
    return mistake("mixes 'time_s' and 'frame': use one in all rows");
  }
  if (!empty() && row.moment < newest_) {
    return mistake("goes back from " + std::to_string(newest_) + " to " +
                   std::to_string(row.moment) + ": sort the rows");
  }
  Track& track = track_of(row);
  if (!track.samples.empty() && track.samples.back().moment == row.moment) {
    return mistake("gives the same point twice at " + std::to_string(row.moment));
  }
  by_frame_ = row.by_frame;
  newest_ = row.moment;
  track.samples.push_back({row.moment, row.point_m, row.radius_m});
  return {};
}

std::optional<PointTracks::Sample> PointTracks::Track::at(double moment, double tolerance) const {
  const auto after = std::upper_bound(samples.begin(), samples.end(), moment,
                                      [](double m, const Sample& s) { return m < s.moment; });
  const auto is_near = [&](const Sample& s) { return std::abs(s.moment - moment) <= tolerance; };
  const bool has_after = after != samples.end() && is_near(*after);
  const bool has_before = after != samples.begin() && is_near(*(after - 1));
  if (!has_before) return has_after ? std::optional(*after) : std::nullopt;
  const Sample& before = *(after - 1);
  if (!has_after) return before;
  const double share = (moment - before.moment) / (after->moment - before.moment);
  return Sample{moment, (1.0 - share) * before.point_m + share * after->point_m,
                std::max(before.radius_m, after->radius_m)};
}

std::optional<KnownPoints> PointTracks::at(double moment) const {
  std::vector<std::pair<const Track*, Sample>> found;
  for (const Track& track : tracks_) {
    if (const auto sample = track.at(moment, tolerance())) found.emplace_back(&track, *sample);
  }
  if (found.empty()) return std::nullopt;
  const auto count = static_cast<std::int64_t>(found.size());
  KnownPoints known{Array<std::int32_t>({count}), Array<double>({count, 3}), Array<double>({count}),
                    Array<double>({count, 2})};
  for (std::int64_t p = 0; p < count; ++p) {
    const auto& [track, sample] = found[to_index(p)];
    known.vertex(p) = track->vertex;
    known.points_m.matrix<3>().row(p) = sample.point_m.transpose();
    known.radius_m(p) = sample.radius_m;
    known.template_xy_m.matrix<2>().row(p) = track->template_xy_m.transpose();
  }
  return known;
}

void PointTracks::forget_before(double moment) {
  for (Track& track : tracks_) {
    const auto useless = [&](const Sample& s) { return s.moment < moment - tolerance(); };
    const auto first = std::find_if_not(track.samples.begin(), track.samples.end(), useless);
    track.samples.erase(track.samples.begin(), first);
  }
}

}  // namespace weft::known_points
