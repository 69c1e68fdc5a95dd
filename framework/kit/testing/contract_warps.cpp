// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/data/matrix.hpp>

#include "kit/testing/contract_stages.hpp"
#include "kit/testing/geometry/answers.hpp"

namespace weft::testing {
namespace {

constexpr double kLoose = 1e-4;  ///< [] of the largest
/// Small against the cells of splines, whose third derivative jumps; differences of numbers around
/// 300 still keep 9 digits.
constexpr double kStep_px = 0.01;

/// Values of derivative `order` at the points moved along axis `along`, [M, .]; empty where the
/// warp is not evaluated there.
Eigen::MatrixXd values_at(Performer& performer, const HostRecord& warp, Points2 points, int along,
                          double shift_px, int order) {
  points.col(along).array() += shift_px;
  const Answer answer = performer.evaluate(warp, {make_array<double>(points), order});
  const auto samples = answer.get<WarpSamples>("warp_samples");
  if (!samples) return {};
  const bool all_valid =
      std::all_of(samples->valid.data(), samples->valid.data() + samples->valid.rows(),
                  [](std::uint8_t valid) { return valid != 0; });
  if (!all_valid) return {};
  if (order == 0) return samples->xy_px.matrix<2>();
  if (order == 1 && samples->jacobian.present()) return samples->jacobian.matrix<4>();
  if (order == 2 && samples->hessian.present()) return samples->hessian.matrix<6>();
  return {};
}

/// Derivatives of `order` against differences of those of one order less.
void check_derivatives(Performer& performer, const HostRecord& warp, const Points2& points,
                       int order, Checks& checks) {
  checks.begin("derivatives of order " + std::to_string(order));
  const Eigen::MatrixXd exact = values_at(performer, warp, points, 0, 0.0, order);
  if (exact.size() == 0) return checks.fail("there are none at points inside the texture");
  const double scale = exact.cwiseAbs().maxCoeff();
  for (int along = 0; along < 2; ++along) {
    const Eigen::MatrixXd ahead = values_at(performer, warp, points, along, kStep_px, order - 1);
    const Eigen::MatrixXd behind = values_at(performer, warp, points, along, -kStep_px, order - 1);
    if (ahead.size() == 0 || behind.size() == 0) return checks.fail("there are no values beside");
    const Eigen::MatrixXd slope = (ahead - behind) / (2.0 * kStep_px);
    for (Eigen::Index column = 0; column < slope.cols(); ++column) {
      // Index for x and for y: first derivatives are du dv, second ones duu duv dvv.
      const Eigen::Index derived =
          order == 1 ? 2 * column + along : 3 * (column / 2) + column % 2 + along;
      const double worst = (exact.col(derived) - slope.col(column)).cwiseAbs().maxCoeff();
      if (worst > kLoose * scale + 1e-9) {
        checks.fail(std::string(2 * column < slope.cols() ? "x" : "y") + " along " +
                    (along == 0 ? "u" : "v") + " is off by " + std::to_string(worst / scale) +
                    " of the largest");
      }
    }
  }
}

}  // namespace

void check_warp(const Subject& subject, Checks& checks) {
  const Case usual = cases_of(subject)[0], other = cases_of(subject)[1];
  Performer performer(subject), stranger(subject);
  if (!performer.begin(usual.scene.templ, usual.scene.camera)) return;
  if (!stranger.begin(usual.scene.templ, usual.scene.camera)) return;
  const HostRecord warp = performer.call(kRunStage, usual.inputs).find("warp");
  if (warp == nullptr) return;  // already reported
  const Points2 points = inner_texels(usual.scene.templ);
  const Points asked{make_array<double>(points), 2};

  checks.begin("evaluated from its record alone");
  const Answer first = performer.evaluate(warp, asked);
  checks.expect(first.is_usable(), "reports " + to_text(first));
  performer.call(kRunStage, other.inputs);
  const std::string after_fit = difference(performer.evaluate(warp, asked), first);
  checks.expect(after_fit.empty(), "after another fit, " + after_fit);
  const std::string elsewhere = difference(stranger.evaluate(warp, asked), first);
  checks.expect(elsewhere.empty(), "by an instance that fitted nothing, " + elsewhere);

  checks.begin("evaluated at no point");
  const Answer nothing = performer.evaluate(warp, {Array<double>({0, 2}, 0.0), 0});
  checks.expect(nothing.is_usable(), "reports " + to_text(nothing));
  check_derivatives(performer, warp, points, 1, checks);
  check_derivatives(performer, warp, points, 2, checks);
}

}  // namespace weft::testing
