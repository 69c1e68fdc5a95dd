// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/comparison.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <iostream>
#include <vector>
#include <weft/core/rng.hpp>

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kFailed = kUnknown;

std::string sequence_name(int number) { return "s" + std::to_string(100 + number); }

/// One frame a sequence; `values` [sequences].
void add(const std::string& treatment, const std::vector<double>& values,
         std::vector<Observation>& observations) {
  for (std::size_t s = 0; s < values.size(); ++s) {
    observations.push_back({sequence_name(static_cast<int>(s)), 0, 1, treatment, values[s]});
  }
}

/// Treatments that differ by 1 from sequence to sequence, up to a little noise.
std::vector<Observation> graded(const std::vector<std::string>& treatments, int sequences) {
  std::cout << "seed 31\n";
  Rng rng(31);
  std::vector<Observation> observations;
  for (std::size_t t = 0; t < treatments.size(); ++t) {
    std::vector<double> values;
    for (int s = 0; s < sequences; ++s) {
      values.push_back(10.0 * s + static_cast<double>(t) + rng.uniform(-0.2, 0.2));
    }
    add(treatments[t], values, observations);
  }
  return observations;
}

TEST(Panel, CountsASequenceOnceHoweverManyFramesAndSeedsItHas) {
  // Sequence p: seed 1 has the mean 2, seed 2 the value 6; q: one frame.
  const auto panel = make_panel({{"p", 0, 1, "a", 1.0},
                                 {"p", 1, 1, "a", 3.0},
                                 {"p", 0, 2, "a", 6.0},
                                 {"q", 0, 1, "a", 10.0}});
  const auto means = sequence_means(*panel, [](const PanelRow& row) { return row.results[0]; });
  ASSERT_EQ(means.size(), 2U);
  EXPECT_EQ(means[0].mean, 4.0);
  EXPECT_EQ(means[0].rows, 3);
  EXPECT_EQ(means[1].mean, 10.0);
}

TEST(Panel, SpreadsTheFailureOfACellOverTheFramesOfTheOthers) {
  const auto panel = make_panel({{"p", 0, 1, "a", 1.0},
                                 {"p", 1, 1, "a", 1.0},
                                 {"p", 0, 2, "a", 1.0},
                                 {"p", kEveryFrame, 1, "b", kFailed},
                                 {"q", kEveryFrame, 1, "a", kFailed},
                                 {"q", kEveryFrame, 1, "b", kFailed}});
  ASSERT_EQ(panel->rows.size(), 4U);
  EXPECT_TRUE(panel->rows[0].failed(1) && panel->rows[1].failed(1));
  EXPECT_FALSE(panel->rows[2].present(1));
  EXPECT_TRUE(panel->rows[3].failed(0) && panel->rows[3].failed(1));
  EXPECT_EQ(to_string(panel->rows[3].place), "sequence q, seed 1, every frame");
}

TEST(Panel, RefusesContradictions) {
  const auto message = [](const std::vector<Observation>& rows) {
    const auto panel = make_panel(rows);
    return panel ? "" : panel.error().message;
  };
  EXPECT_THAT(message({{"p", 3, 1, "a", 1.0}, {"p", 3, 1, "a", 1.0}}),
              HasSubstr("'a' has two results at sequence p, seed 1, frame 3"));
  EXPECT_THAT(message({{"p", 3, 1, "a", 1.0}, {"p", kEveryFrame, 1, "a", kFailed}}),
              HasSubstr("two results"));
  EXPECT_THAT(message({{"p", kEveryFrame, 1, "a", 1.0}}), HasSubstr("only a failure may"));
  EXPECT_THAT(message({}), HasSubstr("no results"));
}

TEST(Compare, NamesTheBetterWithEffectIntervalAndN) {
  std::vector<Observation> observations;
  add("new", {1, 2, 3, 4, 5, 6, 7, 8}, observations);
  add("old", {2, 4, 4, 6, 6, 8, 8, 10}, observations);
  const auto table = compare(observations);
  ASSERT_TRUE(table);
  ASSERT_EQ(table->pairs.size(), 1U);
  const PairComparison& pair = table->pairs[0];
  EXPECT_EQ(pair.call, Call::a);
  EXPECT_EQ(pair.verdict, Call::a);
  EXPECT_DOUBLE_EQ(pair.test.mean, -1.5);
  EXPECT_EQ(pair.p_holm, pair.test.p);
  EXPECT_EQ(pair.rows, 8);
  EXPECT_EQ(
      pair.sentence,
      "new is better than old by 1.5 mm: mean 3D error 4.5 instead of 6.0 mm, 95 % interval 1 "
      "to 2 mm, p = 0.00781, 8 sequences; standardised effect 2.81. Each has a value in all "
      "8 results.");
  EXPECT_EQ(
      table->headline,
      "new is better than old by 1.5 mm: mean 3D error 4.5 instead of 6.0 mm, 95 % interval 1 "
      "to 2 mm, p = 0.00781, 8 sequences.");
  EXPECT_DOUBLE_EQ(table->treatments[0].mean, 4.5);
  EXPECT_DOUBLE_EQ(table->treatments[0].median, 4.5);
  EXPECT_LT(table->treatments[0].interval.low, 4.5);
  EXPECT_FALSE(table->friedman);
}

TEST(Compare, TurnsTheVerdictWhereHigherIsBetter) {
  std::vector<Observation> observations;
  add("new", {1, 2, 3, 4, 5, 6, 7, 8}, observations);
  add("old", {2, 4, 4, 6, 6, 8, 8, 10}, observations);
  ComparisonOptions options;
  options.measure = "precision";
  options.unit = "%";
  options.better = Better::higher;
  const auto table = compare(observations, options);
  EXPECT_EQ(table->pairs[0].verdict, Call::b);
  EXPECT_THAT(table->pairs[0].sentence,
              StartsWith("old is better than new by 1.5 points: precision 6.0 instead of 4.5 %"));
  EXPECT_THAT(table->pairs[0].sentence, HasSubstr("interval 1 to 2 points, "));
}

TEST(Compare, NamesNoWinnerInsideTheNoiseAndSaysWhatWouldHaveShown) {
  std::vector<Observation> observations;
  add("a", {1, 2, 1, 2, 1, 2, 1, 2}, observations);
  add("b", {2, 1, 2, 1, 2, 1, 2, 1}, observations);
  const auto table = compare(observations);
  EXPECT_EQ(table->pairs[0].verdict, Call::undecided);
  EXPECT_NEAR(table->pairs[0].smallest_effect,
              smallest_effect(table->pairs[0].test.standard_deviation, 8), 1e-12);
  EXPECT_THAT(table->pairs[0].sentence,
              StartsWith("a and b do not differ significantly: mean 3D error 1.5 and 1.5 mm, a "
                         "difference of 0 mm, 95 % interval "));
  EXPECT_THAT(table->pairs[0].sentence, HasSubstr("would be shown 4 times in 5"));
  EXPECT_THAT(table->headline, StartsWith("a and b do not differ significantly"));
  observations.clear();
  add("a", {1, 2, 3, 4, 5, 6}, observations);
  add("b", {1, 2, 3, 4, 5, 6}, observations);
  EXPECT_THAT(compare(observations)->pairs[0].sentence,
              StartsWith("a and b have the same mean 3D error on each of 6 sequences."));
}

TEST(Compare, SaysTooFewBelowSixSequencesAndWithTooManyTests) {
  const auto five = compare(graded({"a", "b"}, 5));
  EXPECT_EQ(five->pairs[0].verdict, Call::too_few);
  EXPECT_THAT(
      five->pairs[0].sentence,
      StartsWith("Too few sequences to compare a with b in mean 3D error: 5 of at least 6; "));
  EXPECT_THAT(five->headline, StartsWith("Too few sequences to compare a with b"));
  const auto six = compare(graded({"a", "b"}, 6));
  EXPECT_EQ(six->pairs[0].verdict, Call::a);
  // Three pairs and Friedman's test: 4 x 2/64 > 0.05 for any outcome.
  const auto three = compare(graded({"a", "b", "c"}, 6));
  EXPECT_EQ(three->tests, 4);
  EXPECT_EQ(three->pairs[0].call, Call::too_few);
  EXPECT_THAT(three->pairs[0].sentence, HasSubstr("with 4 tests 6 could call nothing"));
  EXPECT_TRUE(std::isnan(three->pairs[0].smallest_effect));
  EXPECT_EQ(three->headline, "Too few sequences to decide: 6 for 4 tests.");
}

/// Ties leave the second pair six sequences, too few for any outcome to be called among four tests.
/// It is undecided all the same, because it has as many sequences as the one called.
TEST(Compare, CallsPairsOfTheSameNumberOfSequencesTooFewTogether) {
  std::vector<Observation> observations;
  add("a", {1, 2, 3, 4, 5, 6, 7, 8}, observations);
  add("b", {2, 3.1, 4.2, 5.3, 6.4, 7.5, 8.6, 9.7}, observations);
  add("c", {1, 2, 3.1, 3.9, 5.2, 5.9, 7.3, 7.8}, observations);
  const auto table = compare(observations);
  const PairComparison &called = table->pairs[0], &tied = table->pairs[1];
  EXPECT_EQ(called.call, Call::a);
  EXPECT_EQ(tied.test.n, called.test.n);
  EXPECT_EQ(tied.test.ties, 2);
  ASSERT_EQ(table->tests, 4);
  EXPECT_GT(4.0 * tied.test.least_p, kAlpha);
  EXPECT_EQ(tied.call, Call::undecided);
  EXPECT_THAT(tied.sentence, HasSubstr("8 sequences, the same on 2 of them"));
}

TEST(Compare, NamesTiesWhereTheyAreWhyNothingIsCalled) {
  std::vector<Observation> observations;
  add("a", {1, 2, 3, 4, 5, 6, 7, 8}, observations);
  add("b", {1, 2, 3, 4.5, 5.6, 6.7, 7.8, 8.9}, observations);
  const PairComparison pair = compare(observations)->pairs[0];
  EXPECT_EQ(pair.call, Call::undecided);
  EXPECT_THAT(pair.sentence, HasSubstr("8 sequences, the same on 3 of them: the other 5 are too "
                                       "few to call a difference"));
}

TEST(Compare, LeavesZeroOutOfACorrectedIntervalExactlyWhereItCallsADifference) {
  std::cout << "seeds 41 to 80\n";
  int called = 0, alone = 0;
  for (std::uint64_t seed = 41; seed <= 80; ++seed) {
    Rng rng(seed);
    std::vector<Observation> observations;
    for (int t = 0; t < 4; ++t) {
      std::vector<double> values;
      for (int s = 0; s < 9 + static_cast<int>(seed % 5); ++s) {
        values.push_back(0.35 * t + rng.uniform(-1.0, 1.0));
      }
      add(std::string(1, static_cast<char>('a' + t)), values, observations);
    }
    const auto table = compare(observations);
    for (const PairComparison& pair : table->pairs) {
      if (pair.call == Call::too_few) {
        EXPECT_TRUE(std::isnan(pair.interval.low));
        continue;
      }
      const bool leaves_out = pair.interval.low > 0.0 || pair.interval.high < 0.0;
      EXPECT_EQ(leaves_out, decided(pair.call)) << "seed " << seed << ": " << pair.sentence;
      called += decided(pair.call);
      alone += pair.test.p <= kAlpha && !decided(pair.call);
    }
  }
  EXPECT_GT(called, 5);
  EXPECT_GT(alone, 5) << "the interval of one comparison would leave zero out in these";
}

TEST(Compare, CountsAndNamesWhatHasNoPartner) {
  auto observations = graded({"a", "b"}, 8);
  observations.push_back({"s100", 7, 1, "a", 1000.0});
  observations.push_back({"s103", 9, 2, "b", 1000.0});
  observations.push_back({"t", 0, 1, "b", 1000.0});
  const PairComparison pair = compare(observations)->pairs[0];
  ASSERT_EQ(pair.without_b.size(), 1U);
  EXPECT_EQ(pair.without_b[0], (PanelPlace{"s100", 1, 7}));
  ASSERT_EQ(pair.without_a.size(), 2U);
  EXPECT_EQ(pair.without_a[0], (PanelPlace{"s103", 2, 9}));
  EXPECT_THAT(pair.sequences_without_pair, ElementsAre("t"));
  EXPECT_EQ(pair.test.n, 8);
  EXPECT_NEAR(pair.test.mean, -1.0, 0.2);
  EXPECT_THAT(
      pair.sentence,
      HasSubstr("Omitted: 2 results that a lacks, the first at sequence s103, seed 2, frame 9."));
  EXPECT_THAT(pair.sentence, HasSubstr("Sequences without a pair of values: t."));
}

TEST(Compare, TestsFailuresSeparatelyFromValues) {
  // a has the lower values, but fails on half of each sequence; frames where both fail count too.
  std::vector<Observation> observations;
  for (int s = 0; s < 10; ++s) {
    for (std::uint64_t frame = 0; frame < 4; ++frame) {
      const double value = s + 0.1 * static_cast<double>(frame);
      const bool lost = s == 0 && frame == 0;
      observations.push_back({sequence_name(s), frame, 1, "a", frame < 2 ? kFailed : value});
      observations.push_back({sequence_name(s), frame, 1, "b", lost ? kFailed : value + 1.0});
    }
  }
  const PairComparison pair = compare(observations)->pairs[0];
  EXPECT_EQ(pair.call, Call::a);
  EXPECT_EQ(pair.failures.call, Call::b);
  EXPECT_EQ(pair.verdict, Call::undecided);
  EXPECT_EQ(pair.failures.rows, 40);
  EXPECT_EQ(pair.failures.only_a, 19);
  EXPECT_EQ(pair.failures.only_b, 0);
  EXPECT_EQ(pair.failures.both, 1);
  EXPECT_EQ(pair.rows, 20);
  EXPECT_DOUBLE_EQ(pair.test.mean, -1.0);
  EXPECT_NEAR(pair.failures.test.mean, (9 * 0.5 + 0.25) / 10.0, 1e-12);
  EXPECT_THAT(pair.sentence,
              HasSubstr("Without a value, of 40 results of each: a 20, b 1; b lacks fewer (p"));
  EXPECT_THAT(pair.sentence, HasSubstr("Neither is named the better."));
  EXPECT_THAT(compare(observations)->headline,
              StartsWith("Neither of a and b is named the better: a is better than b by 1 mm: "));
  EXPECT_THAT(compare(observations)->headline,
              HasSubstr(", but b has no value in 1 of 40 results, a in 20 (p"));
  EXPECT_EQ(compare(observations)->tests, 2);
}

TEST(Compare, FindsATreatmentThatAlwaysFailsWorse) {
  auto observations = graded({"a"}, 8);
  for (int s = 0; s < 8; ++s) {
    observations.push_back({sequence_name(s), kEveryFrame, 1, "b", kFailed});
  }
  const auto table = compare(observations);
  const PairComparison& pair = table->pairs[0];
  EXPECT_EQ(pair.test.n, 0);
  EXPECT_EQ(pair.call, Call::too_few);
  EXPECT_EQ(pair.verdict, Call::a);
  EXPECT_EQ(table->treatments[1].failures, 8);
  EXPECT_EQ(table->treatments[1].sequences, 0);
  EXPECT_TRUE(std::isnan(table->treatments[1].mean));
  EXPECT_THAT(table->headline,
              StartsWith("a is better than b: a has no value in 0 of 8 results, b in 8"));
}

TEST(Compare, RanksManyTreatmentsWhereAllHaveAValue) {
  auto observations = graded({"a", "b", "c"}, 10);
  observations[3].value = kFailed;
  const auto table = compare(observations);
  ASSERT_TRUE(table->friedman);
  EXPECT_EQ(table->friedman->sequences.size(), 9U);
  EXPECT_THAT(table->friedman->left_out, ElementsAre("s103"));
  EXPECT_THAT(table->friedman->test.mean_ranks, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_TRUE(table->friedman->differ);
  EXPECT_THAT(table->friedman->sentence, StartsWith("Some treatments differ in rank"));
  EXPECT_THAT(table->friedman->sentence, HasSubstr("Omitted: s103."));
  EXPECT_EQ(table->tests, 4);  // one failure can never be called: it is no test
  for (const PairComparison& pair : table->pairs) {
    EXPECT_EQ(pair.verdict, Call::a);
    EXPECT_GE(pair.p_holm, pair.test.p);
  }
  EXPECT_THAT(table->headline, StartsWith("a is better than each of the others in mean 3D error: "
                                          "than b by "));
  EXPECT_THAT(table->headline, HasSubstr("In brackets 95 % intervals and p at most 0.0"));
  EXPECT_THAT(table->headline, HasSubstr("Holm's correction for 4 tests, 10 sequences."));
}

TEST(Compare, ListsWhatTheBestCannotBeDistinguishedFrom) {
  auto observations = graded({"a", "b"}, 12);
  std::cout << "seed 33\n";
  Rng rng(33);
  for (int s = 0; s < 12; ++s) {
    const double near_a = 10.0 * s + 0.1 + (s % 2 == 0 ? 0.3 : -0.3) + rng.uniform(-0.01, 0.01);
    observations.push_back({sequence_name(s), 0, 1, "near", near_a});
  }
  const auto table = compare(observations);
  EXPECT_THAT(table->headline,
              StartsWith("a is better than 1 of the other 2 in mean 3D error: than b by "));
  EXPECT_THAT(table->headline, HasSubstr("Not significantly different from it: near, higher by "));
}

TEST(Compare, ReportsTheLargestDifferenceWhereNoneIsSignificant) {
  std::vector<Observation> observations;
  add("a", {1, 2, 1, 2, 1, 2, 1, 2, 1, 2}, observations);
  add("b", {2, 1, 2, 1, 2, 1, 2, 1, 2, 1}, observations);
  add("c", {2, 2, 2, 2, 1, 2, 2, 1, 1, 1}, observations);
  EXPECT_THAT(
      compare(observations)->headline,
      StartsWith("None of the 3 differs significantly from another. a and c do not differ "
                 "significantly: mean 3D error 1.50 and 1.60 mm, a difference of 0.1 mm, "));
}

TEST(Compare, SplitsGroupsAndCorrectsForAllOfThem) {
  // With `easy` the two are the same but for a toss; with `hard` b is worse by 1.
  std::vector<ObservationGroup> groups{{"With easy", {}}, {"With hard", {}}};
  add("a", {1, 2, 1, 2, 1, 2, 1, 2}, groups[0].observations);
  add("b", {2, 1, 2, 1, 2, 1, 2, 1}, groups[0].observations);
  add("a", {1, 2, 3, 4, 5, 6, 7, 8}, groups[1].observations);
  add("b", {2, 3, 4, 5, 6, 7, 8, 9}, groups[1].observations);
  const auto tables = compare_separately(groups);
  ASSERT_TRUE(tables);
  ASSERT_EQ(tables->size(), 2U);
  EXPECT_EQ((*tables)[0].pairs[0].verdict, Call::undecided);
  EXPECT_EQ((*tables)[1].pairs[0].verdict, Call::a);
  EXPECT_EQ((*tables)[1].tests, 2);
  const double alone = compare(groups[1].observations)->pairs[0].p_holm;
  EXPECT_DOUBLE_EQ((*tables)[1].pairs[0].p_holm, 2.0 * alone);
  EXPECT_THAT((*tables)[0].headline,
              StartsWith("With easy, a and b do not differ significantly: mean 3D "));
  EXPECT_EQ((*tables)[1].headline,
            "With hard, a is better than b by 1 mm: mean 3D error 4.5 instead of 5.5 mm, 95 % "
            "interval 1 to 1 mm and p = 0.0156 after Holm's correction for 2 tests, 8 sequences.");
  // A group without results has no comparisons, and takes none from the others.
  groups.push_back({"With none", {}});
  EXPECT_TRUE((*compare_separately(groups))[2].pairs.empty());
  EXPECT_EQ((*compare_separately(groups))[1].tests, 2);
}

TEST(Compare, ComparesWithAReferenceOnly) {
  ComparisonOptions options;
  options.reference = "b";
  const auto table = compare(graded({"a", "b", "c"}, 12), options);
  ASSERT_EQ(table->pairs.size(), 2U);
  EXPECT_EQ(table->pairs[0].a, "a");
  EXPECT_EQ(table->pairs[1].a, "c");
  EXPECT_EQ(table->pairs[1].b, "b");
  EXPECT_EQ(table->pairs[1].verdict, Call::b);
  EXPECT_THAT(table->headline, StartsWith("Better than b in mean 3D error: a by "));
  EXPECT_THAT(table->headline, HasSubstr("). Worse: c by "));
  options.reference = "d";
  const auto unknown = compare(graded({"a", "b"}, 8), options);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, Errc::not_found);
  EXPECT_THAT(unknown.error().message, HasSubstr("'d'"));
}

TEST(Compare, DoesNotDependOnTheOrderOfTheRows) {
  auto observations = graded({"a", "b", "c"}, 25);
  const auto one = compare(observations);
  Rng rng(32);
  std::vector<Observation> shuffled(observations.begin() + 75 - 24, observations.end());
  observations.resize(75 - 24);
  rng.shuffle(shuffled);
  observations.insert(observations.end(), shuffled.begin(), shuffled.end());
  const auto other = compare(observations);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(one->pairs[i].sentence, other->pairs[i].sentence);
    EXPECT_EQ(one->pairs[i].test.p, other->pairs[i].test.p);
    EXPECT_EQ(one->pairs[i].test.interval.low, other->pairs[i].test.interval.low);
  }
}

TEST(Compare, HasNothingToSayOfOneTreatment) {
  const auto table = compare(graded({"a"}, 8));
  EXPECT_TRUE(table->pairs.empty());
  EXPECT_THAT(table->headline, HasSubstr("nothing to compare"));
  EXPECT_THAT(table->headline, Not(HasSubstr("better")));
}

}  // namespace
}  // namespace weft::lab
