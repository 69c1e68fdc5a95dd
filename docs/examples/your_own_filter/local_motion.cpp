// SPDX-License-Identifier: Apache-2.0
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/filter.hpp>

namespace {
/// Keeps a match whose displacement is close to the median of its neighbourhood, itself included.
struct LocalMotion final : weft::Filter {
  double radius_px = 60.0, max_deviation_px = 15.0;

  explicit LocalMotion(weft::Params& p) {
    p.read("radius_px", radius_px, "px", {1, 1000}, "radius of the neighbourhood on the template");
    p.read("max_deviation_px", max_deviation_px, "px", {0, 500}, "maximum distance from median");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const auto at = in.correspondences.template_px.matrix<2>();
    const Eigen::MatrixX2d motion = in.correspondences.image_px.matrix<2>() - at;
    std::int64_t n = in.correspondences.count(), judged = 0;
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}, 0), weft::Array<double>({n}, 0.0), {}};
    for (std::int64_t i = 0; i < n; ++i) {
      if (!in.correspondences.kept(i)) continue;  // an earlier filter rejected it
      std::vector<double> u, v;
      for (std::int64_t j = 0; j < n; ++j) {
        if (!in.correspondences.kept(j) || (at.row(j) - at.row(i)).norm() > radius_px) continue;
        u.push_back(motion(j, 0)), v.push_back(motion(j, 1));
      }
      const Eigen::RowVector2d usual(weft::median(u), weft::median(v));
      const double deviation_px = (motion.row(i) - usual).norm();
      mask.kept(i) = deviation_px <= max_deviation_px ? 1 : 0;
      mask.score(i) = 1.0 / (1.0 + deviation_px), ++judged;
    }
    if (judged == 0) return weft::no_result("no match is left to judge");
    return mask;
  }
};
}  // namespace

WEFT_PLUGIN(LocalMotion, "filters/local_motion", "1.0.0", "Rejects matches that move on their own.")
