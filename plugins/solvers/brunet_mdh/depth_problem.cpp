// SPDX-License-Identifier: Apache-2.0
#include "depth_problem.hpp"

#include <algorithm>
#include <utility>

#include "at.hpp"
#include "distance_graph.hpp"

namespace weft::brunet_mdh {
namespace {

constexpr double kReachable = 1.001;
constexpr double kLeastReach_m = 1e-6;

/// A known point that is one of the points is tied to it; any other one is a separate place.
void tie_to_itself(std::size_t known, DepthProblem& problem) {
  const auto& points = problem.points;
  const auto same = std::find(points.begin(), points.end(), problem.given[problem.seen + known]);
  if (same == points.end()) {
    problem.unseen.push_back(known);
  } else {
    problem.ties.push_back({static_cast<std::int32_t>(same - points.begin()), known, 0.0});
  }
}

}  // namespace

DepthProblem make_problem(const RestSurface& surface, std::vector<SurfacePoint> given,
                          std::size_t seen, int rings) {
  const auto edges = distance_graph(surface, given, rings);
  const auto parts = connected_parts(edges, static_cast<std::int32_t>(given.size()));
  std::vector<int> sizes(given.size() + 1, 0);
  for (const std::int32_t part : parts) ++sizes[at(part)];
  const auto largest = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
  DepthProblem problem{seen, std::move(given), {}, {}, {}, {}, {}};
  std::vector<std::int32_t> number(parts.size(), -1);
  for (std::size_t i = 0; i < seen; ++i) {
    if (parts[i] != largest) continue;
    number[i] = static_cast<std::int32_t>(problem.points.size());
    problem.points.push_back(problem.given[i]);
    problem.chosen.push_back(i);
  }
  for (const DistanceConstraint& edge : edges) {
    const std::int32_t i = number[at(edge.i)];
    const std::size_t other = at(edge.j);
    if (i < 0) continue;
    if (other < seen) problem.edges.push_back({i, number[other], edge.rest_length_m});
    if (other >= seen) problem.ties.push_back({i, other - seen, edge.rest_length_m});
  }
  for (std::size_t i = seen; i < parts.size(); ++i) {
    if (parts[i] == largest) tie_to_itself(i - seen, problem);
  }
  return problem;
}

std::vector<DepthAnchor> anchors_of(const DepthProblem& problem,
                                    std::span<const KnownSurfacePoint> known, const Points3& rays) {
  std::vector<DepthAnchor> anchors;
  for (const Tie& tie : problem.ties) {
    const KnownSurfacePoint& anchor = known[tie.known];
    const Eigen::Vector3d ray = rays.row(tie.point).transpose();
    const double beside_m = (anchor.centre_m - anchor.centre_m.dot(ray) * ray).norm();
    const double reach_m = std::max(tie.length_m + anchor.radius_m, kReachable * beside_m);
    anchors.push_back({tie.point, anchor.centre_m, std::max(reach_m, kLeastReach_m)});
  }
  return anchors;
}

}  // namespace weft::brunet_mdh
