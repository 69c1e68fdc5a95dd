// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lab/statistics/sentence_parts.hpp"
#include "lab/statistics/verdict.hpp"

namespace weft::lab {
namespace {

/// The results of a treatment against each of the others.
struct Rank {
  std::string name;
  double mean = kUnknown;
  std::vector<const PairComparison*> better, worse, undecided, too_few;
};

Rank standing_of(const ComparisonTable& table, const TreatmentSummary& treatment) {
  Rank standing{treatment.name, treatment.mean, {}, {}, {}, {}};
  for (const PairComparison& pair : table.pairs) {
    if (pair.a != treatment.name && pair.b != treatment.name) continue;
    const Call own = pair.a == treatment.name ? Call::a : Call::b;
    auto& list = pair.verdict == own             ? standing.better
                 : decided(pair.verdict)         ? standing.worse
                 : pair.verdict == Call::too_few ? standing.too_few
                                                 : standing.undecided;
    list.push_back(&pair);
  }
  return standing;
}

const std::string& other_of(const PairComparison& pair, const std::string& name) {
  return pair.a == name ? pair.b : pair.a;
}

std::string names_of(const std::vector<const PairComparison*>& pairs, const std::string& name) {
  std::vector<std::string> names;
  for (const PairComparison* pair : pairs) names.push_back(other_of(*pair, name));
  return list_of(names);
}

/// "tran by 0.3 mm (0.1 to 0.5), gms, which lacks more values".
std::string gains_text(const std::vector<const PairComparison*>& pairs, const std::string& name,
                       const std::string& unit, const char* by_failures) {
  std::vector<std::string> texts;
  for (const PairComparison* pair : pairs) {
    std::string& text = texts.emplace_back(other_of(*pair, name));
    if (pair->call != pair->verdict) {
      text += by_failures;
      continue;
    }
    const Gain gain = gain_of(*pair);
    text += " by " + with_unit(gain.mean, difference_unit(unit));
    if (!std::isnan(gain.interval.low)) {
      text += fmt::format(" ({} to {})", three_digits(gain.interval.low),
                          three_digits(gain.interval.high));
    }
  }
  return list_of(texts);
}

/// p and n of all that a headline lists.
std::string common_evidence(const ComparisonTable& table) {
  double largest_p = 0.0;
  std::int64_t n = 0;
  bool has_interval = false;
  for (const PairComparison& pair : table.pairs) {
    n = std::max(n, pair.test.n);
    has_interval = has_interval || !std::isnan(pair.interval.low);
    if (decided(pair.verdict) && pair.call == pair.verdict) {
      largest_p = std::max(largest_p, pair.p_holm);
    }
  }
  std::string text = has_interval ? " In brackets 95 % intervals" : "";
  if (largest_p > 0.0) {
    text += fmt::format("{} p at most {}", has_interval ? " and" : "", three_digits(largest_p));
  }
  text += text.empty() ? " " : fmt::format(" after Holm's correction for {} tests, ", table.tests);
  return text + sequences_text(n) + ".";
}

/// "tran, lower by 0.03 mm (-0.01 to 0.07)": of the others.
std::string undecided_list(const std::vector<const PairComparison*>& pairs, const std::string& name,
                           const std::string& unit) {
  std::vector<std::string> texts;
  for (const PairComparison* pair : pairs) {
    std::string& text = texts.emplace_back(other_of(*pair, name));
    if (decided(pair->call)) {
      text += ", for its values and the lack of them contradict each other";
      continue;
    }
    const Gain gain = gain_of(*pair);
    const double mean = pair->a == name ? -pair->test.mean : pair->test.mean;
    text +=
        (mean < 0.0 ? ", lower by " : ", higher by ") + with_unit(gain.mean, difference_unit(unit));
    if (!std::isnan(gain.interval.low)) {
      text += fmt::format(" ({} to {})", three_digits(gain.interval.low),
                          three_digits(gain.interval.high));
    }
  }
  return list_of(texts);
}

/// The pairs without a verdict.
std::string rest_text(const Rank& standing, const std::string& unit) {
  std::string text;
  if (!standing.undecided.empty()) {
    text += fmt::format(" Not significantly different from it: {}.",
                        undecided_list(standing.undecided, standing.name, unit));
  }
  if (!standing.too_few.empty()) {
    text += fmt::format(" Too few sequences to compare with it: {}.",
                        names_of(standing.too_few, standing.name));
  }
  return text;
}

std::string against_reference(const ComparisonTable& table, const Rank& reference,
                              const ComparisonOptions& options, const std::string& where) {
  const std::string& name = reference.name;
  const auto text = [&](const std::vector<const PairComparison*>& pairs, const char* by_failures) {
    return pairs.empty() ? "nothing" : gains_text(pairs, name, options.unit, by_failures);
  };
  return fmt::format("{} in {}: {}. Worse: {}.{}{}", begun(where, "Better than ") + name,
                     options.measure, text(reference.worse, ", which lacks fewer values"),
                     text(reference.better, ", which lacks more values"),
                     rest_text(reference, options.unit), common_evidence(table));
}

std::string none_decided(const ComparisonTable& table, const ComparisonOptions& options,
                         const std::string& where) {
  const auto largest = std::max_element(
      table.pairs.begin(), table.pairs.end(), [](const PairComparison& a, const PairComparison& b) {
        return std::abs(a.test.mean) < std::abs(b.test.mean) ||
               (std::isnan(a.test.mean) && !std::isnan(b.test.mean));
      });
  return fmt::format("{} {} differs significantly from another. {}", begun(where, "None of the"),
                     table.treatments.size(), brief_sentence_of(*largest, options, table.tests));
}

/// The one that is worse than none and better than most; null where each is worse than another.
const Rank* leader_of(const std::vector<Rank>& standings, Better better) {
  const Rank* leader = nullptr;
  for (const Rank& each : standings) {
    if (!each.worse.empty()) continue;
    const bool ahead =
        leader == nullptr || each.better.size() > leader->better.size() ||
        (each.better.size() == leader->better.size() &&
         (better == Better::lower ? each.mean < leader->mean : each.mean > leader->mean));
    if (ahead) leader = &each;
  }
  return leader;
}

std::string leader_text(const ComparisonTable& table, const Rank& leader,
                        const ComparisonOptions& options, const std::string& where) {
  const std::string gains =
      gains_text(leader.better, leader.name, options.unit, ", which lacks more values");
  const std::string start = begun_by_name(where, leader.name) + " is better than ";
  if (leader.better.size() + 1 == table.treatments.size()) {
    return fmt::format("{}each of the others in {}: than {}.{}", start, options.measure, gains,
                       common_evidence(table));
  }
  return fmt::format("{}{} of the other {} in {}: than {}.{}{}", start, leader.better.size(),
                     table.treatments.size() - 1, options.measure, gains,
                     rest_text(leader, options.unit), common_evidence(table));
}

std::string too_few(const ComparisonTable& table, const std::string& where) {
  std::int64_t n = 0;
  for (const PairComparison& pair : table.pairs) n = std::max(n, pair.test.n);
  const std::string why = n < kLeastSequences ? fmt::format("of at least {}", kLeastSequences)
                                              : fmt::format("for {} tests", table.tests);
  return fmt::format("{}: {} {}.", begun(where, "Too few sequences to decide"), n, why);
}

}  // namespace

std::string headline_of(const ComparisonTable& table, const ComparisonOptions& options,
                        const std::string& where) {
  if (table.pairs.empty()) return begun(where, "There is nothing to compare: one treatment only.");
  if (table.pairs.size() == 1) {
    return brief_sentence_of(table.pairs.front(), options, table.tests, where);
  }
  const auto any = [&](bool (*is)(Call)) {
    return std::any_of(table.pairs.begin(), table.pairs.end(),
                       [is](const PairComparison& pair) { return is(pair.verdict); });
  };
  if (!any([](Call call) { return call != Call::too_few; })) return too_few(table, where);
  std::vector<Rank> standings;
  for (const TreatmentSummary& each : table.treatments) {
    standings.push_back(standing_of(table, each));
    if (each.name == options.reference) {
      return against_reference(table, standings.back(), options, where);
    }
  }
  if (!any(decided)) return none_decided(table, options, where);
  const Rank* leader = leader_of(standings, options.better);
  if (leader == nullptr) {
    return fmt::format("{} in {}: each is worse than another.", begun(where, "No winner"),
                       options.measure);
  }
  return leader_text(table, *leader, options, where);
}

}  // namespace weft::lab
