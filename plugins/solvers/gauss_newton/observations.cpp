// SPDX-License-Identifier: Apache-2.0
#include "observations.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/check_sightlines.hpp>

#include "common/seen/hidden_faces.hpp"

namespace weft::gauss_newton {
namespace {

Error mistake(const std::string& what, std::int64_t i, const std::string& problem) {
  return {Errc::invalid_data, what + " " + std::to_string(i) + " " + problem};
}

}  // namespace

Result<void> ObservationReader::read(const SolverInput& in, const MeshModel& mesh,
                                     const ObservationOptions& options, FrameData& frame) {
  frame.camera = {in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy};
  read_.clear();
  hidden_.clear();
  if (!in.sightlines && !in.correspondences) {
    return Error{Errc::invalid_data, "needs 'correspondences' or 'sightlines'"};
  }
  if (in.visibility) {
    if (auto found =
            solvers::read_hidden_faces(*in.visibility, mesh.faces, mesh.vertex_count(), hidden_);
        !found)
      return found;
  }
  const bool takes_matches = in.correspondences && options.data != Data::sightlines;
  const bool takes_lines = in.sightlines && (options.data != Data::matches || !takes_matches);
  if (takes_matches) {
    auto added = add_matches(*in.correspondences, mesh, options);
    if (!added) return added;
  }
  if (takes_lines) {
    auto added = add_sightlines(*in.sightlines, mesh, options.sightline_noise_px);
    if (!added) return added;
  }
  sort(mesh, frame);
  return {};
}

Result<void> ObservationReader::add_matches(const Correspondences& matches, const MeshModel& mesh,
                                            const ObservationOptions& options) {
  const Whitening alike = Whitening::of_deviation(options.match_noise_px);
  const double noise2 = options.covariance_noise_px * options.covariance_noise_px;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    worked_in_loop(i, 3);
    const std::int32_t face = matches.face(i);
    if (matches.kept(i) == 0 || face < 0) continue;
    if (face >= mesh.faces.rows()) {
      return mistake("match", i,
                     "lies in face " + std::to_string(face) + " of a template with " +
                         std::to_string(mesh.faces.rows()) + ": use one template throughout");
    }
    Observation seen;
    const double* weights = matches.barycentrics.row(i);
    std::copy_n(weights, 3, seen.weights.begin());
    seen.seen_px = {matches.image_px(i, 0), matches.image_px(i, 1)};
    seen.white = alike;
    if (matches.covariance_px2.present()) {
      const auto white = Whitening::of_measured(matches.covariance_px2.row(i), noise2);
      if (!white) return mistake("match", i, "has no positive definite covariance: leave it out");
      seen.white = *white;
    }
    const double sum = weights[0] + weights[1] + weights[2] + seen.seen_px[0] + seen.seen_px[1];
    if (!std::isfinite(sum)) return mistake("match", i, "is not finite: leave it out");
    add(face, seen);
  }
  return {};
}

Result<void> ObservationReader::add_sightlines(const Sightlines& lines, const MeshModel& mesh,
                                               double noise_px) {
  auto checked = check_sightlines(lines, mesh.vertex_count(), mesh.faces.rows());
  if (!checked) return checked;
  for (std::int64_t i = 0; i < lines.count(); ++i) {
    worked_in_loop(i, 3);
    if (lines.weight(i) == 0.0) continue;
    const std::int32_t vertex = lines.vertex(i);
    if (vertex >= 0 && mesh.faces_at[vertex].empty()) continue;
    Observation seen;
    const std::int32_t face = vertex >= 0 ? mesh.faces_at[vertex].front() : lines.face(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::int64_t>(k);
      const double at_vertex = mesh.faces(face, corner) == vertex ? 1.0 : 0.0;
      seen.weights[k] = vertex >= 0 ? at_vertex : lines.barycentrics(i, corner);
    }
    seen.seen_px = {lines.pixel_px(i, 0), lines.pixel_px(i, 1)};
    seen.white = Whitening::of_deviation(noise_px / std::sqrt(lines.weight(i)));
    if (!std::isfinite(seen.seen_px[0] + seen.seen_px[1])) {
      return mistake("sightline", i, "has no finite pixel");
    }
    add(face, seen);
  }
  return {};
}

/// Sorts by face, and keeps the order within it.
void ObservationReader::sort(const MeshModel& mesh, FrameData& frame) {
  next_.assign(to_index(mesh.faces.rows()) + 1, 0);
  for (const Read& each : read_) ++next_[to_index(each.face) + 1];
  frame.faces.clear();
  for (std::size_t f = 0; f + 1 < next_.size(); ++f) {
    const std::size_t first = next_[f], count = next_[f + 1];
    next_[f + 1] = first + count;
    if (count > 0) frame.faces.push_back({static_cast<std::int32_t>(f), first, first + count});
  }
  frame.observations.resize(read_.size());
  for (const Read& each : read_) frame.observations[next_[to_index(each.face)]++] = each.seen;
}

Sightlines sightlines_of(const FrameData& frame, const Faces& faces) {
  const auto count = static_cast<std::int64_t>(frame.faces.size());
  Sightlines lines;
  lines.vertex = Array<std::int32_t>({count});
  lines.face = Array<std::int32_t>({count});
  lines.barycentrics = Array<double>({count, 3});
  lines.pixel_px = Array<double>({count, 2});
  lines.ray = Array<double>({count, 3});
  lines.weight = Array<double>({count});
  lines.coverage = static_cast<double>(count) / static_cast<double>(faces.rows());
  const auto centrality = [](const Observation& seen) {
    return *std::min_element(seen.weights.begin(), seen.weights.end());
  };
  for (std::int64_t i = 0; i < count; ++i) {
    const SeenFace& seen = frame.faces[to_index(i)];
    std::size_t best = seen.first;
    for (std::size_t k = seen.first; k < seen.end; ++k) {
      if (centrality(frame.observations[k]) > centrality(frame.observations[best])) best = k;
    }
    const Observation& central = frame.observations[best];
    lines.vertex(i) = -1;
    lines.face(i) = seen.face;
    lines.weight(i) = 1.0;
    std::copy(central.weights.begin(), central.weights.end(), lines.barycentrics.row(i));
    std::copy(central.seen_px.begin(), central.seen_px.end(), lines.pixel_px.row(i));
    const Eigen::Vector2d pixel(central.seen_px[0], central.seen_px[1]);
    lines.ray.matrix<3>().row(i) = unit_ray(frame.camera, pixel).transpose();
  }
  return lines;
}

}  // namespace weft::gauss_newton
