// SPDX-License-Identifier: Apache-2.0
#include "annealing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::aem {
namespace {

constexpr double kSigmaOfThreshold = 0.6;  // first sigma, of a seed's threshold
constexpr double kSigmaOfTrack = 0.03;     // of the template's diagonal in the image
constexpr double kTrackSmoothing = 1e-3;   // of a knot cell: the shape is smooth already
constexpr double kFirstShare = 0.3, kLeastShare = 0.02, kLargestShare = 0.98;
constexpr double kCooling = 0.7;  // sigma falls to this in a round at most
constexpr double kStill = 0.02;   // relative change of sigma that ends
constexpr int kFewestRounds = 6, kMostRounds = 20;
constexpr int kGatherEvery = 3;  // rounds
constexpr int kLastRounds = 2;
constexpr Eigen::Index kAnnealed = 256, kFinished = 1024;  // matches that take part at most
constexpr double kLeastLogit = -9.0;                       // below it a match does not take part
constexpr double kLeastProbability = 1e-4;  // below it a match does not count in a fit
constexpr double kSure = 3.0;               // logit from which the warp's own variance is no matter
constexpr double kFarSigmas = 30.0;         // from which it does not help

// What scale and angle of keypoints say.
constexpr double kTurnRad = 20.0 * std::numbers::pi / 180.0;  // sigma for a correct match
constexpr double kLogScale = 0.3;                             // the same
constexpr double kLogScaleRange = 2.77;  // of mismatches, evenly: a factor of 4 up and down
constexpr double kLeastBias = -3.0;      // a bad keypoint does not make a match wrong

double square(double x) { return x * x; }

SplineDomain domain_for(const Matches& matches, const AnnealingOptions& options) {
  const double margin = options.margin_px + 0.5;
  const bool wide = matches.width_px >= matches.height_px;
  return {-margin,
          matches.width_px - 1.0 + margin,
          -margin,
          matches.height_px - 1.0 + margin,
          wide ? options.control_long : options.control_short,
          wide ? options.control_short : options.control_long};
}

/// Log of the odds that a keypoint turned and scaled like this is of a correct match where the warp
/// has this slope.
double orientation_log_odds(double log_scale, double turn_rad, const Eigen::Matrix2d& slope) {
  const double area_ratio = slope.determinant();
  if (!(area_ratio > 0.0)) return kLeastBias;
  const double turn = std::atan2(slope(1, 0) - slope(0, 1), slope(0, 0) + slope(1, 1));
  const double of_turn = std::remainder(turn_rad - turn, 2.0 * std::numbers::pi) / kTurnRad;
  const double of_scale = (log_scale - 0.5 * std::log(area_ratio)) / kLogScale;
  static const double at_best = std::log(kLogScaleRange / (kTurnRad * kLogScale));
  return std::max(kLeastBias, at_best - 0.5 * (square(of_turn) + square(of_scale)));
}

}  // namespace

/// Of one run, from round to round. Those that take part are the gathered matches.
struct Annealing::State {
  Points2 target_px;                                ///< [n,2] displacement that a match wants
  std::vector<Eigen::Index> rows;                   ///< [m] gathered
  double thinning = 1.0;                            ///< matches for each that is gathered
  Eigen::ArrayXd bias, residual2_px2, probability;  ///< [m]
  double sigma_px = 1.0, share = kFirstShare;
  int rounds = 0;
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

Annealing::Annealing(const Matches& matches, const AnnealingOptions& options)
    : matches_(matches), options_(options), spline_(domain_for(matches, options)) {
  for (Eigen::Index i = 0; i < matches.count(); ++i) {
    sites_.push_back(spline_.site(matches.template_px.row(i).transpose()));
  }
}

Start Annealing::start_along(const Points2& flat_px, const Points2& image_px) {
  spline_.start(kTrackSmoothing * spline_.cell_px2());
  const Eigen::Index step = std::max<Eigen::Index>(1, flat_px.rows() / kAnnealed);
  for (Eigen::Index v = 0; v < flat_px.rows(); v += step) {
    spline_.add(spline_.site(flat_px.row(v).transpose()), 1.0, image_px.row(v).transpose());
  }
  spline_.solve();
  Start start;
  start.image_px.resize(matches_.count(), 2);
  double area_ratio = 0.0;
  for (Eigen::Index i = 0; i < matches_.count(); ++i) {
    const DisplacementSpline::Site& site = sites_[static_cast<std::size_t>(i)];
    start.image_px.row(i) = spline_(site).transpose();
    start.slopes.push_back(spline_.slope(site));
    area_ratio += std::abs(start.slopes.back().determinant());
  }
  start.scale = std::sqrt(area_ratio / static_cast<double>(matches_.count()));
  start.sigma_px = kSigmaOfTrack * start.scale * matches_.diagonal_px();
  return start;
}

/// Log odds of a match without a residual.
double Annealing::logit_constant(double sigma_px, double share) const {
  return std::log(share / (1.0 - share)) +
         std::log(matches_.image_area_px2 / (2.0 * std::numbers::pi * sigma_px * sigma_px));
}

/// At most `most` of the matches that may be correct, evenly over the template.
void Annealing::gather(const Start& start, State& state, Eigen::Index most) {
  const double reach2_px2 =
      2.0 * square(state.sigma_px) * (logit_constant(state.sigma_px, state.share) - kLeastLogit);
  std::vector<Eigen::Index> near;
  for (Eigen::Index i = 0; i < matches_.count(); ++i) {
    if (residual_px(state, i).squaredNorm() < reach2_px2) near.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(near.size());
  const Eigen::Index taken = std::min(most, count);
  state.rows.resize(static_cast<std::size_t>(taken));
  for (Eigen::Index k = 0; k < taken; ++k) {
    state.rows[static_cast<std::size_t>(k)] = near[static_cast<std::size_t>(k * count / taken)];
  }
  state.thinning = taken > 0 ? static_cast<double>(count) / static_cast<double>(taken) : 1.0;
  state.residual2_px2.resize(taken);
  if (matches_.oriented()) {
    state.bias.resize(taken);
    for (Eigen::Index k = 0; k < taken; ++k) {
      state.bias[k] = bias(start, state.rows[static_cast<std::size_t>(k)]);
    }
  }
  measure(state);
}

/// Warp less image point of a match.
Eigen::Vector2d Annealing::residual_px(const State& state, Eigen::Index i) const {
  return spline_(sites_[static_cast<std::size_t>(i)]) - state.target_px.row(i).transpose();
}

/// What scale and angle of a match add to its log odds.
double Annealing::bias(const Start& start, Eigen::Index i) const {
  if (!matches_.oriented()) return 0.0;
  const Eigen::Matrix2d slope = start.slope(i) + spline_.slope(sites_[static_cast<std::size_t>(i)]);
  return orientation_log_odds(matches_.log_scale[i], matches_.turn_rad[i], slope);
}

void Annealing::measure(State& state) const {
  for (Eigen::Index k = 0; k < state.residual2_px2.size(); ++k) {
    state.residual2_px2[k] =
        residual_px(state, state.rows[static_cast<std::size_t>(k)]).squaredNorm();
  }
}

/// One round: probabilities, the warp for them, then sigma and share.
void Annealing::improve(const Start& start, State& state) {
  state.probability = logit_constant(state.sigma_px, state.share) -
                      state.residual2_px2 / (2.0 * square(state.sigma_px));
  if (matches_.oriented()) state.probability += state.bias;
  state.probability = 1.0 / (1.0 + (-state.probability).exp());
  spline_.start(options_.stiffness * square(state.sigma_px / start.scale));
  for (Eigen::Index k = 0; k < state.probability.size(); ++k) {
    if (state.probability[k] < kLeastProbability) continue;
    const Eigen::Index i = state.rows[static_cast<std::size_t>(k)];
    spline_.add(sites_[static_cast<std::size_t>(i)], state.probability[k],
                state.target_px.row(i).transpose());
  }
  spline_.solve();
  measure(state);
  const double total = state.probability.sum();
  const double rms_px =
      std::sqrt((state.probability * state.residual2_px2).sum() / std::max(2.0 * total, 1e-9));
  state.sigma_px = std::max(options_.least_sigma_px,
                            std::clamp(rms_px, kCooling * state.sigma_px, state.sigma_px));
  state.share = std::clamp(state.thinning * total / static_cast<double>(matches_.count()),
                           kLeastShare, kLargestShare);
  ++state.rounds;
}

Annealing::State Annealing::state_of(const Start& start) const {
  State state;
  state.target_px = matches_.image_px - start.image_px;
  state.sigma_px = start.sigma_px;
  return state;
}

Solution Annealing::run(const Start& start) {
  State state = state_of(start);
  spline_.clear();
  double change = 1.0;
  while (state.rounds < kMostRounds && (state.rounds <= kFewestRounds || change >= kStill)) {
    if (state.rounds % kGatherEvery == 0) gather(start, state, kAnnealed);
    const double before_px = state.sigma_px;
    improve(start, state);
    change = 1.0 - state.sigma_px / before_px;
  }
  return conclude(start, state);
}

/// How well the warp explains all matches.
Solution Annealing::conclude(const Start& start, const State& state) const {
  const Eigen::Index n = matches_.count();
  Solution solution;
  solution.control_px = spline_.control_px();
  solution.residual_px.resize(n, 2);
  solution.logit.resize(n);
  solution.sigma_px = state.sigma_px;
  solution.share = state.share;
  solution.rounds = state.rounds;
  const double constant = logit_constant(state.sigma_px, state.share);
  const double per_px2 = 0.5 / square(state.sigma_px);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d residual = residual_px(state, i);
    solution.residual_px.row(i) = residual.transpose();
    solution.logit[i] = constant + bias(start, i) - per_px2 * residual.squaredNorm();
  }
  solution.log_likelihood = static_cast<double>(n) * std::log1p(-state.share) +
                            (1.0 + solution.logit.exp()).log().sum() -
                            0.5 * options_.stiffness * spline_.bending() / square(start.scale);
  return solution;
}

void Annealing::finish(const Start& start, Solution& solution) {
  State state = state_of(start);
  state.sigma_px = solution.sigma_px;
  state.share = solution.share;
  state.rounds = solution.rounds;
  spline_.set_control_px(solution.control_px);
  for (int round = 0; round < kLastRounds; ++round) {
    gather(start, state, kFinished);
    improve(start, state);
  }
  solution = conclude(start, state);
  for (Eigen::Index i = 0; i < matches_.count(); ++i) {
    const double residual2 = solution.residual_px.row(i).squaredNorm() / square(state.sigma_px);
    if (solution.logit[i] > kSure || residual2 > square(kFarSigmas)) continue;
    const double inflation = 1.0 + spline_.leverage(sites_[static_cast<std::size_t>(i)]);
    solution.logit[i] += 0.5 * residual2 * (1.0 - 1.0 / inflation) - std::log(inflation);
  }
}

}  // namespace weft::aem
