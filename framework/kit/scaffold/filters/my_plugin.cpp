// SPDX-License-Identifier: Apache-2.0
#include <Eigen/QR>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/sdk/filter.hpp>

namespace {

constexpr std::int64_t kFewest = 4;  ///< matches; three lie on an affine map whatever they are
constexpr int kRounds = 30;
constexpr double kNothing_px = 0.1;  ///< added to residuals, so that no weight is infinite
constexpr double kOnALine = 1e-9;

/// Distance of each match [N] from its prediction by the affine map y = (x, 1) A, px. A minimises
/// the sum of these distances, by iterative reweighting with 1 / residual.
struct AffineFit {
  Eigen::VectorXd residual_px;
  bool determined = true;  ///< false for matches on a line or in one place

  AffineFit(const Eigen::MatrixXd& from, const Eigen::MatrixXd& to) {
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(from.rows());
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(kOnALine);
    for (int round = 0; round < kRounds; ++round) {
      weft::worked(20 * from.rows());
      const Eigen::MatrixXd weighted_from = weight.asDiagonal() * from;
      const Eigen::MatrixXd weighted_to = weight.asDiagonal() * to;
      solver.compute(weighted_from);
      const Eigen::MatrixXd map = solver.solve(weighted_to);
      residual_px = (to - from * map).rowwise().norm();
      weight = (residual_px.array() + kNothing_px).rsqrt().matrix();
    }
    determined = solver.rank() == from.cols();
  }
};

/// Keeps a match that lies where one affine map of the whole template puts it.
class MyPluginFilter final : public weft::Filter {
 public:
  static constexpr weft::Sweep kSweep{"tolerance_px", {1, 2, 4, 8, 16, 32, 64, 128}};

  explicit MyPluginFilter(weft::Params& p) {
    p.read("tolerance_px", tolerance_px_, "px", {0, 1000},
           "maximum distance of a kept match from the affine map");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const weft::Correspondences& matches = in.correspondences;
    std::vector<std::int64_t> judged;  // matches that an earlier filter rejected do not count
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      if (matches.kept(i) != 0) judged.push_back(i);
    }
    const std::int64_t count = std::ssize(judged);
    if (count < kFewest) {
      return weft::no_result(std::to_string(count) + " matches are left; at least " +
                             std::to_string(kFewest) + " are needed");
    }
    Eigen::MatrixXd from(count, 3), to(count, 2);
    for (std::int64_t k = 0; k < count; ++k) {
      const std::int64_t i = judged[weft::to_index(k)];
      from.row(k) << matches.template_px(i, 0), matches.template_px(i, 1), 1.0;
      to.row(k) << matches.image_px(i, 0), matches.image_px(i, 1);
    }
    const AffineFit fit(from, to);

    weft::InlierMask mask;
    mask.kept = weft::Array<std::uint8_t>({matches.count()}, 0);
    mask.score = weft::Array<double>({matches.count()}, 0.0);
    for (std::int64_t k = 0; k < count; ++k) {
      const std::int64_t i = judged[weft::to_index(k)];
      mask.kept(i) = fit.residual_px[k] <= tolerance_px_ ? 1 : 0;
      mask.score(i) = 1.0 / (1.0 + fit.residual_px[k]);
    }
    mask.diag.set("mean_residual_px", fit.residual_px.mean());
    if (!fit.determined) {
      return weft::degenerate(std::move(mask), "the matches lie on a line or in one place");
    }
    return mask;
  }

 private:
  double tolerance_px_ = 30.0;
};

}  // namespace

WEFT_PLUGIN(MyPluginFilter, "filters/my_plugin", "1.0.0",
            "Keeps matches that agree with one affine map of the template.")
