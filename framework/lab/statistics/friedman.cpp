// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/friedman.hpp"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <weft/core/rng.hpp>

namespace weft::lab {
namespace {

constexpr double kMostOrders = 50000.0;
constexpr std::size_t kMostPermuted = 2000;
constexpr int kPermutations = 9999;

/// Twice the ranks of a sequence [treatments]: whole numbers even where ranks are averaged.
using Ranks = std::vector<std::int64_t>;

Ranks doubled_ranks(const std::vector<double>& values) {
  Ranks ranks;
  for (const double value : values) {
    const auto less = std::count_if(values.begin(), values.end(),
                                    [value](double other) { return other < value; });
    const auto equal = std::count(values.begin(), values.end(), value);
    ranks.push_back(2 * less + equal + 1);
  }
  return ranks;
}

/// Grows with chi-squared while the ranks of each sequence only change places.
std::int64_t sum_of_squares(const Ranks& sums) {
  std::int64_t total = 0;
  for (const std::int64_t sum : sums) total += sum * sum;
  return total;
}

void add(const Ranks& ranks, std::int64_t factor, Ranks& sums) {
  for (std::size_t t = 0; t < sums.size(); ++t) sums[t] += factor * ranks[t];
}

Ranks total_of(const std::vector<Ranks>& table) {
  Ranks sums(table.front().size());
  for (const Ranks& ranks : table) add(ranks, 1, sums);
  return sums;
}

double chi_squared_of(const std::vector<Ranks>& table, const Ranks& sums) {
  const auto n = static_cast<double>(table.size()), k = static_cast<double>(sums.size());
  double between = 0.0, within = 0.0;
  for (const std::int64_t sum : sums) {
    between += std::pow(0.5 * static_cast<double>(sum) - 0.5 * n * (k + 1.0), 2);
  }
  for (const Ranks& ranks : table) {
    for (const std::int64_t rank : ranks) {
      within += std::pow(0.5 * static_cast<double>(rank) - 0.5 * (k + 1.0), 2);
    }
  }
  return within > 0.0 ? (k - 1.0) * between / within : 0.0;
}

/// Every order of every sequence but the first, which may stay as it is: the treatments' names do
/// not matter. Counts the orders and those whose sum of squares is at least `least`.
struct OrderCount {
  const std::vector<Ranks>& table;
  std::int64_t least;
  std::int64_t orders = 0, extreme = 0;

  void visit(std::size_t sequence, Ranks& sums) {
    if (sequence == table.size()) {
      ++orders;
      extreme += sum_of_squares(sums) >= least;
      return;
    }
    Ranks ranks = table[sequence];
    std::sort(ranks.begin(), ranks.end());
    do {
      add(ranks, 1, sums);
      visit(sequence + 1, sums);
      add(ranks, -1, sums);
    } while (std::next_permutation(ranks.begin(), ranks.end()));
  }
};

double exact_p(const std::vector<Ranks>& table, std::int64_t least) {
  OrderCount count{table, least};
  Ranks sums = table.front();
  count.visit(1, sums);
  return static_cast<double>(count.extreme) / static_cast<double>(count.orders);
}

double permuted_p(std::vector<Ranks> table, std::int64_t least, std::uint64_t seed) {
  Rng rng(seed);
  int extreme = 0;
  for (int i = 0; i < kPermutations; ++i) {
    for (Ranks& ranks : table) rng.shuffle(ranks);
    extreme += sum_of_squares(total_of(table)) >= least;
  }
  return (1.0 + extreme) / (1.0 + kPermutations);
}

double f_distribution_p(double chi_squared, double n, double k) {
  const double rest = n * (k - 1.0) - chi_squared;
  if (!(rest > 0.0)) return 0.0;
  const boost::math::fisher_f f(k - 1.0, (k - 1.0) * (n - 1.0));
  return boost::math::cdf(boost::math::complement(f, (n - 1.0) * chi_squared / rest));
}

double count_of_orders(const std::vector<Ranks>& table) {
  const double orders = std::tgamma(static_cast<double>(table.front().size()) + 1.0);
  return std::pow(orders, static_cast<double>(table.size() - 1));
}

bool is_table(const std::vector<std::vector<double>>& values) {
  return !values.empty() && values.front().size() >= 2 &&
         std::all_of(values.begin(), values.end(), [&](const std::vector<double>& row) {
           return row.size() == values.front().size() &&
                  std::all_of(row.begin(), row.end(), [](double x) { return std::isfinite(x); });
         });
}

}  // namespace

Result<Friedman> friedman(const std::vector<std::vector<double>>& values, std::uint64_t seed) {
  if (!is_table(values)) {
    return Error{Errc::invalid_value,
                 "Friedman's test needs a finite value of two or more treatments in each sequence"};
  }
  std::vector<Ranks> table;
  for (const std::vector<double>& row : values) table.push_back(doubled_ranks(row));
  const Ranks sums = total_of(table);
  const std::size_t n = table.size(), k = sums.size();
  Friedman result;
  for (const std::int64_t sum : sums) {
    result.mean_ranks.push_back(0.5 * static_cast<double>(sum) / static_cast<double>(n));
  }
  result.chi_squared = chi_squared_of(table, sums);
  if (count_of_orders(table) <= kMostOrders) {
    result.p = exact_p(table, sum_of_squares(sums));
  } else if (n * k <= kMostPermuted) {
    result.method = FriedmanMethod::permutations;
    result.p = permuted_p(std::move(table), sum_of_squares(sums), seed);
  } else {
    result.method = FriedmanMethod::f_distribution;
    result.p = f_distribution_p(result.chi_squared, static_cast<double>(n), static_cast<double>(k));
  }
  return result;
}

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isnan(p[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [p](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> corrected(p.begin(), p.end());
  double largest = 0.0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const double step = static_cast<double>(order.size() - rank) * p[order[rank]];
    largest = std::max(largest, std::min(1.0, step));
    corrected[order[rank]] = largest;
  }
  return corrected;
}

}  // namespace weft::lab
