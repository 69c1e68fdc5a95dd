// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lab/results/cell_record.hpp"

namespace weft::lab {
namespace {

/// The weighted mean of two means of `count_a` and `count_b` values; a mean of no values is
/// omitted.
double joined(double a, std::int64_t count_a, double b, std::int64_t count_b) {
  if (count_a == 0) return b;
  if (count_b == 0) return a;
  const auto n_a = static_cast<double>(count_a), n_b = static_cast<double>(count_b);
  return (n_a * a + n_b * b) / (n_a + n_b);
}

}  // namespace

void CertaintyCounts::add(const CertaintyCounts& other) {
  frames += other.frames;
  right += other.right;
  silently_wrong += other.silently_wrong;
  squares += other.squares;
  bins.resize(std::max(bins.size(), other.bins.size()));
  for (std::size_t b = 0; b < other.bins.size(); ++b) {
    ConfidenceBin& bin = bins[b];
    const ConfidenceBin& more = other.bins[b];
    bin.said = joined(bin.said, bin.frames, more.said, more.frames);
    bin.came_true = joined(bin.came_true, bin.frames, more.came_true, more.frames);
    bin.frames += more.frames;
  }
  for (std::size_t k = 0; k < within_percent.size(); ++k) {
    within_percent[k] =
        joined(within_percent[k], vertices, other.within_percent[k], other.vertices);
  }
  vertices += other.vertices;
}

double CertaintyCounts::confidence() const {
  double mean = kUnknown;
  std::int64_t counted = 0;
  for (const ConfidenceBin& bin : bins) {
    mean = joined(mean, counted, bin.said, bin.frames);
    counted += bin.frames;
  }
  return mean;
}

}  // namespace weft::lab
