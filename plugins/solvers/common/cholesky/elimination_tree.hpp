// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/types.hpp>

namespace weft::solvers {

/// Vertices that are eliminated together.
struct EliminationNode {
  std::int32_t first = 0;            ///< [] place of its first vertex in the order
  std::int32_t count = 0;            ///< [] vertices, at places that follow each other
  std::vector<std::int32_t> border;  ///< [.] places of later vertices that it is coupled to then
  std::int32_t parent = -1;          ///< [] node that comes next with its border; -1 for the last
};

/// In what order the vertices are eliminated.
struct EliminationTree {
  std::vector<std::int32_t> place;     ///< [V] of each vertex in the order
  std::vector<EliminationNode> nodes;  ///< in their order: a subtree precedes its parent
};

/// Nested dissection (George, SIAM Journal on Numerical Analysis 10, 1973) halves a part of the
/// mesh across its longest side. The vertices of one half that are coupled to the other come last.
/// `coupled` lists for each vertex all vertices that share a block of the matrix with it. The order
/// depends on the arguments alone.
EliminationTree nested_dissection(const Points3View& rest_m, const IndexLists& coupled);

}  // namespace weft::solvers
