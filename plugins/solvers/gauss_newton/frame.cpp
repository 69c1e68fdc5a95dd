// SPDX-License-Identifier: Apache-2.0
#include "frame.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <weft/core/index.hpp>

#include "common/hidden_bend.hpp"
#include "common/known_spheres.hpp"
#include "common/seen/image_line.hpp"

namespace weft::gauss_newton {
namespace {

constexpr int kFewestMatches = 10;  // with less the object is lost

/// Where the matches are wired, too few of them mean that the object is lost.
Result<void> check_match_count(const SolverInput& in) {
  if (!in.correspondences) return {};
  const Array<std::uint8_t>& kept = in.correspondences->kept;
  const auto count = kept.rows() - std::count(kept.data(), kept.data() + kept.rows(), 0);
  if (count >= kFewestMatches) return {};
  return no_result("lost: " + std::to_string(count) + " matches of at least " +
                   std::to_string(kFewestMatches));
}

/// Vertices that something hides or that are outside of the image. Unconfirmed ones may be visible.
std::vector<std::uint8_t> covered_vertices(const Visibility& visibility) {
  std::vector<std::uint8_t> covered(to_index(visibility.visible.rows()));
  for (std::int64_t v = 0; v < visibility.visible.rows(); ++v) {
    const SightReason reason = visibility.why(v);
    covered[to_index(v)] = reason == SightReason::hidden || reason == SightReason::outside ? 1 : 0;
  }
  return covered;
}

}  // namespace

Result<void> Frame::read_mask(const SolverInput& in, const MeshModel& mesh) {
  data.outline.clear();
  data.covered.clear();
  if (!in.object_mask) return {};
  if (in.visibility && in.visibility->visible.rows() == mesh.vertex_count()) {
    data.covered = covered_vertices(*in.visibility);
  }
  return data.outline.read(*in.object_mask, in.camera);
}

Result<void> Frame::read(const SolverInput& in, const MeshModel& mesh) {
  is_outline_alone = false;
  if (auto read = read_mask(in, mesh); !read) return read;
  Result<void> read = read_observations(in, mesh);
  const bool is_alone =
      !read && (read.error().code == Errc::no_result || (!in.correspondences && !in.sightlines));
  if (!is_alone || !options.outline_alone || !data.outline.present()) return read;
  data.observations.clear();
  data.faces.clear();
  data.spheres.clear();
  observed.assign(to_index(mesh.vertex_count()), 0);
  hidden.clear();
  inconsistent_pairs = 0;
  is_outline_alone = true;
  return {};
}

Result<void> Frame::read_observations(const SolverInput& in, const MeshModel& mesh) {
  if (auto read = reader_.read(in, mesh, options.seen, data); !read) return read;
  if (data.observations.size() < to_index(options.min_sightlines)) {
    return no_result("too few points seen: " + std::to_string(data.observations.size()) +
                     " of at least " + std::to_string(options.min_sightlines));
  }
  if (auto enough = check_match_count(in); !enough) return enough;
  const auto place_px = [](const Observation& seen) -> Eigen::Vector2d {
    return Eigen::Map<const Eigen::Vector2d>(seen.seen_px.data());
  };
  if (solvers::lie_on_a_line(data.observations, place_px)) {
    return no_result("the points seen lie on a line of the image, or in one place");
  }
  observed.assign(to_index(mesh.vertex_count()), 0);
  for (const SeenFace& seen : data.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      bool is_observed = false;
      for (std::size_t i = seen.first; i < seen.end && !is_observed; ++i) {
        is_observed = data.observations[i].weights[k] != 0.0;
      }
      const std::int32_t v = mesh.faces(seen.face, static_cast<Eigen::Index>(k));
      if (is_observed) observed[to_index(v)] = 1;
    }
  }
  if (auto found = find_hidden(in, mesh); !found) return found;
  data.spheres.clear();
  inconsistent_pairs = 0;
  if (!in.known_points) return {};
  auto spheres = known_surface_points(*in.known_points, in.templ, options.known_radius_m);
  if (!spheres) return spheres.error();
  data.spheres = *std::move(spheres);
  inconsistent_pairs = solvers::make_consistent(mesh.at_rest(), data.spheres);
  for (const KnownSurfacePoint& known : data.spheres) {
    for (const std::int32_t v : known.vertices) observed[to_index(v)] = 1;
  }
  return {};
}

Result<void> Frame::find_hidden(const SolverInput& in, const MeshModel& mesh) {
  hidden.clear();
  if (in.visibility && options.continue_hidden_bend) {
    auto part = solvers::hidden_part(*in.visibility, observed, mesh.neighbours);
    if (!part) return part.error();
    hidden = *std::move(part);
    if (!mesh.is_flat) solvers::add_unmeasured(observed, hidden);
  }
  if (options.continue_uncovered_bend) {
    solvers::add_uncovered(observed, mesh.neighbours, mesh.border, hidden);
  }
  return {};
}

}  // namespace weft::gauss_newton
