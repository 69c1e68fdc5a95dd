// SPDX-License-Identifier: Apache-2.0
#include "statistics/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace weft::evaluation {
namespace {

/// Three digits; zero has no sign.
std::string three_digits(double value) { return fmt::format("{:.3g}", value + 0.0); }

std::string with_unit(double value, const std::string& unit) {
  return three_digits(value) + (unit.empty() ? "" : " " + unit);
}

std::string interval_text(Interval interval, const std::string& unit) {
  return fmt::format("95 % interval {} to {}", three_digits(interval.low),
                     with_unit(interval.high, unit));
}

std::string p_text(double p, double p_holm, std::int64_t tests) {
  if (std::isnan(p_holm) || tests < 2) return "p = " + three_digits(p);
  return fmt::format("p = {} after Holm's correction for {} tests", three_digits(p_holm), tests);
}

std::string figures_of(const PairComparison& pair, const std::string& unit, std::int64_t tests) {
  std::string text = fmt::format("{} - {} = {}", pair.a, pair.b, with_unit(pair.test.mean, unit));
  if (!std::isnan(pair.test.interval.low)) text += ", " + interval_text(pair.test.interval, unit);
  return fmt::format("{}, n = {} sequences, {}", text, pair.test.n,
                     p_text(pair.test.p, pair.p_holm, tests));
}

std::string too_few_text(const PairComparison& pair, const ComparisonOptions& options,
                         std::int64_t tests) {
  std::string text =
      fmt::format("Too few to decide between {} and {} in {}: ", pair.a, pair.b, options.measure);
  if (pair.test.n >= kLeastSequences) {
    text += fmt::format("with {} tests {} sequences could call none", tests, pair.test.n);
  } else {
    text += fmt::format("{} of at least {} sequences", pair.test.n, kLeastSequences);
  }
  return pair.test.n == 0 ? text + "." : text + "; " + figures_of(pair, options.unit, tests) + ".";
}

std::string undecided_text(const PairComparison& pair, const ComparisonOptions& options,
                           std::int64_t tests) {
  const Interval& interval = pair.test.interval;
  if (interval.low == 0.0 && interval.high == 0.0) {
    return fmt::format("{} and {} have the same {} on each of {} sequences.", pair.a, pair.b,
                       options.measure, pair.test.n);
  }
  std::string text = fmt::format("No difference between {} and {} is shown in {}: {}", pair.a,
                                 pair.b, options.measure, figures_of(pair, options.unit, tests));
  if (!std::isnan(pair.smallest_effect)) {
    text += fmt::format("; a difference of {} would be shown 4 times in 5",
                        with_unit(pair.smallest_effect, options.unit));
  }
  return text + ".";
}

std::string decided_text(const PairComparison& pair, const ComparisonOptions& options,
                         std::int64_t tests) {
  const bool a_wins = pair.call == Call::a;
  const PairedTest& test = pair.test;
  const Interval gain =
      test.mean < 0.0 ? Interval{-test.interval.high, -test.interval.low} : test.interval;
  return fmt::format(
      "{} has a {} {} than {}, by {}: {}, {}n = {} sequences, {}.", a_wins ? pair.a : pair.b,
      options.better == Better::lower ? "lower" : "higher", options.measure,
      a_wins ? pair.b : pair.a, with_unit(std::abs(test.mean), options.unit),
      interval_text(gain, options.unit),
      std::isnan(test.standardised)
          ? ""
          : "standardised effect " + three_digits(std::abs(test.standardised)) + ", ",
      test.n, p_text(test.p, pair.p_holm, tests));
}

std::string values_text(const PairComparison& pair, const ComparisonOptions& options,
                        std::int64_t tests) {
  if (decided(pair.call)) return decided_text(pair, options, tests);
  return pair.call == Call::too_few ? too_few_text(pair, options, tests)
                                    : undecided_text(pair, options, tests);
}

std::string failures_text(const PairComparison& pair, std::int64_t tests) {
  const FailurePair& failures = pair.failures;
  const std::int64_t of_a = failures.only_a + failures.both;
  const std::int64_t of_b = failures.only_b + failures.both;
  if (of_a + of_b == 0) return fmt::format(" No failures in {} results of each.", failures.rows);
  const std::string counts = fmt::format(" Failures in {} results of each: {} {}, {} {};",
                                         failures.rows, pair.a, of_a, pair.b, of_b);
  const std::string p = p_text(failures.test.p, failures.p_holm, tests);
  if (decided(failures.call)) {
    return fmt::format("{} {} fails less ({}).", counts, failures.call == Call::a ? pair.a : pair.b,
                       p);
  }
  if (failures.call == Call::too_few) return counts + " too few to decide.";
  return fmt::format("{} no difference is shown ({}).", counts, p);
}

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string unpaired_text(const std::string& name, const std::vector<PanelPlace>& places) {
  if (places.empty()) return "";
  return fmt::format(" Left out: {} results that {} lacks, the first at {}.", places.size(), name,
                     to_string(places.front()));
}

std::string left_out_text(const PairComparison& pair) {
  std::string text = unpaired_text(pair.a, pair.without_a) + unpaired_text(pair.b, pair.without_b);
  if (pair.sequences_without_pair.empty()) return text;
  return text + fmt::format(" Sequences without a pair of values: {}.",
                            list_of(pair.sequences_without_pair));
}

/// How often a treatment is the better and how often the worse of a pair.
struct Standing {
  std::string name;
  std::size_t better = 0, worse = 0;
};

std::vector<Standing> standings_of(const ComparisonTable& table) {
  std::vector<Standing> records;
  for (const TreatmentSummary& each : table.treatments) {
    Standing record{each.name};
    for (const PairComparison& pair : table.pairs) {
      const bool is_a = pair.a == each.name, is_b = pair.b == each.name;
      record.better += (is_a && pair.verdict == Call::a) || (is_b && pair.verdict == Call::b);
      record.worse += (is_a && pair.verdict == Call::b) || (is_b && pair.verdict == Call::a);
    }
    records.push_back(record);
  }
  return records;
}

std::string against_reference(const std::vector<Standing>& records, const std::string& reference) {
  std::vector<std::string> better, worse;
  for (const Standing& record : records) {
    if (record.name == reference) continue;
    if (record.better > 0) better.push_back(record.name);
    if (record.worse > 0) worse.push_back(record.name);
  }
  const auto names = [](const std::vector<std::string>& list) {
    return list.empty() ? std::string("nothing") : list_of(list);
  };
  const std::size_t others = records.size() - 1 - better.size() - worse.size();
  return fmt::format("Better than {}: {}. Worse: {}.{}", reference, names(better), names(worse),
                     others > 0 ? fmt::format(" Of the other {} nothing is said.", others) : "");
}

}  // namespace

std::string sentence_of(const PairComparison& pair, const ComparisonOptions& options,
                        std::int64_t tests) {
  const bool contradict =
      decided(pair.call) && decided(pair.failures.call) && pair.call != pair.failures.call;
  return values_text(pair, options, tests) + failures_text(pair, tests) +
         (contradict ? " Neither is named the better." : "") + left_out_text(pair);
}

std::string sentence_of(const FriedmanComparison& friedman) {
  const std::size_t n = friedman.sequences.size();
  std::string text;
  if (static_cast<std::int64_t>(n) < kLeastSequences) {
    text = fmt::format(
        "Too few to rank the treatments: {} of at least {} sequences have a result "
        "where each has a value.",
        n, kLeastSequences);
  } else {
    text = fmt::format(
        "{}: Friedman's chi-squared = {}, n = {} sequences, p = {} after Holm's "
        "correction.",
        friedman.differ ? "Some treatments differ in rank" : "No difference in rank is shown",
        three_digits(friedman.test.chi_squared), n, three_digits(friedman.p_holm));
  }
  if (friedman.left_out.empty()) return text;
  return text + fmt::format(" Left out: {}.", list_of(friedman.left_out));
}

std::string headline_of(const ComparisonTable& table, const ComparisonOptions& options) {
  if (table.pairs.empty()) return "There is nothing to compare: one treatment only.";
  const auto all = [&](Call call) {
    return std::all_of(table.pairs.begin(), table.pairs.end(),
                       [call](const PairComparison& pair) { return pair.verdict == call; });
  };
  if (all(Call::too_few)) return "Too few to decide.";
  const std::vector<Standing> records = standings_of(table);
  if (!options.reference.empty()) return against_reference(records, options.reference);
  for (const Standing& record : records) {
    if (record.better + 1 == records.size()) {
      return fmt::format("{} is better than each of the others.", record.name);
    }
  }
  return "No winner: no treatment is told from each of the others.";
}

}  // namespace weft::evaluation
