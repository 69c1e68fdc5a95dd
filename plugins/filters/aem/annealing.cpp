// SPDX-License-Identifier: Apache-2.0
#include "annealing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

#include "orientation.hpp"

namespace weft::aem {
namespace {

constexpr double kSigmaOfThreshold = 0.6;  // first sigma, of a seed's threshold
constexpr double kSigmaOfTrack = 0.03;     // share of the template's diagonal in the image
constexpr double kTrackSmoothing = 1e-3;   // smoothing, in areas of a knot cell: the shape is
                                           // smooth already
constexpr double kFirstShare = 0.3, kLeastShare = 0.02, kLargestShare = 0.98;
constexpr double kCooling = 0.7;           // sigma falls to this in a round at most
constexpr double kConvergedChange = 0.02;  // relative change of sigma that ends
constexpr int kFewestRounds = 6, kMostRounds = 20;
constexpr double kBroadSigmas = 4.0;  // least sigmas, above which a sharper optimum is looked for
constexpr double kSureLikelihood = 150.0;  // log; a set that chance made would be sharpened to more
constexpr double kCollapsed = 0.3;  // share of the start's scale, below which a warp shows no
                                    // surface
constexpr int kGatherEvery = 3;     // rounds
constexpr Eigen::Index kMostVertices = 256;  // a shape with more vertices is sampled
constexpr double kLeastLogit = -9.0;         // below it a match does not take part
constexpr double kLeastProbability = 1e-4;   // below it a match does not count in a fit
constexpr double kCertainLogit = 3.0;  // logit from which the warp's own variance is no matter
constexpr double kFarSigmas = 30.0;    // from which it does not help

constexpr double kExcludedLogit = -1e3;  // logit of a match that is not to bend the warp

double square(double x) { return x * x; }

SplineDomain domain_for(const Matches& matches, double margin_px, int control_long,
                        int control_short) {
  const TextureBox box = matches.box.grown(margin_px);
  const bool wide = matches.box.width_px() >= matches.box.height_px();
  return {box.u0,
          box.u1,
          box.v0,
          box.v1,
          wide ? control_long : control_short,
          wide ? control_short : control_long};
}

}  // namespace

/// The state of one run, from round to round. The active matches are the gathered ones.
struct Annealing::State {
  Grid& grid;
  Points2 target_px;  ///< [n,2] displacement that a match wants
  double sigma_px, share;
  int rounds = 0;
  std::vector<Eigen::Index> rows{};                       ///< [m] gathered
  double thinning = 1.0;                                  ///< matches for each that is gathered
  Eigen::ArrayXd bias{}, residual2_px2{}, probability{};  ///< [m]
};

Start start_from(const Matches& matches, const Seed& seed) {
  Start start;
  start.image_px =
      (matches.template_px * seed.map.slope.transpose()).rowwise() + seed.map.offset_px.transpose();
  start.slopes = {seed.map.slope};
  start.scale = seed.map.scale();
  start.sigma_px = kSigmaOfThreshold * seed.threshold_px;
  return start;
}

Annealing::Grid::Grid(const Matches& matches, const SplineDomain& domain) : spline(domain) {
  sites.reserve(to_index(matches.count()));
  for (Eigen::Index i = 0; i < matches.count(); ++i) {
    sites.push_back(spline.site(matches.template_px.row(i).transpose()));
  }
}

Annealing::Annealing(const Matches& matches, const AnnealingOptions& options)
    : matches_(matches),
      options_(options),
      coarse_(matches,
              domain_for(matches, options.margin_px, options.control_long, options.control_short)),
      fine_(matches, domain_for(matches, options.margin_px, options.fine_control_long,
                                options.fine_control_short)),
      all_(to_index(matches.count())) {
  std::iota(all_.begin(), all_.end(), Eigen::Index{0});
}

Start Annealing::start_along(const Points2& flat_px, const Points2& image_px) {
  DisplacementSpline& spline = fine_.spline;
  spline.start(kTrackSmoothing * spline.cell_px2());
  const Eigen::Index step = std::max<Eigen::Index>(1, flat_px.rows() / kMostVertices);
  for (Eigen::Index v = 0; v < flat_px.rows(); v += step) {
    spline.add(spline.site(flat_px.row(v).transpose()), 1.0, image_px.row(v).transpose());
  }
  spline.solve();
  Start start;
  start.image_px.resize(matches_.count(), 2);
  double area_ratio = 0.0;
  for (Eigen::Index i = 0; i < matches_.count(); ++i) {
    start.image_px.row(i) = fine_.displacement_px(i).transpose();
    worked(20);
    start.slopes.push_back(fine_.slope(i));
    area_ratio += std::abs(start.slopes.back().determinant());
  }
  start.scale = std::sqrt(area_ratio / static_cast<double>(matches_.count()));
  start.sigma_px = kSigmaOfTrack * start.scale * matches_.diagonal_px();
  return start;
}

Solution Annealing::run(const Start& start) {
  State state{coarse_, matches_.image_px - start.image_px, start.sigma_px, kFirstShare};
  coarse_.spline.clear();
  double change = 1.0;
  while (state.rounds < kMostRounds &&
         (state.rounds <= kFewestRounds || change >= kConvergedChange)) {
    if (state.rounds % kGatherEvery == 0) gather_again(start, state);
    worked(matches_.count());
    const double before_px = state.sigma_px;
    improve(start, state);
    change = 1.0 - state.sigma_px / before_px;
  }
  Solution best = solution_of(start, state);
  const bool broad = best.sigma_px > kBroadSigmas * options_.least_sigma_px;
  if (broad && best.log_likelihood > kSureLikelihood) sharpen(start, state, best);
  return best;
}

/// Cools independent of the residuals, and keeps the likeliest solution on the way. Where a texture
/// repeats, matches to the next period surround the inliers and keep sigma at the size of the
/// period.
void Annealing::sharpen(const Start& start, State& state, Solution& best) {
  while (state.sigma_px > options_.least_sigma_px) {
    const double cooler_px = std::max(options_.least_sigma_px, kCooling * state.sigma_px);
    gather_again(start, state);
    improve(start, state);
    state.sigma_px = cooler_px;
    Solution next = solution_of(start, state);
    if (next.log_likelihood > best.log_likelihood) best = std::move(next);
  }
}

void Annealing::gather_again(const Start& start, State& state) const {
  gather(residuals_px(state), options_.most_annealed, state);
  state.bias = biases(start, state.grid, state.rows);
}

Solution Annealing::solution_of(const Start& start, const State& state) const {
  Solution solution;
  solution.residual_px = residuals_px(state);
  solution.bias = biases(start, coarse_, all_);
  conclude(state, solution);
  solution.log_likelihood =
      static_cast<double>(matches_.count()) * std::log1p(-state.share) +
      (1.0 + solution.logit.exp()).log().sum() -
      0.5 * options_.stiffness * coarse_.spline.bending() / square(start.scale);
  if (typical_scale(start, state) < kCollapsed * start.scale) solution.log_likelihood = 0.0;
  return solution;
}

/// The median scale of the warp at inliers. Shrinking to clusters of mismatches costs the warp
/// little bending.
double Annealing::typical_scale(const Start& start, const State& state) const {
  std::vector<double> area_ratio;
  for (Eigen::Index k = 0; k < state.probability.size(); ++k) {
    if (state.probability[k] < 0.5) continue;
    const Eigen::Index i = state.rows[to_index(k)];
    area_ratio.push_back((start.slope(i) + state.grid.slope(i)).determinant());
  }
  if (area_ratio.empty()) return 0.0;
  return std::sqrt(std::max(0.0, median_in_place(area_ratio)));
}

void Annealing::finish(const Start& start, Solution& solution) {
  State state{fine_, matches_.image_px - start.image_px, solution.sigma_px, solution.share,
              solution.rounds};
  Isolated isolated{matches_.count()};
  for (int round = 0; round < options_.last_rounds; ++round) {
    look_again(start, isolated, state, solution);
  }
  solution.bias = biases(start, fine_, all_);
  conclude(state, solution);
  isolated = find_isolated(matches_, solution.logit, solution.share);
  if (isolated.is.any()) {
    look_again(start, isolated, state, solution);
    conclude(state, solution);
    solution.logit += isolated.shift;
  }
  for (Eigen::Index i = 0; i < matches_.count(); ++i) {
    const double residual2 = solution.residual_px.row(i).squaredNorm() / square(state.sigma_px);
    if (!isolated.is[i] && solution.logit[i] > kCertainLogit) continue;
    if (residual2 > square(kFarSigmas)) continue;
    const double inflation = 1.0 + fine_.spline.leverage(fine_.sites[to_index(i)]);
    solution.logit[i] += 0.5 * residual2 * (1.0 - 1.0 / inflation) - std::log(inflation);
  }
}

/// A round on all matches near the warp, in which isolated ones have no weight.
void Annealing::look_again(const Start& start, const Isolated& isolated, State& state,
                           Solution& solution) const {
  gather(solution.residual_px, options_.most_finished, state);
  state.bias = isolated.is(state.rows).select(kExcludedLogit, solution.bias(state.rows));
  improve(start, state);
  solution.residual_px = residuals_px(state);
}

/// Takes at most `most` of the matches that may be correct, evenly over the template.
void Annealing::gather(const Points2& residual_px, Eigen::Index most, State& state) const {
  const double reach2_px2 =
      2.0 * square(state.sigma_px) * (logit_constant(state.sigma_px, state.share) - kLeastLogit);
  std::vector<Eigen::Index> near;
  for (Eigen::Index i = 0; i < matches_.count(); ++i) {
    if (residual_px.row(i).squaredNorm() < reach2_px2) near.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(near.size());
  const Eigen::Index taken = std::min(most, count);
  state.rows.resize(to_index(taken));
  state.residual2_px2.resize(taken);
  state.thinning = taken > 0 ? static_cast<double>(count) / static_cast<double>(taken) : 1.0;
  for (Eigen::Index k = 0; k < taken; ++k) {
    const Eigen::Index i = near[to_index(k * count / taken)];
    state.rows[to_index(k)] = i;
    state.residual2_px2[k] = residual_px.row(i).squaredNorm();
  }
}

/// Warp less image point of all matches.
Points2 Annealing::residuals_px(const State& state) const {
  Points2 residual_px(matches_.count(), 2);
  for (Eigen::Index i = 0; i < matches_.count(); ++i) {
    residual_px.row(i) = state.grid.displacement_px(i).transpose() - state.target_px.row(i);
    worked(10);
  }
  return residual_px;
}

/// One round: probabilities, the warp for them, then sigma and share.
void Annealing::improve(const Start& start, State& state) const {
  state.probability = logit_constant(state.sigma_px, state.share) + state.bias -
                      state.residual2_px2 / (2.0 * square(state.sigma_px));
  state.probability = 1.0 / (1.0 + (-state.probability).exp());
  const bool last = &state.grid == &fine_;
  state.grid.spline.start((last ? options_.fine_stiffness : options_.stiffness) *
                          square(state.sigma_px / start.scale));
  for (Eigen::Index k = 0; k < state.probability.size(); ++k) {
    if (state.probability[k] < kLeastProbability) continue;
    worked(40);
    const Eigen::Index i = state.rows[to_index(k)];
    state.grid.spline.add(state.grid.sites[to_index(i)], state.probability[k],
                          state.target_px.row(i).transpose());
  }
  state.grid.spline.solve();
  for (Eigen::Index k = 0; k < state.probability.size(); ++k) {
    const Eigen::Index i = state.rows[to_index(k)];
    state.residual2_px2[k] =
        (state.grid.displacement_px(i) - state.target_px.row(i).transpose()).squaredNorm();
  }
  const double total = state.probability.sum();
  const double rms_px =
      std::sqrt((state.probability * state.residual2_px2).sum() / std::max(2.0 * total, 1e-9));
  state.sigma_px = std::max(options_.least_sigma_px,
                            std::clamp(rms_px, kCooling * state.sigma_px, state.sigma_px));
  state.share = std::clamp(state.thinning * total / static_cast<double>(matches_.count()),
                           kLeastShare, kLargestShare);
  ++state.rounds;
}

/// Fills in what follows from the residuals.
void Annealing::conclude(const State& state, Solution& solution) const {
  solution.logit =
      logit_constant(state.sigma_px, state.share) + solution.bias -
      solution.residual_px.rowwise().squaredNorm().array() / (2.0 * square(state.sigma_px));
  solution.sigma_px = state.sigma_px;
  solution.share = state.share;
  solution.rounds = state.rounds;
}

/// The contributions of scale and angle of matches to their log odds.
Eigen::ArrayXd Annealing::biases(const Start& start, const Grid& grid,
                                 const std::vector<Eigen::Index>& rows) const {
  Eigen::ArrayXd bias = Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(rows.size()));
  if (!matches_.oriented()) return bias;
  for (Eigen::Index k = 0; k < bias.size(); ++k) {
    const Eigen::Index i = rows[to_index(k)];
    bias[k] = orientation_log_odds(matches_.log_scale[i], matches_.turn_rad[i],
                                   start.slope(i) + grid.slope(i));
  }
  return bias;
}

/// Log odds of a match without a residual.
double Annealing::logit_constant(double sigma_px, double share) const {
  return std::log(share / (1.0 - share)) +
         std::log(matches_.image_area_px2 / (2.0 * std::numbers::pi * sigma_px * sigma_px));
}

}  // namespace weft::aem
