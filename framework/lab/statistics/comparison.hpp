// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lab/statistics/better.hpp"
#include "lab/statistics/friedman.hpp"
#include "lab/statistics/paired_test.hpp"
#include "lab/statistics/panel.hpp"

/// Conclusions on treatments that were tried on the same sequences; see docs/statistics.md.
namespace weft::lab {

struct ComparisonOptions {
  std::string measure = "mean 3D error";
  std::string unit = "mm";  ///< may be empty
  Better better = Better::lower;
  std::string reference;   ///< compares the others with this one; empty: all pairs
  std::uint64_t seed = 1;  ///< seed of resampling
};

/// `too_few` if no outcome of this number of sequences could have been significant, ties excluded.
/// Two pairs with the same number of sequences in one family are both too few, or neither is.
enum class Call { too_few, undecided, a, b };

/// True if a call names one of the two.
constexpr bool decided(Call call) { return call == Call::a || call == Call::b; }

/// One treatment. Its values may come from other frames than those of the next treatment, so that
/// only pairs show which one is better.
struct TreatmentSummary {
  std::string name;
  std::int64_t sequences = 0;           ///< [] with a value: the n of the figures that follow
  double mean = kUnknown;               ///< over sequences
  double median = kUnknown;             ///< over sequences
  Interval interval;                    ///< 95 % of the mean, bootstrap by sequence
  std::int64_t rows = 0, failures = 0;  ///< [] places tried, and of them without a value
};

/// True if a fails more often than b, over the places that both were tried at.
struct FailurePair {
  std::int64_t rows = 0;                          ///< [] places
  std::int64_t only_a = 0, only_b = 0, both = 0;  ///< [] failures of
  PairedTest test;                                ///< share of failures, a - b, by sequence
  double p_holm = kUnknown;                       ///< [] p after Holm's correction
  Call call = Call::too_few;                      ///< which one fails less
};

/// True if a is better than b, over the places where both have a value.
struct PairComparison {
  std::string a, b;
  std::int64_t rows = 0;                        ///< [] places
  double mean_a = kUnknown, mean_b = kUnknown;  ///< over sequences, of the same places
  PairedTest test;                              ///< a - b, by sequence
  std::vector<double> differences;              ///< those of the test
  /// At the level that Holm's correction left for this pair: zero lies outside where the difference
  /// is called, and only there. Unknown where there are too few sequences.
  Interval interval;
  double p_holm = kUnknown;  ///< [] p after Holm's correction
  /// True if so few differences are nonzero that no values of them could have been significant.
  bool hidden_by_ties = false;
  double smallest_effect = kUnknown;  ///< that n could show at the level left by Holm's first step
  Call call = Call::too_few;          ///< which one has the better values
  FailurePair failures;
  std::vector<PanelPlace> without_a, without_b;     ///< places that only the other was tried at
  std::vector<std::string> sequences_without_pair;  ///< without a place where both have a value
  Call verdict = Call::too_few;  ///< better in value and not failing more, or the other way round
  std::string sentence;
};

/// All treatments at once, over the places where each of them has a value.
struct FriedmanComparison {
  std::vector<std::string> sequences;  ///< that are ranked
  std::vector<std::string> left_out;   ///< sequences without such a place
  Friedman test;                       ///< rank 1 for the best
  double p_holm = kUnknown;            ///< [] p after Holm's correction
  bool differ = false;
  std::string sentence;
};

struct ComparisonTable {
  std::vector<TreatmentSummary> treatments;    ///< in the order of their first result
  std::vector<PairComparison> pairs;           ///< number of tests in the family
  std::optional<FriedmanComparison> friedman;  ///< from 3 treatments on
  std::int64_t tests = 0;                      ///< [] in the family that Holm's correction is for
  std::string headline;                        ///< which one is the best, if one is
};

/// Results that are compared apart from others.
struct ObservationGroup {
  std::string where;                      ///< begins its sentences: "With sift"; may be empty
  std::vector<Observation> observations;  ///< [.] results of all treatments
};

/// Compares treatments. One family, so that the table contains a false positive with a probability
/// of at most 5 %. Its tests are each pair's values and failures and Friedman's test, as far as
/// they could reach p = 0.05 at all (Tarone 1990). Fails with not_found if the reference is no
/// treatment, and as make_panel does.
Result<ComparisonTable> compare(const std::vector<Observation>& observations,
                                const ComparisonOptions& options = {});

/// The same for several groups, which are one family: the more groups, the more a difference has to
/// be to be called. A group with no results of the reference, or of no treatment, has no pairs.
Result<std::vector<ComparisonTable>> compare_separately(const std::vector<ObservationGroup>& groups,
                                                        const ComparisonOptions& options = {});

}  // namespace weft::lab
