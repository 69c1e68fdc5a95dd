// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/index.hpp>

#include "myneighbor_bench.hpp"

namespace weft::testing {

/// One scenario of the published synthetic experiment and the expected rates, in percent. After
/// steps I and II: selected matches and the share of inliers in them. After step III: rates of
/// mismatches found and of inliers rejected.
struct PublishedRates {
  int matches;
  double correct_rate;
  double step1_share, step1_correct, step2_share, step2_correct;
  double true_positive, false_positive;
};

inline const std::vector<PublishedRates> kPublishedRates{
    {1000, 0.3, 27.3, 91.5, 22.2, 98.8, 99, 0.6}, {1000, 0.5, 39.2, 99.8, 36.9, 100, 99, 0.0},
    {1000, 0.9, 54.2, 100, 51.4, 100, 99, 0.0},   {200, 0.3, 35.5, 71.3, 31.0, 80.2, 98, 30.6},
    {200, 0.5, 39.5, 98.0, 35.1, 99.9, 99, 0.2},  {200, 0.7, 49.2, 99.8, 46.6, 100, 99, 0.1},
    {50, 0.3, 43.3, 51.9, 39.4, 56.2, 90, 44.8},  {50, 0.5, 42.8, 89.4, 35.0, 96.5, 98, 6.1},
    {50, 0.7, 49.5, 98.8, 45.5, 99.9, 99, 1.8}};

/// Random deformations of the 10 x 6 mesh.
inline std::vector<Points3> draw_shapes(int count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Points3> shapes;
  for (int i = 0; i < count; ++i) {
    shapes.push_back(draw_deformation({}, make_camera(), rng)->vertices_m);
  }
  return shapes;
}

/// The means over one trial for each shape. Trials without a result count as failures, and in no
/// mean.
struct MeasuredRates {
  double step1_share = 0, step1_correct = 0, step2_share = 0, step2_correct = 0;
  double true_positive = 0, false_positive = 0;
  int failures = 0;
};

inline void add_trial(const LabelledMatches& drawn, const InlierMask& mask, MeasuredRates& sum) {
  const Array<double>& stage = evidence(mask, "stage");
  const auto matches = static_cast<double>(mask.kept.rows());
  double step1 = 0, step1_good = 0, step2 = 0, step2_good = 0, found = 0, lost = 0, good = 0;
  for (std::int64_t i = 0; i < mask.kept.rows(); ++i) {
    const bool correct = drawn.correct[to_index(i)] != 0;
    good += correct;
    found += !correct && mask.kept(i) == 0;
    lost += correct && mask.kept(i) == 0;
    step1 += stage(i) >= 1.0;
    step1_good += stage(i) >= 1.0 && correct;
    step2 += stage(i) >= 2.0;
    step2_good += stage(i) >= 2.0 && correct;
  }
  sum.step1_share += 100.0 * step1 / matches;
  sum.step1_correct += 100.0 * step1_good / step1;
  sum.step2_share += 100.0 * step2 / matches;
  sum.step2_correct += 100.0 * step2_good / step2;
  sum.true_positive += 100.0 * found / (matches - good);
  sum.false_positive += 100.0 * lost / good;
}

inline MeasuredRates measure_rates(PluginUnderTest& filter, const std::vector<Points3>& shapes,
                                   int matches, double correct_rate, std::uint64_t seed) {
  MeasuredRates mean;
  Rng rng(seed);
  for (const Points3& shape : shapes) {
    const LabelledMatches drawn =
        draw_matches(kTemplate, make_camera(), shape, {matches, correct_rate, 0.0, 2.0}, rng);
    const auto mask = run_on(filter, drawn.matches).get<InlierMask>();
    if (mask) add_trial(drawn, *mask, mean);
    if (!mask) ++mean.failures;
  }
  const auto trials = static_cast<double>(shapes.size()) - mean.failures;
  for (double* value : {&mean.step1_share, &mean.step1_correct, &mean.step2_share,
                        &mean.step2_correct, &mean.true_positive, &mean.false_positive}) {
    *value /= trials;
  }
  return mean;
}

}  // namespace weft::testing
