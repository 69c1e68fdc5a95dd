// SPDX-License-Identifier: Apache-2.0
#include "chart.hpp"

#include <algorithm>
#include <map>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_topology.hpp>

namespace weft::mesh {
namespace {

/// The faces of each piece.
std::vector<std::vector<Eigen::Index>> pieces_of(const TexturedMesh& mesh) {
  std::vector<std::int32_t> up(to_index(mesh.faces.rows()));
  for (std::size_t f = 0; f < up.size(); ++f) up[f] = static_cast<std::int32_t>(f);
  const auto root = [&](std::int32_t f) {
    while (up[to_index(f)] != f) f = up[to_index(f)] = up[to_index(up[to_index(f)])];
    return f;
  };
  const auto topology = build_topology(mesh.faces, mesh.flat_px.rows());
  for (Eigen::Index e = 0; topology && e < topology->edges.rows(); ++e) {
    if (topology->edge_faces(e, 1) < 0) continue;
    const auto [low, high] =
        std::minmax({root(topology->edge_faces(e, 0)), root(topology->edge_faces(e, 1))});
    up[to_index(high)] = low;
  }
  std::map<std::int32_t, std::vector<Eigen::Index>> faces_of;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    faces_of[root(static_cast<std::int32_t>(f))].push_back(f);
  }
  std::vector<std::vector<Eigen::Index>> pieces;
  for (auto& [first, faces] : faces_of) pieces.push_back(std::move(faces));
  return pieces;
}

TexturedMesh part_of(const TexturedMesh& mesh, const std::vector<Eigen::Index>& faces) {
  std::map<std::int32_t, std::int32_t> number_of;
  for (const Eigen::Index f : faces) {
    for (int k = 0; k < 3; ++k) number_of.emplace(mesh.faces(f, k), 0);
  }
  const auto count = static_cast<Eigen::Index>(number_of.size());
  TexturedMesh part{Points3(count, 3), Points2(count, 2),
                    Faces(static_cast<Eigen::Index>(faces.size()), 3)};
  std::int32_t next = 0;
  for (auto& [vertex, number] : number_of) {
    number = next++;
    part.vertices_m.row(number) = mesh.vertices_m.row(vertex);
    part.flat_px.row(number) = mesh.flat_px.row(vertex);
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      part.faces(static_cast<Eigen::Index>(f), k) = number_of.at(mesh.faces(faces[f], k));
    }
  }
  return part;
}

/// Follows the sides that belong to one face, as that face walks them.
std::vector<std::vector<std::int32_t>> borders_of(const Faces& faces) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> walks;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) ++walks[{faces(f, k), faces(f, (k + 1) % 3)}];
  }
  std::multimap<std::int32_t, std::int32_t> next;
  for (const auto& [side, count] : walks) {
    if (!walks.contains({side.second, side.first})) next.insert(side);
  }
  std::vector<std::vector<std::int32_t>> borders;
  while (!next.empty()) {
    auto& border = borders.emplace_back();
    for (auto step = next.begin(); step != next.end(); step = next.find(border.back())) {
      if (border.empty()) border.push_back(step->first);
      border.push_back(step->second);
      next.erase(step);
      if (border.back() == border.front()) break;
    }
    border.pop_back();
  }
  return borders;
}

}  // namespace

std::vector<Chart> charts_of(const TexturedMesh& mesh) {
  std::vector<Chart> charts;
  for (const auto& faces : pieces_of(mesh)) {
    TexturedMesh part = part_of(mesh, faces);
    auto borders = borders_of(part.faces);
    charts.push_back({std::move(part), std::move(borders)});
  }
  return charts;
}

}  // namespace weft::mesh
