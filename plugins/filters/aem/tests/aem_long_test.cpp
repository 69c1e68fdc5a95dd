// SPDX-License-Identifier: Apache-2.0
// The rates and the reliability that the README states, on the reporting seeds 101 to 120. Prints
// the tables; to measure while tuning, set WEFT_AEM_FIRST_SEED=1 and the number of seeds.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <weft/core/index.hpp>

#include "common/tests/filter_bench.hpp"
#include "match_scenes.hpp"

namespace weft::testing {
namespace {

struct Target {
  SceneSpec spec;
  const char* name;
  double tpr_at_least, fpr_at_most;
};

const std::array kTargets{
    Target{{Kind::paper, 1000, 0.9}, "1000, 90 %", 99.5, 0.5},
    Target{{Kind::paper, 1000, 0.3}, "1000, 30 %", 99.9, 0.1},
    Target{{Kind::paper, 1000, 0.2}, "1000, 20 %", 99.9, 0.1},
    Target{{Kind::paper, 1000, 0.1}, "1000, 10 %", 99.8, 1.0},
    Target{{Kind::paper, 1000, 0.05}, "1000, 5 %", 99.5, 15.0},
    Target{{Kind::paper, 1000, 0.05, 0.0, true}, "1000, 5 %, oriented", 99.8, 3.0},
    Target{{Kind::paper, 200, 0.9}, "200, 90 %", 99.5, 0.5},
    Target{{Kind::paper, 200, 0.6}, "200, 60 %", 99.5, 0.5},
    Target{{Kind::paper, 200, 0.3}, "200, 30 %", 99.7, 0.5},
    Target{{Kind::paper, 200, 0.2}, "200, 20 %", 99.6, 0.5},
    Target{{Kind::paper, 200, 0.1}, "200, 10 %", 99.2, 3.0},
    Target{{Kind::paper, 50, 0.9}, "50, 90 %", 99.5, 0.5},
    Target{{Kind::paper, 50, 0.6}, "50, 60 %", 99.5, 0.5},
    Target{{Kind::paper, 50, 0.3}, "50, 30 %", 98.5, 1.5},
    Target{{Kind::paper, 50, 0.2}, "50, 20 %", 98.0, 4.0},
    Target{{Kind::turned, 200, 0.3}, "turned, 200, 30 %", 99.7, 0.5},
    Target{{Kind::turned, 50, 0.3}, "turned, 50, 30 %", 98.5, 1.5},
    Target{{Kind::strong, 200, 0.15}, "strong bend, any turn, 200, 15 %", 99.5, 0.5},
    Target{{Kind::clusters, 200, 0.2}, "clusters, 200, 20 %", 99.5, 1.0},
    Target{{Kind::copy, 200, 0.3}, "copy of 15 %, 200, 30 %", 99.4, 0.5}};

constexpr int kSetsPerSeed = 5;

std::uint64_t setting(const char* name, std::uint64_t usual) {
  const char* text = std::getenv(name);
  return text == nullptr ? usual : std::strtoull(text, nullptr, 10);
}

/// With AddressSanitizer a set takes ten times as long: one seed, and no rates, which need them
/// all.
#ifdef __SANITIZE_ADDRESS__
constexpr std::uint64_t kSeeds = 1;
#else
constexpr std::uint64_t kSeeds = 20;
#endif
std::uint64_t seeds() { return setting("WEFT_AEM_SEEDS", kSeeds); }
bool enough_for_rates() { return seeds() >= 20; }
const char* const kTooFew = "the rates need 20 seeds; what ran did so without a fault";

/// Calls `each` with every set of the seeds.
template <class Each>
void for_each_set(const SceneSpec& spec, const Each& each) {
  const std::uint64_t first = setting("WEFT_AEM_FIRST_SEED", 101);
  const std::uint64_t count = seeds();
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    for (std::uint64_t set = 0; set < kSetsPerSeed; ++set)
      each(draw_scene(spec, 1000 * seed + set));
  }
}

/// A set without a result has all of its matches rejected.
TEST(AemRates, ReachTheTargets) {
  FilterBench bench("filters/aem");
  std::printf("| matches, correct | TPR / FPR | target | sets that lost half | no result |\n");
  for (const Target& target : kTargets) {
    double tpr = 0.0, fpr = 0.0;
    int sets = 0, lost = 0, without = 0;
    for_each_set(target.spec, [&](const LabelledMatches& drawn) {
      const auto mask = bench.run(drawn.matches).get<InlierMask>();
      const Rates rates = mask ? rates_of(*mask, drawn.correct) : Rates{100.0, 100.0};
      tpr += rates.tpr_percent;
      fpr += rates.fpr_percent;
      lost += rates.fpr_percent > 50.0 ? 1 : 0;
      without += mask ? 0 : 1;
      ++sets;
    });
    std::printf("| %s | %.2f / %.2f | %.1f / %.1f | %d | %d |\n", target.name, tpr / sets,
                fpr / sets, target.tpr_at_least, target.fpr_at_most, lost, without);
    if (!enough_for_rates()) continue;
    EXPECT_GE(tpr / sets, target.tpr_at_least) << target.name;
    EXPECT_LE(fpr / sets, target.fpr_at_most) << target.name;
  }
  if (!enough_for_rates()) GTEST_SKIP() << kTooFew;
}

/// Ten bins of what was predicted, with what came true.
struct Reliability {
  std::array<double, 10> predicted{}, came_true{}, count{};
  double squares = 0.0, total = 0.0;

  void add(double probability, bool truth) {
    const auto bin = to_index(std::min(9.0, 10.0 * probability));
    predicted[bin] += probability;
    came_true[bin] += truth ? 1.0 : 0.0;
    count[bin] += 1.0;
    squares += (probability - (truth ? 1.0 : 0.0)) * (probability - (truth ? 1.0 : 0.0));
    total += 1.0;
  }
  double brier() const { return squares / total; }
  /// The Brier score if each bin predicted its true rate: the sets' own uncertainty (Murphy,
  /// Journal of Applied Meteorology 12, 1973).
  double uncertainty() const {
    double sum = 0.0;
    for (std::size_t bin = 0; bin < 10; ++bin) {
      if (count[bin] > 0.0) sum += came_true[bin] * (1.0 - came_true[bin] / count[bin]);
    }
    return sum / total;
  }
  /// Mean gap between what was predicted and what came true.
  double calibration_error() const {
    double gap = 0.0;
    for (std::size_t bin = 0; bin < 10; ++bin) gap += std::abs(predicted[bin] - came_true[bin]);
    return gap / total;
  }
  void print(const char* what) const {
    std::printf("\n| %s | predicted %% | true %% | number |\n", what);
    for (std::size_t bin = 0; bin < 10; ++bin) {
      if (count[bin] == 0.0) continue;
      std::printf("| %d to %d %% | %.1f | %.1f | %.0f |\n", static_cast<int>(10 * bin),
                  static_cast<int>(10 * bin + 10), 100.0 * predicted[bin] / count[bin],
                  100.0 * came_true[bin] / count[bin], count[bin]);
    }
    std::printf("Brier score %.4f, %.4f of it the sets' own; calibration error %.4f\n", brier(),
                uncertainty(), calibration_error());
  }
};

/// True if the kept matches are mostly inliers and include most of the inliers.
bool is_the_object(const InlierMask& mask, const std::vector<std::uint8_t>& correct) {
  double kept = 0.0, good = 0.0, right = 0.0;
  for (std::size_t i = 0; i < correct.size(); ++i) {
    const bool keeps = mask.kept(static_cast<std::int64_t>(i)) != 0;
    kept += keeps ? 1.0 : 0.0;
    right += correct[i];
    good += keeps ? correct[i] : 0.0;
  }
  return good > 0.0 && good >= 0.5 * kept && good >= 0.5 * right;
}

/// Without a track, a copy with as many matches as the object cannot be distinguished from the
/// object.
bool decidable(const SceneSpec& spec) {
  if (spec.kind != Kind::copy) return true;
  const double on_copy = std::floor(kCopyShare * spec.count);
  return on_copy < static_cast<double>(std::lround(spec.correct_rate * spec.count));
}

std::vector<SceneSpec> all_specs() {
  std::vector<SceneSpec> specs;
  for (const Kind kind : {Kind::paper, Kind::turned, Kind::strong, Kind::clusters, Kind::copy}) {
    for (const int count : {50, 200, 1000}) {
      for (const double rate : {0.0, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.6}) {
        specs.push_back({kind, count, rate, 0.5});
      }
    }
  }
  return specs;
}

TEST(AemConfidence, IsAsOftenRightAsItSays) {
  FilterBench bench("filters/aem", "{least_confidence: 0}");
  Reliability frames, matches;
  int sure = 0, sure_and_wrong = 0;
  for (const SceneSpec& spec : all_specs()) {
    if (!decidable(spec)) continue;
    for_each_set(spec, [&](const LabelledMatches& drawn) {
      const auto mask = bench.run(drawn.matches).get<InlierMask>();
      if (!mask) return;
      const double confidence = mask->diag.value("confidence", 0.0);
      const bool right = is_the_object(*mask, drawn.correct);
      frames.add(confidence, right);
      if (confidence < 0.75) return;
      ++sure;
      sure_and_wrong += right ? 0 : 1;
      for (std::size_t i = 0; i < drawn.correct.size(); ++i) {
        matches.add(mask->score(static_cast<std::int64_t>(i)), drawn.correct[i] != 0);
      }
    });
  }
  frames.print("confidence of a set");
  matches.print("probability of a match");
  std::printf("%d of %d sets with a confidence of 75 %% or more were wrong\n", sure_and_wrong,
              sure);
  if (!enough_for_rates()) GTEST_SKIP() << kTooFew;
  EXPECT_LT(sure_and_wrong, 0.01 * sure);
  EXPECT_LT(frames.brier() - frames.uncertainty(), 0.002);
  EXPECT_LT(frames.calibration_error(), 0.04);
  EXPECT_LT(matches.calibration_error(), 0.02);
}

/// Sets that cannot be distinguished: the result is the object, its copy, or flagged.
TEST(AemConfidence, IsOfACopyWhereThatHasAsManyMatchesAsTheObject) {
  FilterBench bench("filters/aem", "{least_confidence: 0}");
  int sets = 0, object = 0, copy = 0, flagged = 0, neither = 0;
  for (const SceneSpec& spec : all_specs()) {
    if (decidable(spec)) continue;
    for_each_set(spec, [&](const LabelledMatches& drawn) {
      const auto mask = bench.run(drawn.matches).get<InlierMask>();
      ++sets;
      if (!mask || mask->diag.value("confidence", 0.0) < 0.75) {
        ++flagged;
      } else if (is_the_object(*mask, drawn.correct)) {
        ++object;
      } else if (is_the_object(*mask, on_copy(drawn))) {
        ++copy;
      } else {
        ++neither;
      }
    });
  }
  std::printf(
      "copy as large: %d sets, sure of the object %d, of the copy %d, flagged %d, neither %d\n",
      sets, object, copy, flagged, neither);
  EXPECT_LE(neither, sets / 100);
  EXPECT_GT(copy, sets / 2);
}

}  // namespace
}  // namespace weft::testing
