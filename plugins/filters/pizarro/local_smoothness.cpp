// SPDX-License-Identifier: Apache-2.0
#include "local_smoothness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/thin_plate_spline.hpp>

#include "common/nearest.hpp"
#include "robust_affine.hpp"

namespace weft::pizarro {
namespace {

using filters::Nearest;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kTrustedSigmas = 2.5;
constexpr double kSmoothing = 0.1;       // smoothing of the local splines
constexpr double kLargestRemoval = 0.2;  // share of the matches that a round may remove
constexpr double kLeastAgreement = 0.5;  // share of the neighbourhoods
constexpr int kFewestForSpline = 5;
constexpr int kWider = 3;  // as many neighbours where the nearest predict nothing

/// The result of a neighbourhood.
struct Opinion {
  double residual = kUnknown;        ///< residual of the match in its middle
  std::vector<std::uint8_t> agrees;  ///< 1 for each neighbour that agrees
};

class Neighbourhoods {
 public:
  Neighbourhoods(const Points2& p, const Points2& q, const Settings& settings, bool with_splines)
      : p_(p), q_(q), settings_(settings), with_splines_(with_splines) {}

  /// The result of the matches `row`, -1 for none, for match i and for each other.
  Opinion opinion(int i, const Eigen::Ref<const Eigen::RowVectorXi>& row) {
    const auto count = static_cast<int>((row.array() >= 0).count());
    Opinion opinion;
    opinion.agrees.assign(to_index(count), 0);
    if (count < 3) return opinion;
    Points2 p(count, 2), q(count, 2);
    for (int k = 0; k < count; ++k) {
      p.row(k) = p_.row(row[k]);
      q.row(k) = q_.row(row[k]);
    }
    const auto map = least_median_affine(p, q, triples_of(count));
    if (!map) return opinion;
    std::vector<int> trusted;
    for (int k = 0; k < count; ++k) {
      const double residual_px = ((*map)(p.row(k)) - q.row(k)).norm();
      if (residual_px < kTrustedSigmas * map->sigma_px) trusted.push_back(k);
    }
    const Points2 near_p = p(trusted, Eigen::all), near_q = q(trusted, Eigen::all);
    const double spread_px = spread(near_q);
    if (!(spread_px > 0.0)) return opinion;
    for (int k = 0; k < count; ++k) {
      const double residual_px = ((*map)(p.row(k)) - q.row(k)).norm();
      opinion.agrees[to_index(k)] = residual_px < settings_.theta * spread_px ? 1 : 0;
    }
    const Eigen::RowVector2d predicted = predict(p_.row(i), near_p, near_q, *map);
    opinion.residual = (predicted - q_.row(i)).norm() / spread_px;
    return opinion;
  }

 private:
  const std::vector<Triple>& triples_of(int count) {
    if (count != triples_for_) triples_ = spread_triples(count, settings_.triples);
    triples_for_ = count;
    return triples_;
  }

  Eigen::RowVector2d predict(const Eigen::RowVector2d& at, const Points2& p, const Points2& q,
                             const RobustAffine& map) const {
    if (with_splines_ && p.rows() >= kFewestForSpline) {
      const auto fitted = fit_thin_plate(p, q, Eigen::VectorXd::Constant(p.rows(), kSmoothing));
      if (fitted) return fitted->spline(at);
    }
    return map(at);
  }

  /// Median distance of places from the median place.
  static double spread(const Points2& places) {
    const Eigen::VectorXd x = places.col(0), y = places.col(1);
    const auto middle = [](const Eigen::VectorXd& values) {
      return median({values.data(), to_index(values.size())});
    };
    const Eigen::RowVector2d centre(middle(x), middle(y));
    return middle((places.rowwise() - centre).rowwise().norm());
  }

  const Points2 &p_, &q_;
  const Settings& settings_;
  bool with_splines_;
  int triples_for_ = -1;
  std::vector<Triple> triples_;
};

/// Opinions of the neighbourhoods of some matches; those that did not change are kept.
class Assembly {
 public:
  Assembly(const Points2& p, const Points2& q, const Settings& settings)
      : p_(p), settings_(settings), neighbourhoods_(p, q, settings, true) {
    opinions_.resize(to_index(p.rows()));
    silent_.resize(opinions_.size());
    nearest_ = Nearest::Constant(p.rows(), settings.neighbours, -2);
  }

  /// Among those that are left.
  void gather(const std::vector<int>& among, const std::vector<int>& asked) {
    const Nearest nearest = filters::nearest_of(p_, among, settings_.neighbours);
    std::vector<int> silent;
    for (const int i : asked) {
      const auto k = to_index(i);
      if (nearest.row(i) != nearest_.row(i)) {
        worked(20 * static_cast<std::int64_t>(settings_.triples));
        opinions_[k] = neighbourhoods_.opinion(i, nearest.row(i));
        nearest_.row(i) = nearest.row(i);
        silent_[k] = std::isnan(opinions_[k].residual) ? 1 : 0;
      }
      if (silent_[k] != 0) silent.push_back(i);
    }
    if (!silent.empty()) ask_further(among, silent);
  }

  const Opinion& opinion(int i) const { return opinions_[to_index(i)]; }

  /// The share of neighbourhoods that each match agrees with; unknown counts one half.
  std::vector<double> agreement(const std::vector<int>& among) const {
    std::vector<double> agreeing(opinions_.size(), 0.0), asked(opinions_.size(), 0.0);
    for (const int i : among) {
      const auto own = to_index(i);
      const double residual = opinions_[own].residual;
      asked[own] += 1.0;
      agreeing[own] += std::isnan(residual) ? 0.5 : residual < settings_.theta ? 1.0 : 0.0;
      if (std::isnan(residual)) continue;
      for (std::size_t k = 0; k < opinions_[own].agrees.size(); ++k) {
        const auto j = to_index(nearest_(i, static_cast<Eigen::Index>(k)));
        asked[j] += 1.0;
        agreeing[j] += opinions_[own].agrees[k];
      }
    }
    for (std::size_t i = 0; i < asked.size(); ++i) agreeing[i] /= std::max(1.0, asked[i]);
    return agreeing;
  }

 private:
  /// Uses more neighbours where the nearest lie on a line; the nearest are still tested for
  /// agreement.
  void ask_further(const std::vector<int>& among, const std::vector<int>& silent) {
    const Nearest wide = filters::nearest_of(p_, among, kWider * settings_.neighbours);
    for (const int i : silent) {
      Opinion opinion = neighbourhoods_.opinion(i, wide.row(i));
      worked(50 * static_cast<std::int64_t>(settings_.triples));
      const auto nearest = to_index(settings_.neighbours);
      opinion.agrees.resize(std::min(opinion.agrees.size(), nearest));
      opinions_[to_index(i)] = std::move(opinion);
    }
  }

  const Points2& p_;
  const Settings& settings_;
  Neighbourhoods neighbourhoods_;
  std::vector<Opinion> opinions_;
  std::vector<std::uint8_t> silent_;  ///< [n] whether the nearest neighbours predict nothing
  Nearest nearest_;
};

/// Takes away those that most neighbourhoods disagree with, the worst first.
bool remove_worst(std::vector<int>& among, const std::vector<double>& agreement) {
  std::vector<int> worst;
  for (const int i : among) {
    if (agreement[to_index(i)] < kLeastAgreement) worst.push_back(i);
  }
  std::stable_sort(worst.begin(), worst.end(),
                   [&](int a, int b) { return agreement[to_index(a)] < agreement[to_index(b)]; });
  const double most = std::ceil(kLargestRemoval * static_cast<double>(among.size()));
  worst.resize(std::min(worst.size(), to_index(most)));
  std::sort(worst.begin(), worst.end());
  std::erase_if(among, [&](int i) { return std::binary_search(worst.begin(), worst.end(), i); });
  return !worst.empty();
}

}  // namespace

Verdict locally_smooth(const Points2& in_template, const Points2& in_image,
                       const Settings& settings) {
  const auto n = static_cast<int>(in_template.rows());
  Settings used = settings;
  const bool few = n < kFewestLocal;
  if (few) used.triples = std::numeric_limits<int>::max();
  used.neighbours = few ? n - 1 : settings.neighbours;
  std::vector<int> all(to_index(n));
  std::iota(all.begin(), all.end(), 0);
  Verdict verdict;
  verdict.keep.assign(all.size(), 0);
  verdict.residual.assign(all.size(), kUnknown);
  std::vector<int> among = all;
  Assembly assembly(in_template, in_image, used);
  for (verdict.rounds = 0; !few && verdict.rounds < used.rounds; ++verdict.rounds) {
    assembly.gather(among, among);
    if (!remove_worst(among, assembly.agreement(among))) break;
  }
  assembly.gather(among, all);
  for (const int i : all) {
    const double residual = assembly.opinion(i).residual;
    verdict.residual[to_index(i)] = residual;
    verdict.keep[to_index(i)] = residual < used.theta ? 1 : 0;
  }
  return verdict;
}

}  // namespace weft::pizarro
