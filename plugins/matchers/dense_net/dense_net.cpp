// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/matcher.hpp>

#include "common/inference/network_choice.hpp"
#include "common/inference/registration.hpp"

namespace weft::dense_net {
namespace {

using inference::SeenCell;

/// One forward pass of a network that was trained for the template: a match for each cell of the
/// image that shows it.
class DenseNet final : public Matcher {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Fuentes-Jimenez et al., Deep Shape-from-Template: single-image quasi-isometric "
          "deformable registration and reconstruction, Image and Vision Computing 127 (2022)",
      .needs = "image template camera"};

  explicit DenseNet(Params& p) {
    choice_.read(p);
    p.read("worst_share", worst_share_, "", {0.0, 0.95},
           "share of the cells with the largest expected error that is omitted");
    p.read("sigma_px", least_sigma_px_, "px", {0.01, 100.0},
           "minimum standard deviation of a match");
    p.read("least_cells", least_cells_, "", {1, 100000},
           "minimum number of matches; with fewer the result is empty and degenerate");
  }

  void check(Mistakes& mistakes) const { choice_.check(mistakes); }

  Result<void> prepare(const PrepareInput& in) override {
    return registration_.prepare(choice_, in.templ, in.camera);
  }

  Result<Correspondences> match(const MatcherInput& in) override {
    if (!in.image || !in.templ || !in.camera) return no_result("there is no image");
    auto ready = registration_.prepare(choice_, *in.templ, *in.camera);
    if (!ready) return ready.error();
    const auto maps = registration_.run(*in.image, in.call.threads());
    if (!maps) return maps.error();
    const std::vector<SeenCell> seen = registration_.seen_cells(*maps, choice_.least_probability);
    return answer(seen, *in.templ);
  }

 private:
  Result<Correspondences> answer(const std::vector<SeenCell>& seen, const Template& templ) const {
    std::vector<SeenCell> kept = without_worst(seen);
    const std::size_t certain = kept.size();
    std::erase_if(kept, [&](const SeenCell& cell) { return registration_.is_beyond(cell); });
    const bool is_enough = static_cast<std::int64_t>(kept.size()) >= least_cells_;
    Correspondences matches = collect(is_enough ? kept : std::vector<SeenCell>(), templ);
    const int cells = registration_.cell_count();
    matches.diag.set("visible_share", static_cast<double>(seen.size()) / cells);
    matches.diag.set("outside_cells", static_cast<double>(certain - kept.size()));
    matches.diag.set("field_share", registration_.map().covered_share());
    if (is_enough) {
      std::vector<double> errors_m;
      for (const SeenCell& cell : kept) errors_m.push_back(cell.error_m);
      matches.diag.set("expected_error_mm", 1e3 * median_in_place(errors_m));
      matches.confidence = make_scalar(registration_.confidence(kept));
      return matches;
    }
    return degenerate(std::move(matches), "the network sees the object in " +
                                              std::to_string(kept.size()) + " of " +
                                              std::to_string(cells) + " cells, " +
                                              std::to_string(least_cells_) + " are needed");
  }

  /// Omits the share of cells with the largest expected error; the others keep their order.
  std::vector<SeenCell> without_worst(const std::vector<SeenCell>& seen) const {
    std::vector<std::size_t> order(seen.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return seen[a].error_m < seen[b].error_m;
    });
    const double worst = std::floor(worst_share_ * static_cast<double>(seen.size()));
    order.resize(seen.size() - static_cast<std::size_t>(worst));
    std::sort(order.begin(), order.end());
    std::vector<SeenCell> kept;
    for (const std::size_t n : order) kept.push_back(seen[n]);
    return kept;
  }

  Correspondences collect(const std::vector<SeenCell>& cells, const Template& templ) const {
    const auto count = static_cast<std::int64_t>(cells.size());
    const Camera& camera = registration_.camera();
    const double diagonal_px = std::hypot(camera.width_px, camera.height_px);
    Correspondences out;
    out.template_px = Array<double>({count, 2});
    out.image_px = Array<double>({count, 2});
    out.face = Array<std::int32_t>({count}, -1);  // the host finds the faces
    out.barycentrics = Array<double>({count, 3}, 0.0);
    out.kept = Array<std::uint8_t>({count}, 1);
    out.score = Array<double>({count});
    out.covariance_px2 = Array<double>({count, 2, 2}, 0.0);
    if (templ.m_per_px.present()) out.template_xy_m = Array<double>({count, 2});
    for (std::int64_t n = 0; n < count; ++n) {
      const SeenCell& cell = cells[to_index(n)];
      const Eigen::Array2d texel = registration_.sheet().texel(cell.uv.max(0.0).min(1.0));
      for (int k = 0; k < 2; ++k) {
        out.template_px(n, k) = texel(k);
        out.image_px(n, k) = cell.image_px(k);
        if (templ.m_per_px.present()) out.template_xy_m(n, k) = templ.m_per_px(k) * texel(k);
      }
      const double sigma_px = inference::sigma_px(cell, least_sigma_px_, diagonal_px);
      out.covariance_px2.row(n)[0] = out.covariance_px2.row(n)[3] = sigma_px * sigma_px;
      out.score(n) = cell.probability;
    }
    return out;
  }

  inference::NetworkChoice choice_;
  double worst_share_ = 0.2;
  double least_sigma_px_ = 1.5;
  int least_cells_ = 20;
  inference::Registration registration_;
};

}  // namespace
}  // namespace weft::dense_net

WEFT_PLUGIN(weft::dense_net::DenseNet, "matchers/dense_net", "1.0.0",
            "Registers the template densely by a network that was trained for it.")
