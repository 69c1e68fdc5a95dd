// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::aem {
namespace {

constexpr double kWeakSeed = 0.5;   // share of the best score, below which a seed is not annealed
constexpr double kExplained = 0.8;  // share of the matches that follow a seed
constexpr double kFewFollow = 0.2;  // share of the winner's matches, with which a seed is no rival
constexpr double kDistinctGap =
    0.1;  // mean gap between different warps, of the template's diagonal

/// A solution and where it started.
struct Candidate {
  Start start;
  Solution solution;
};

class ObjectSearch {
 public:
  ObjectSearch(const Matches& matches, const SearchOptions& options, Rng& rng)
      : matches_(matches), options_(options), rng_(rng), annealing_(matches, options.annealing) {}

  std::optional<Found> run(const std::optional<Track>& track) {
    std::optional<Candidate> tracked;
    if (track) tracked = annealed(annealing_.start_along(track->flat_px, track->image_px));
    const bool is_sure = tracked && confidence_of(*tracked) >= options_.sure;
    std::optional<Candidate> free = best_of(draw_seeds(matches_, all(), options_.most_draws, rng_),
                                            is_sure ? &tracked->solution : nullptr);
    if (!free && !tracked) return {};
    if (tracked && (!free || is_sure)) {
      const double rival = free && are_distinct(*tracked, *free) ? ratio(*free, *tracked) : 0.0;
      return found(*tracked, true, rival, rival > 1.0 ? kAmbiguous : 1.0);
    }
    const double rival = rival_of(*free);
    return found(*free, false, rival, trust_beside(rival));
  }

 private:
  std::vector<Eigen::Index> all() const {
    std::vector<Eigen::Index> rows(to_index(matches_.count()));
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<Eigen::Index>(i);
    return rows;
  }

  Candidate annealed(Start start) {
    Solution solution = annealing_.run(start);
    return {std::move(start), std::move(solution)};
  }

  /// Nothing where all seeds lead to the solution that is `known` already.
  std::optional<Candidate> best_of(const Seeds& seeds, const Solution* known) {
    draws_ = std::max(draws_, seeds.draws);
    std::optional<Candidate> best;
    for (const Seed& seed : seeds.best) {
      if (seed.score < kWeakSeed * seeds.best.front().score) break;
      Start start = start_from(matches_, seed);
      if (known != nullptr && explained(start, seed.threshold_px, *known)) continue;
      if (best && explained(start, seed.threshold_px, best->solution)) continue;
      Candidate next = annealed(std::move(start));
      if (!best || next.solution.log_likelihood > best->solution.log_likelihood) {
        best = std::move(next);
      }
    }
    return best;
  }

  /// True if the matches that follow a seed belong to a solution already: then it would lead there
  /// again.
  bool explained(const Start& start, double threshold_px, const Solution& solution) const {
    const Eigen::Array<bool, Eigen::Dynamic, 1> follows =
        (start.image_px - matches_.image_px).rowwise().norm().array() < threshold_px;
    const auto both = static_cast<double>((follows && solution.logit > 0.0).count());
    return both > kExplained * static_cast<double>(follows.count());
  }

  /// How likely the best set among the matches that `winner` leaves is, in parts of its likelihood.
  double rival_of(const Candidate& winner) {
    std::vector<Eigen::Index> left;
    for (Eigen::Index i = 0; i < matches_.count(); ++i) {
      if (winner.solution.logit[i] < 0.0) left.push_back(i);
    }
    if (left.size() < 3 || !(winner.solution.log_likelihood > 0.0)) return 0.0;
    const Seeds seeds = draw_seeds(matches_, left, draws_, rng_);
    const auto of_winner = static_cast<double>(winner.solution.correct());
    if (seeds.best.empty() ||
        seeds.best.front().share * static_cast<double>(left.size()) < kFewFollow * of_winner) {
      return 0.0;
    }
    const Candidate rival = annealed(start_from(matches_, seeds.best.front()));
    return are_distinct(winner, rival) ? std::max(0.0, ratio(rival, winner)) : 0.0;
  }

  static double ratio(const Candidate& a, const Candidate& b) {
    return a.solution.log_likelihood / std::max(b.solution.log_likelihood, 1e-9);
  }

  bool are_distinct(const Candidate& a, const Candidate& b) const {
    const double gap_px = (a.solution.residual_px - b.solution.residual_px).rowwise().norm().mean();
    return gap_px > kDistinctGap * a.start.scale * matches_.diagonal_px();
  }

  double confidence_of(const Candidate& candidate) const {
    return confidence({candidate.solution.log_likelihood, static_cast<double>(matches_.count()),
                       static_cast<double>(candidate.solution.correct()),
                       candidate.solution.sigma_px / options_.annealing.least_sigma_px});
  }

  Found found(Candidate& candidate, bool tracked, double rival, double trust) {
    annealing_.finish(candidate.start, candidate.solution);
    return {candidate.solution,
            candidate.start.scale,
            trust * confidence_of(candidate),
            rival,
            tracked,
            draws_};
  }

  const Matches& matches_;
  const SearchOptions& options_;
  Rng& rng_;
  Annealing annealing_;
  int draws_ = 0;
};

}  // namespace

std::optional<Found> find_object(const Matches& matches, const std::optional<Track>& track,
                                 const SearchOptions& options, Rng& rng) {
  return ObjectSearch(matches, options, rng).run(track);
}

}  // namespace weft::aem
