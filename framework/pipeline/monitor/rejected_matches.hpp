// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>
#include <weft/data/correspondences.hpp>

namespace weft {

/// The rejected matches of filters that agree with each other.
struct CoherentRejects {
  int count = 0;      ///< [] that lie among the same neighbours in the texture and in the image
  int elsewhere = 0;  ///< [] of them, where nothing of the texture was kept
};

/// A rejected match is coherent where, of the eight rejected ones that are nearest in the texture,
/// at least three are among the eight nearest in the image. Chance does that to one in hundreds.
class RejectedMatches {
 public:
  CoherentRejects look(const Correspondences& matches);

 private:
  struct Neighbours;
  using Places = std::vector<Eigen::Vector2d>;

  Neighbours nearest(const Places& places_px, std::size_t of);
  bool is_coherent(std::size_t of);
  void choose(const Correspondences& matches, std::int64_t stride);

  // From look to look, so that they seldom allocate.
  Places kept_px_, template_px_, image_px_;
  std::vector<std::pair<double, std::size_t>> others_;
};

}  // namespace weft
