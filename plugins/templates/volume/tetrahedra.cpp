// SPDX-License-Identifier: Apache-2.0
#include "tetrahedra.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <unordered_map>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "lattice.hpp"
#include "number_text.hpp"
#include "winding_number.hpp"

namespace weft::volume {
namespace {

using Key = Lattice::Key;

enum class Kind : std::uint8_t { outside, cut, inside };

Error bad_pitch(const std::string& sentence) {
  return about("pitch_m", {Errc::invalid_value, sentence});
}

std::string mm(double length_m) { return number_text(1e3 * length_m) + " mm"; }

Result<void> check_pitch(const Eigen::Vector3d& size_m, double pitch_m) {
  if (pitch_m > size_m.maxCoeff()) {
    return bad_pitch("a pitch of " + mm(pitch_m) + " is larger than the object, which is " +
                     mm(size_m.maxCoeff()) +
                     " long: give a smaller 'pitch_m', or 0 for a "
                     "twelfth of the object's diagonal");
  }
  constexpr double kMostCubes = 1e6;  // an object may fill a small part of its box
  const double cubes = Lattice::cubes_in(size_m, pitch_m);
  if (cubes <= kMostCubes) return {};
  return bad_pitch("a pitch of " + mm(pitch_m) + " divides the object's box into more than " +
                   std::to_string(static_cast<std::int64_t>(kMostCubes)) +
                   " cubes: give a larger 'pitch_m', or 0 for a twelfth of the object's diagonal");
}

/// Marks the tetrahedra that the surface enters or that hold a vertex.
void mark_cut(const ClosedSurface& surface, const Lattice& lattice, std::vector<Kind>& kinds) {
  for (Eigen::Index v = 0; v < surface.vertices_m.rows(); ++v) {
    kinds[to_index(lattice.locate(surface.vertices_m.row(v)).tetrahedron)] = Kind::cut;
  }
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    std::array<Eigen::Vector3d, 3> corners;
    for (int k = 0; k < 3; ++k) {
      corners[to_index(k)] = surface.vertices_m.row(surface.faces(f, k));
    }
    for (const Key t : lattice.cut_by(corners)) kinds[to_index(t)] = Kind::cut;
  }
}

std::array<Eigen::Vector3d, 4> corners_m(const Lattice& lattice, Key tetrahedron) {
  const auto nodes = lattice.corners_of(tetrahedron);
  return {lattice.node_m(nodes[0]), lattice.node_m(nodes[1]), lattice.node_m(nodes[2]),
          lattice.node_m(nodes[3])};
}

void mark_inside(const Lattice& lattice, const WindingNumber& inside, std::vector<Kind>& kinds) {
  for (Key t = 0; t < lattice.tetrahedron_count(); ++t) {
    worked_in_loop(t, 10);
    if (kinds[to_index(t)] != Kind::outside || !lattice.has(t)) continue;
    worked(200);
    const auto corners = corners_m(lattice, t);
    const Eigen::Vector3d centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    if (inside.contains(centre)) kinds[to_index(t)] = Kind::inside;
  }
}

/// Share of a tetrahedron that is inside, by 56 evenly distributed samples.
double filled_share_of(const std::array<Eigen::Vector3d, 4>& corners, const WindingNumber& inside) {
  constexpr int kPieces = 5;
  int within = 0, samples = 0;
  for (int i = 0; i <= kPieces; ++i) {
    for (int j = 0; i + j <= kPieces; ++j) {
      for (int k = 0; i + j + k <= kPieces; ++k, ++samples) {
        const int counts[] = {i, j, k, kPieces - i - j - k};
        Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
        for (std::size_t n = 0; n < 4; ++n) at_m += (counts[n] + 0.25) / (kPieces + 1) * corners[n];
        within += inside.contains(at_m) ? 1 : 0;
      }
    }
  }
  worked(200 * samples);
  return std::max(kLeastFilled, static_cast<double>(within) / samples);
}

/// Number of groups of tetrahedra that are joined by faces.
int count_pieces(const Lattice& lattice, const std::vector<Key>& kept) {
  std::vector<std::size_t> up(kept.size());
  std::iota(up.begin(), up.end(), std::size_t{0});
  const auto root = [&](std::size_t t) {
    while (up[t] != t) t = up[t] = up[up[t]];
    return t;
  };
  auto pieces = static_cast<int>(kept.size());
  std::map<std::array<Key, 3>, std::size_t> first_at;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    worked(100);
    auto corners = lattice.corners_of(kept[t]);
    std::sort(corners.begin(), corners.end());
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<Key, 3> face{};
      for (std::size_t k = 0, n = 0; k < 4; ++k) {
        if (k != left_out) face[n++] = corners[k];
      }
      const auto [found, is_new] = first_at.try_emplace(face, t);
      if (is_new) continue;
      const std::size_t a = root(found->second), b = root(t);
      if (a == b) continue;
      up[std::max(a, b)] = std::min(a, b);
      --pieces;
    }
  }
  return pieces;
}

std::vector<Key> kept_of(const std::vector<Kind>& kinds) {
  std::vector<Key> kept;
  for (std::size_t t = 0; t < kinds.size(); ++t) {
    if (kinds[t] != Kind::outside) kept.push_back(static_cast<Key>(t));
  }
  return kept;
}

/// Numbers nodes and tetrahedra in the lattice's order and embeds the vertices.
Result<Solid> numbered(const ClosedSurface& surface, const Lattice& lattice,
                       const std::vector<Key>& kept) {
  std::map<Key, std::int32_t> number_of;
  for (const Key t : kept) {
    for (const Key node : lattice.corners_of(t)) number_of.emplace(node, 0);
  }
  const auto node_count = static_cast<std::int64_t>(number_of.size());
  if (node_count > kMostNodes) {
    const double suitable_m =
        1.1 * lattice.pitch_m() *
        std::cbrt(static_cast<double>(node_count) / static_cast<double>(kMostNodes));
    return bad_pitch("a pitch of " + mm(lattice.pitch_m()) + " makes " +
                     std::to_string(node_count) + " nodes, legal are " +
                     std::to_string(kMostNodes) + ": give a 'pitch_m' of about " +
                     number_text(suitable_m) + " or more");
  }
  Solid solid;
  solid.nodes_m.resize(node_count, 3);
  std::int32_t next = 0;
  for (auto& [node, number] : number_of) {
    solid.nodes_m.row(next) = lattice.node_m(node);
    number = next++;
  }
  solid.tetrahedra.resize(static_cast<Eigen::Index>(kept.size()), 4);
  std::unordered_map<Key, std::int32_t> index_of;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    const auto nodes = lattice.corners_of(kept[t]);
    for (std::size_t k = 0; k < 4; ++k) {
      solid.tetrahedra(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(k)) =
          number_of.at(nodes[k]);
    }
    index_of.emplace(kept[t], static_cast<std::int32_t>(t));
  }
  solid.vertex_barycentric.resize(surface.vertices_m.rows(), 4);
  for (Eigen::Index v = 0; v < surface.vertices_m.rows(); ++v) {
    const auto place = lattice.locate(surface.vertices_m.row(v));
    solid.vertex_tetrahedron.push_back(index_of.at(place.tetrahedron));
    solid.vertex_barycentric.row(v) = place.weights;
  }
  return solid;
}

}  // namespace

Result<Solid> fill_with_tetrahedra(const ClosedSurface& surface, double pitch_m) {
  const Eigen::Vector3d low_m = surface.vertices_m.colwise().minCoeff();
  const Eigen::Vector3d high_m = surface.vertices_m.colwise().maxCoeff();
  if (auto legal = check_pitch(high_m - low_m, pitch_m); !legal) return legal.error();
  const Lattice lattice(low_m, high_m, pitch_m);
  const WindingNumber inside(surface.vertices_m, surface.faces);
  std::vector<Kind> kinds(to_index(lattice.tetrahedron_count()), Kind::outside);
  mark_cut(surface, lattice, kinds);
  mark_inside(lattice, inside, kinds);
  const std::vector<Key> kept = kept_of(kinds);
  if (static_cast<std::int64_t>(kept.size()) < kFewestTetrahedra) {
    return bad_pitch("a pitch of " + mm(pitch_m) + " makes " + std::to_string(kept.size()) +
                     " tetrahedra, at least " + std::to_string(kFewestTetrahedra) +
                     " are needed: give a smaller 'pitch_m'");
  }
  auto solid = numbered(surface, lattice, kept);
  if (!solid) return solid;
  solid->parts = count_pieces(lattice, kept);
  for (const Key t : kept) {
    const bool is_cut = kinds[to_index(t)] == Kind::cut;
    solid->filled_share.push_back(is_cut ? filled_share_of(corners_m(lattice, t), inside) : 1.0);
  }
  return solid;
}

}  // namespace weft::volume
