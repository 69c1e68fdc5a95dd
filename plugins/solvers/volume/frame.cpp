// SPDX-License-Identifier: Apache-2.0
#include "frame.hpp"

#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/known_surface.hpp>

#include "common/seen/image_line.hpp"

namespace weft::volume {
namespace {

Error mistake(std::int64_t match, const std::string& problem) {
  return {Errc::invalid_data, "match " + std::to_string(match) + " " + problem};
}

}  // namespace

Result<void> Frame::read(const SolverInput& in, const SolidModel& body) {
  data.camera = {in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy};
  data.observations.clear();
  data.known.clear();
  data.outline.clear();
  seen.clear();
  observed.assign(to_index(body.vertices_m().rows()), 0);
  if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
  if (auto read = read_matches(*in.correspondences, body); !read) return read;
  if (data.observations.size() < to_index(options.min_matches)) {
    return no_result("too few matches: " + std::to_string(data.observations.size()) +
                     " kept on the object of at least " + std::to_string(options.min_matches));
  }
  if (solvers::lie_on_a_line(data.observations,
                             [](const Observation& each) { return each.seen_px; })) {
    return no_result("the matches lie on a line of the image, or in one place");
  }
  if (in.object_mask) {
    if (auto read = data.outline.read(*in.object_mask, in.camera); !read) return read;
  }
  if (!in.known_points) return {};
  return read_known(*in.known_points, in.templ, body);
}

Result<void> Frame::read_matches(const Correspondences& matches, const SolidModel& body) {
  const auto alike = solvers::Whitening::of_deviation(options.match_noise_px);
  const double noise2_px2 = options.covariance_noise_px * options.covariance_noise_px;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    worked_in_loop(i, 10);
    const std::int32_t face = matches.face(i);
    if (matches.kept(i) == 0 || face < 0) continue;
    if (face >= body.faces().rows()) {
      return mistake(i, "lies in face " + std::to_string(face) + " of a template with " +
                            std::to_string(body.faces().rows()) + ": use one template throughout");
    }
    solvers::SeenPoint point;
    point.weights = matches.barycentrics.matrix<3>().row(i).transpose();
    point.seen_px = matches.image_px.matrix<2>().row(i).transpose();
    if (!point.weights.allFinite() || !point.seen_px.allFinite()) {
      return mistake(i, "is not finite: leave it out");
    }
    Observation observation{body.point_of(face, point.weights), point.seen_px, alike};
    if (matches.covariance_px2.present()) {
      const auto white = solvers::Whitening::of_measured(matches.covariance_px2.row(i), noise2_px2);
      if (!white) return mistake(i, "has no positive definite covariance: leave it out");
      observation.white = *white;
    }
    for (int k = 0; k < 3; ++k) {
      point.corners[to_index(k)] = body.faces()(face, k);
      observed[to_index(body.faces()(face, k))] = 1;
    }
    seen.push_back(point);
    data.observations.push_back(observation);
  }
  return {};
}

Result<void> Frame::read_known(const KnownPoints& known, const Template& templ,
                               const SolidModel& body) {
  const auto points = known_surface_points(known, templ, options.known_radius_m);
  if (!points) return points.error();
  for (const KnownSurfacePoint& each : *points) {
    const BodyPoint at =
        each.vertex >= 0
            ? body.vertices()[to_index(each.vertex)]
            : body.point_of(each.face, {each.weights[0], each.weights[1], each.weights[2]});
    data.known.push_back({at, each.centre_m, each.radius_m});
    for (const std::int32_t v : each.vertices) observed[to_index(v)] = 1;
  }
  return {};
}

}  // namespace weft::volume
