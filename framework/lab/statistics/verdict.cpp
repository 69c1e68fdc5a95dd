// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/verdict.hpp"

#include <fmt/format.h>

#include <cmath>

#include "lab/statistics/sentence_parts.hpp"

namespace weft::lab {
namespace {

std::string too_few_text(const PairComparison& pair, const ComparisonOptions& options,
                         std::int64_t tests, const std::string& where) {
  std::string text = begun(where, "Too few sequences to compare ") + pair.a + " with " + pair.b +
                     " in " + options.measure + ": ";
  if (pair.test.n >= kLeastSequences) {
    text += fmt::format("with {} tests {} could call nothing", tests, pair.test.n);
  } else {
    text += fmt::format("{} of at least {}", pair.test.n, kLeastSequences);
  }
  if (pair.test.n == 0) return text;
  return text + "; " + two_means(pair.mean_a, "and", pair.mean_b, options.unit);
}

/// Sequences on which both are the same call nothing, and may be why nothing is called.
std::string ties_text(const PairComparison& pair) {
  const PairedTest& test = pair.test;
  if (test.ties == 0) return "";
  const std::string text = fmt::format(", the same on {} of them", test.ties);
  if (!pair.hidden_by_ties) return text;
  const std::int64_t others = test.n - test.ties;
  return fmt::format("{}: the other {} {} too few to call a difference", text, others,
                     others == 1 ? "is" : "are");
}

std::string undecided_text(const PairComparison& pair, const ComparisonOptions& options,
                           std::int64_t tests, const std::string& where) {
  const std::string names = begun_by_name(where, pair.a) + " and " + pair.b;
  if (pair.test.ties == pair.test.n) {
    return fmt::format("{} have the same {} on each of {}", names, options.measure,
                       sequences_text(pair.test.n));
  }
  return fmt::format("{} do not differ significantly: {} {}, a difference of {}, {}{}", names,
                     options.measure, two_means(pair.mean_a, "and", pair.mean_b, options.unit),
                     with_unit(gain_of(pair).mean, difference_unit(options.unit)),
                     evidence_of(pair, options.unit, tests), ties_text(pair));
}

std::string decided_text(const PairComparison& pair, const ComparisonOptions& options,
                         std::int64_t tests, const std::string& where) {
  const bool a_wins = pair.call == Call::a;
  return fmt::format("{} is better than {} by {}: {} {}, {}",
                     begun_by_name(where, a_wins ? pair.a : pair.b), a_wins ? pair.b : pair.a,
                     with_unit(gain_of(pair).mean, difference_unit(options.unit)), options.measure,
                     two_means(a_wins ? pair.mean_a : pair.mean_b, "instead of",
                               a_wins ? pair.mean_b : pair.mean_a, options.unit),
                     evidence_of(pair, options.unit, tests));
}

std::string values_text(const PairComparison& pair, const ComparisonOptions& options,
                        std::int64_t tests, const std::string& where) {
  if (decided(pair.call)) return decided_text(pair, options, tests, where);
  return pair.call == Call::too_few ? too_few_text(pair, options, tests, where)
                                    : undecided_text(pair, options, tests, where);
}

bool contradict(const PairComparison& pair) {
  return decided(pair.call) && decided(pair.failures.call) && pair.call != pair.failures.call;
}

/// "it has no value in 1 of 40 results, a in 20".
std::string who_lacks_less(const PairComparison& pair, std::int64_t tests) {
  const FailurePair& failures = pair.failures;
  const bool a_less = failures.call == Call::a;
  return fmt::format("{} has no value in {} of {} results, {} in {} ({})", a_less ? pair.a : pair.b,
                     failures.both + (a_less ? failures.only_a : failures.only_b), failures.rows,
                     a_less ? pair.b : pair.a,
                     failures.both + (a_less ? failures.only_b : failures.only_a),
                     p_text(failures.test.p, failures.p_holm, tests));
}

/// Adds the standardised effect, or the smallest effect that the test could have detected.
std::string power_text(const PairComparison& pair, const ComparisonOptions& options) {
  if (decided(pair.call) && !std::isnan(pair.test.standardised)) {
    return "; standardised effect " + three_digits(std::abs(pair.test.standardised));
  }
  const bool equal = pair.test.ties == pair.test.n;
  if (pair.call != Call::undecided || equal || std::isnan(pair.smallest_effect)) return "";
  return fmt::format("; a difference of {} would be shown 4 times in 5",
                     with_unit(pair.smallest_effect, difference_unit(options.unit)));
}

std::string failures_text(const PairComparison& pair, std::int64_t tests) {
  const FailurePair& failures = pair.failures;
  const std::int64_t of_a = failures.only_a + failures.both;
  const std::int64_t of_b = failures.only_b + failures.both;
  if (of_a + of_b == 0) return fmt::format(" Each has a value in all {} results.", failures.rows);
  const std::string counts = fmt::format(" Without a value, of {} results of each: {} {}, {} {};",
                                         failures.rows, pair.a, of_a, pair.b, of_b);
  const std::string p = p_text(failures.test.p, failures.p_holm, tests);
  if (decided(failures.call)) {
    return fmt::format("{} {} lacks fewer ({}).", counts,
                       failures.call == Call::a ? pair.a : pair.b, p);
  }
  if (failures.call == Call::too_few) return counts + " too few to decide.";
  return fmt::format("{} no difference is shown ({}{}).", counts, p,
                     failures.test.ties == 0
                         ? ""
                         : fmt::format("; {} of {} sequences differ in it",
                                       failures.test.n - failures.test.ties, failures.test.n));
}

std::string unpaired_text(const std::string& name, const std::vector<PanelPlace>& places) {
  if (places.empty()) return "";
  return fmt::format(" Omitted: {} results that {} lacks, the first at {}.", places.size(), name,
                     to_string(places.front()));
}

std::string left_out_text(const PairComparison& pair) {
  std::string text = unpaired_text(pair.a, pair.without_a) + unpaired_text(pair.b, pair.without_b);
  if (pair.sequences_without_pair.empty()) return text;
  return text + fmt::format(" Sequences without a pair of values: {}.",
                            list_of(pair.sequences_without_pair));
}

}  // namespace

std::string brief_sentence_of(const PairComparison& pair, const ComparisonOptions& options,
                              std::int64_t tests, const std::string& where) {
  if (contradict(pair)) {
    return begun(where, "Neither of ") + pair.a + " and " + pair.b +
           " is named the better: " + values_text(pair, options, tests, "") + ", but " +
           who_lacks_less(pair, tests) + ".";
  }
  if (!decided(pair.call) && decided(pair.failures.call)) {
    const bool a_wins = pair.failures.call == Call::a;
    return begun_by_name(where, a_wins ? pair.a : pair.b) + " is better than " +
           (a_wins ? pair.b : pair.a) + ": " + who_lacks_less(pair, tests) + ". " +
           values_text(pair, options, tests, "") + ".";
  }
  const std::string text = values_text(pair, options, tests, where);
  const bool fails = pair.failures.only_a + pair.failures.only_b + pair.failures.both > 0;
  return text + "." + (fails ? failures_text(pair, tests) : "");
}

std::string sentence_of(const PairComparison& pair, const ComparisonOptions& options,
                        std::int64_t tests) {
  return values_text(pair, options, tests, "") + power_text(pair, options) + "." +
         failures_text(pair, tests) + (contradict(pair) ? " Neither is named the better." : "") +
         left_out_text(pair);
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
  return text + fmt::format(" Omitted: {}.", list_of(friedman.left_out));
}

}  // namespace weft::lab
