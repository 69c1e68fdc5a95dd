// SPDX-License-Identifier: Apache-2.0
#include "film/view_truth.hpp"

#include <algorithm>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>

namespace weft::frex {
namespace {

void fill_maps(const scene::View& view, const Eigen::RowVector2d& pitch_m, GroundTruth& truth) {
  truth.depth_m = view.depth_m;
  truth.uv_m = view.uv_px;
  for (std::int64_t y = 0; y < truth.uv_m.rows(); ++y) {
    ask_to_go_on();
    float* row = truth.uv_m.row(y);
    for (std::int64_t x = 0; x < truth.uv_m.dim(1); ++x) {
      row[2 * x] *= static_cast<float>(pitch_m.x());
      row[2 * x + 1] *= static_cast<float>(pitch_m.y());
    }
  }
}

}  // namespace

GroundTruth truth_of(const TruthFrame& frame, const Points3& vertices_m, const scene::View& view) {
  GroundTruth truth;
  truth.kind = "frex";
  truth.template_xy_m = frame.flat_m;
  const Points3 points_m = vertices_m.topRows(truth.count());
  truth.points_m = make_array<double>(points_m);
  truth.faces = frame.faces;
  truth.visible = Array<std::uint8_t>({truth.count()});
  std::copy_n(view.is_visible.begin(), truth.count(), truth.visible.data());
  if (frame.has_maps) fill_maps(view, frame.pitch_m, truth);
  return truth;
}

}  // namespace weft::frex
