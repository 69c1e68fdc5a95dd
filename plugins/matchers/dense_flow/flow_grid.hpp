// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/core/index.hpp>

#include "common/view/patch.hpp"
#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"
#include "common/workers/workers.hpp"

namespace weft::dense_flow {

/// The state of a node after the search.
enum class Fate : std::uint8_t {
  hidden,   ///< its patch is not completely on the surface, or leads out of the image
  flat,     ///< its patch has no structure along some direction
  unlike,   ///< the image does not look like its patch, or the search did not converge
  one_way,  ///< from its place in the image the search leads elsewhere
  astray,   ///< it moved otherwise than its neighbours
  found,
};
inline constexpr int kFates = 6;

/// A place of the view and where it is in the image. Lengths in px of the grid's level.
struct Node {
  Eigen::Vector2f by_px = Eigen::Vector2f::Zero();
  float correlation = 0.0F;
  float correlation_before = 0.0F;  ///< correlation of the view with the image as predicted; finest
                                    ///< level
  Eigen::Matrix2f covariance_px2 = Eigen::Matrix2f::Zero();
  Fate fate = Fate::hidden;
};

struct FlowOptions {
  int spacing_px = 4;              ///< [] px of the finest level, from node to node
  double min_correlation = 0.7;    ///< []
  double max_round_trip_px = 1.0;  ///< [] px of the finest level
  double max_deviation_px = 2.0;   ///< [] px of each level, from the median of the neighbours
};

/// The displacement between a predicted view and an image, at the nodes of a grid. Inverse
/// compositional steps find patches from coarse to fine (after Kroeger et al., Fast optical flow
/// using dense inverse search, ECCV 2016). Each level starts from the result of the previous one.
/// The result does not depend on the number of workers.
class FlowGrid {
 public:
  /// Begins with the displacement `start_px` (px of the image) and ends at the view's finest level.
  void find(const view::PredictedView& view, const view::Pyramid& image,
            const Eigen::Vector2d& start_px, const FlowOptions& options, Workers& workers,
            int threads);

  int columns() const { return grid_.columns; }
  int rows() const { return grid_.rows; }
  const Node& node(int column, int row) const { return grid_.at(column, row); }
  /// Place of a node, in px of the finest level of the image: a whole pixel.
  Eigen::Vector2i place_px(int column, int row) const { return grid_.place_px(column, row); }
  /// The found node nearest to a place (px of the finest level), of those around it; null: none.
  const Node* nearest_found(const Eigen::Vector2d& place_px) const;

 private:
  struct Grid {
    int x0 = 0, y0 = 0, spacing_px = 1, columns = 0, rows = 0;
    std::vector<Node> nodes{};

    Node& at(int column, int row) { return nodes[to_index(row * columns + column)]; }
    const Node& at(int column, int row) const { return nodes[to_index(row * columns + column)]; }
    Eigen::Vector2i place_px(int column, int row) const {
      return {x0 + column * spacing_px, y0 + row * spacing_px};
    }
  };

  void lay_out(const view::ViewLevel& view, int spacing_px);
  void begin_from(const Grid& coarser);
  void search_row(const view::PredictedView& view, const view::Pyramid& image, int level, int row,
                  view::Patch& patch);
  void search(const view::PredictedView& view, const view::Pyramid& image, int level, int column,
              int row, view::Patch& patch);
  bool comes_back(const view::ViewLevel& view, const view::Picture& image, int column, int row,
                  view::Patch& patch) const;
  void reject_astray();
  void spread();

  FlowOptions options_;
  Grid grid_, coarser_;
  std::vector<view::Patch> patches_;  ///< one a worker
  std::vector<std::uint8_t> known_, known_next_, astray_;
  std::vector<Eigen::Vector2f> spread_;
};

}  // namespace weft::dense_flow
