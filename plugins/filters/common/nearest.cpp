// SPDX-License-Identifier: Apache-2.0
#include "common/nearest.hpp"

#include <cstdint>
#include <nanoflann.hpp>

namespace weft::filters {
namespace {

/// Points as nanoflann reads them.
struct Cloud {
  const Points2& points;
  const std::vector<int>& among;

  std::size_t kdtree_get_point_count() const { return among.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points(among[i], static_cast<Eigen::Index>(axis));
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 2>;

}  // namespace

Nearest nearest_of(const Points2& points, const std::vector<int>& among, int count) {
  Nearest nearest = Nearest::Constant(points.rows(), count, -1);
  if (among.empty() || count == 0) return nearest;
  const Cloud cloud{points, among};
  Tree tree(2, cloud);
  const auto wanted = static_cast<std::size_t>(count) + 1;  // the point itself may be among them
  std::vector<std::uint32_t> found(wanted);
  std::vector<double> distances2(wanted);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double place[] = {points(i, 0), points(i, 1)};
    const std::size_t number = tree.knnSearch(place, wanted, found.data(), distances2.data());
    int next = 0;
    for (std::size_t k = 0; k < number && next < count; ++k) {
      const int other = among[found[k]];
      if (other != i) nearest(i, next++) = other;
    }
  }
  return nearest;
}

}  // namespace weft::filters
