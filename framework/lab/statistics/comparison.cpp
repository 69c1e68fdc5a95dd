// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/comparison.hpp"

#include <algorithm>
#include <iterator>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "lab/statistics/bootstrap.hpp"
#include "lab/statistics/verdict.hpp"

namespace weft::lab {
namespace {

using Value = std::optional<double>;

TreatmentSummary summarise(const Panel& panel, std::size_t treatment, std::uint64_t seed) {
  TreatmentSummary summary;
  summary.name = panel.treatments[treatment];
  for (const PanelRow& row : panel.rows) {
    summary.rows += row.present(treatment);
    summary.failures += row.failed(treatment);
  }
  const auto means = means_of(sequence_means(panel, [treatment](const PanelRow& row) {
    return row.has_value(treatment) ? row.results[treatment] : Value();
  }));
  summary.sequences = static_cast<std::int64_t>(means.size());
  summary.mean = mean(means);
  summary.median = median(means);
  summary.interval = bootstrap_interval(means, seed);
  return summary;
}

/// Names in the first list that are not in the second; both ascend.
std::vector<std::string> missing_from(const std::vector<std::string>& all,
                                      const std::vector<SequenceMean>& some) {
  std::vector<std::string> names, missing;
  for (const SequenceMean& each : some) names.push_back(each.sequence);
  std::set_difference(all.begin(), all.end(), names.begin(), names.end(),
                      std::back_inserter(missing));
  return missing;
}

FailurePair pair_failures(const Panel& panel, std::size_t a, std::size_t b, std::uint64_t seed) {
  FailurePair pair;
  for (const PanelRow& row : panel.rows) {
    if (!row.present(a) || !row.present(b)) continue;
    ++pair.rows;
    pair.both += row.failed(a) && row.failed(b);
    pair.only_a += row.failed(a) && !row.failed(b);
    pair.only_b += row.failed(b) && !row.failed(a);
  }
  const auto shares = means_of(sequence_means(panel, [a, b](const PanelRow& row) {
    if (!row.present(a) || !row.present(b)) return Value();
    return Value(static_cast<double>(row.failed(a)) - static_cast<double>(row.failed(b)));
  }));
  pair.test = test_differences(shares, seed);
  return pair;
}

PairComparison pair_up(const Panel& panel, std::size_t a, std::size_t b, std::uint64_t seed) {
  PairComparison pair;
  pair.a = panel.treatments[a];
  pair.b = panel.treatments[b];
  for (const PanelRow& row : panel.rows) {
    if (row.present(a) && !row.present(b)) pair.without_b.push_back(row.place);
    if (row.present(b) && !row.present(a)) pair.without_a.push_back(row.place);
    pair.rows += row.has_value(a) && row.has_value(b);
  }
  const auto differences = sequence_means(panel, [a, b](const PanelRow& row) {
    if (!row.has_value(a) || !row.has_value(b)) return Value();
    return Value(*row.results[a] - *row.results[b]);
  });
  const auto mean_of = [&panel, a, b](std::size_t treatment) {
    return mean(means_of(sequence_means(panel, [=](const PanelRow& row) {
      return row.has_value(a) && row.has_value(b) ? row.results[treatment] : Value();
    })));
  };
  pair.mean_a = mean_of(a);
  pair.mean_b = mean_of(b);
  pair.sequences_without_pair = missing_from(panel.sequences(), differences);
  pair.differences = means_of(differences);
  pair.test = test_differences(pair.differences, seed);
  pair.failures = pair_failures(panel, a, b, seed);
  return pair;
}

std::vector<PairComparison> pair_all(const Panel& panel, const ComparisonOptions& options) {
  std::vector<PairComparison> pairs;
  for (std::size_t a = 0; a < panel.treatments.size(); ++a) {
    for (std::size_t b = 0; b < panel.treatments.size(); ++b) {
      const bool wanted =
          options.reference.empty() ? a < b : a != b && panel.treatments[b] == options.reference;
      if (wanted) pairs.push_back(pair_up(panel, a, b, options.seed));
    }
  }
  return pairs;
}

std::optional<FriedmanComparison> rank_all(const Panel& panel, const ComparisonOptions& options) {
  const std::size_t count = panel.treatments.size();
  if (count < 3) return std::nullopt;
  FriedmanComparison comparison;
  std::vector<std::vector<double>> values;
  const double sign = options.better == Better::lower ? 1.0 : -1.0;
  for (std::size_t t = 0; t < count; ++t) {
    const auto means = sequence_means(panel, [count, sign, t](const PanelRow& row) {
      for (std::size_t each = 0; each < count; ++each) {
        if (!row.has_value(each)) return Value();
      }
      return Value(sign * *row.results[t]);
    });
    values.resize(means.size());
    for (std::size_t s = 0; s < means.size(); ++s) values[s].push_back(means[s].mean);
    if (t > 0) continue;
    comparison.left_out = missing_from(panel.sequences(), means);
    for (const SequenceMean& each : means) comparison.sequences.push_back(each.sequence);
  }
  if (auto test = friedman(values, options.seed)) comparison.test = *std::move(test);
  return comparison;
}

bool possible(const FriedmanComparison& friedman) {
  return static_cast<std::int64_t>(friedman.sequences.size()) >= kLeastSequences;
}

/// The p of all tests that could call something, ascending, as Holm's correction takes them.
class CorrectedTests {
 public:
  explicit CorrectedTests(std::vector<double> p) : p_(std::move(p)) {
    std::sort(p_.begin(), p_.end());
    while (called_ < p_.size() && p_[called_] <= level_after(called_)) ++called_;
  }

  std::int64_t tests() const { return static_cast<std::int64_t>(p_.size()); }

  /// The significance level of a p after all smaller ones, if all of these are significant.
  double level_of(double p) const { return level_after(std::min(before(p), called_)); }

  /// True if this p would be significant.
  bool would_call(double p) const { return before(p) <= called_ && p <= level_after(before(p)); }

 private:
  std::size_t before(double p) const {
    return to_index(std::lower_bound(p_.begin(), p_.end(), p) - p_.begin());
  }
  double level_after(std::size_t smaller) const {
    const std::size_t left = p_.size() > smaller ? p_.size() - smaller : 1;
    return kAlpha / static_cast<double>(left);
  }

  std::vector<double> p_;
  std::size_t called_ = 0;
};

/// Corrects every p that could be called for the number of them.
CorrectedTests correct(std::vector<ComparisonTable>& tables) {
  struct Hypothesis {
    double p;
    double* corrected;
  };
  std::vector<Hypothesis> family;
  for (ComparisonTable& table : tables) {
    for (PairComparison& pair : table.pairs) {
      FailurePair& failures = pair.failures;
      if (pair.test.possible()) family.push_back({pair.test.p, &pair.p_holm});
      if (failures.test.possible()) family.push_back({failures.test.p, &failures.p_holm});
    }
    if (table.friedman && possible(*table.friedman)) {
      family.push_back({table.friedman->test.p, &table.friedman->p_holm});
    }
  }
  std::vector<double> p;
  for (const Hypothesis& each : family) p.push_back(each.p);
  const std::vector<double> corrected = holm(p);
  for (std::size_t i = 0; i < family.size(); ++i) *family[i].corrected = corrected[i];
  for (ComparisonTable& table : tables) table.tests = static_cast<std::int64_t>(family.size());
  return CorrectedTests(std::move(p));
}

/// Which of two is better by a test of a - b.
Call call_of(const PairedTest& test, double p_holm, Better better, const CorrectedTests& family) {
  if (test.n < kLeastSequences) return Call::too_few;
  if (p_holm <= kAlpha) return (test.mean < 0.0) == (better == Better::lower) ? Call::a : Call::b;
  return family.would_call(least_p_of(test.n)) ? Call::undecided : Call::too_few;
}

Call verdict_of(Call values, Call failures) {
  if (!decided(failures) || failures == values) return values;
  return decided(values) ? Call::undecided : failures;
}

void decide(const ComparisonOptions& options, const CorrectedTests& family, PairComparison& pair) {
  const std::int64_t tests = family.tests();
  FailurePair& failures = pair.failures;
  pair.call = call_of(pair.test, pair.p_holm, options.better, family);
  if (pair.call != Call::too_few) {
    pair.interval = interval_at(pair.differences, family.level_of(pair.test.p), options.seed);
  }
  pair.hidden_by_ties = pair.call == Call::undecided && !family.would_call(pair.test.least_p);
  failures.call = call_of(failures.test, failures.p_holm, Better::lower, family);
  pair.verdict = verdict_of(pair.call, failures.call);
  const double level = kAlpha / static_cast<double>(std::max<std::int64_t>(1, tests));
  pair.smallest_effect = smallest_effect(pair.test.standard_deviation, pair.test.n, level);
  pair.sentence = sentence_of(pair, options, tests);
}

bool has(const Panel& panel, const std::string& treatment) {
  const auto& names = panel.treatments;
  return std::find(names.begin(), names.end(), treatment) != names.end();
}

/// The results before the correction.
ComparisonTable table_of(const Panel& panel, const ComparisonOptions& options) {
  ComparisonTable table;
  for (std::size_t t = 0; t < panel.treatments.size(); ++t) {
    table.treatments.push_back(summarise(panel, t, options.seed));
  }
  table.pairs = pair_all(panel, options);
  table.friedman = rank_all(panel, options);
  return table;
}

void decide(const ComparisonOptions& options, const CorrectedTests& family,
            const std::string& where, ComparisonTable& table) {
  for (PairComparison& pair : table.pairs) decide(options, family, pair);
  if (table.friedman) {
    table.friedman->differ = table.friedman->p_holm <= kAlpha;
    table.friedman->sentence = sentence_of(*table.friedman);
  }
  table.headline = headline_of(table, options, where);
}

}  // namespace

Result<ComparisonTable> compare(const std::vector<Observation>& observations,
                                const ComparisonOptions& options) {
  const auto panel = make_panel(observations);
  if (!panel) return panel.error();
  if (!options.reference.empty() && !has(*panel, options.reference)) {
    return Error{Errc::not_found,
                 "the reference '" + options.reference + "' is none of the treatments"};
  }
  std::vector<ComparisonTable> tables{table_of(*panel, options)};
  decide(options, correct(tables), "", tables.front());
  return std::move(tables.front());
}

Result<std::vector<ComparisonTable>> compare_separately(const std::vector<ObservationGroup>& groups,
                                                        const ComparisonOptions& options) {
  std::vector<ComparisonTable> tables;
  for (const ObservationGroup& group : groups) {
    ComparisonTable& table = tables.emplace_back();
    if (group.observations.empty()) continue;
    const auto panel = make_panel(group.observations);
    if (!panel) return panel.error();
    table = table_of(*panel, options);
  }
  const CorrectedTests family = correct(tables);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    decide(options, family, groups[i].where, tables[i]);
  }
  return tables;
}

}  // namespace weft::lab
