// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/certainty_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/vertex_spread.hpp>
#include <weft/truth/truth_map.hpp>

#include "lab/metrics/field.hpp"

namespace weft::lab {
namespace {

constexpr double kHalfInterval = 1.96;  // standard deviations, of 95 % of normal errors

/// Mean over frames of the share that is inside; frames without vertices do not count.
class MeanShare {
 public:
  void add(std::int64_t inside, std::int64_t vertices) {
    if (vertices == 0) return;
    ++frames_;
    shares_ += static_cast<double>(inside) / static_cast<double>(vertices);
  }
  double percent() const {
    return frames_ == 0 ? kUnknown : kPercent * shares_ / static_cast<double>(frames_);
  }

 private:
  std::int64_t frames_ = 0;
  double shares_ = 0.0;
};

}  // namespace

void count_deviations(const Shape& shape, const Template& sheet, const TruthMap& truth,
                      FrameCertainty& certainty) {
  if (!shape.covariance_m2.present() || !sheet.m_per_px.present()) return;
  const Eigen::Vector2d m_per_px = sheet.m_per_px.matrix<1>();
  for (std::int64_t v = 0; v < shape.covariance_m2.rows(); ++v) {
    const Eigen::Vector2d flat_px = sheet.flat_px.matrix<2>().row(v);
    const auto place = truth.at(flat_px.cwiseProduct(m_per_px));
    if (!place) continue;
    const MajorAxis axis = major_axis(shape, v);
    const Eigen::Vector3d vertex_m = shape.vertices_m.matrix<3>().row(v);
    const double along_m = std::abs(axis.direction.dot(vertex_m - place->point_m));
    ++certainty.vertices;
    for (std::size_t k = 0; k < certainty.within.size(); ++k) {
      certainty.within[k] += along_m <= static_cast<double>(k + 1) * axis.std_m ? 1 : 0;
    }
    if (!shape.source.present()) continue;
    IntervalCounts& counts = shape.source(v) == 0 ? certainty.filled_in : certainty.measured;
    ++counts.vertices;
    counts.inside += along_m <= kHalfInterval * axis.std_m ? 1 : 0;
  }
}

CertaintyMetrics summarise_certainty(const std::vector<FrameCertainty>& frames) {
  CertaintyMetrics metrics;
  std::array<std::int64_t, 3> within{};
  std::array<double, 10> said{}, came_true{};
  double squares = 0.0;
  MeanShare all, measured, filled_in;
  for (const FrameCertainty& frame : frames) {
    metrics.vertices += frame.vertices;
    all.add(frame.measured.inside + frame.filled_in.inside,
            frame.measured.vertices + frame.filled_in.vertices);
    measured.add(frame.measured.inside, frame.measured.vertices);
    filled_in.add(frame.filled_in.inside, frame.filled_in.vertices);
    for (std::size_t k = 0; k < within.size(); ++k) within[k] += frame.within[k];
    if (!std::isfinite(frame.confidence)) continue;
    const double right = frame.right ? 1.0 : 0.0;
    const auto bin = to_index(std::clamp(10.0 * frame.confidence, 0.0, 9.0));
    ++metrics.frames;
    metrics.right += frame.right;
    metrics.silently_wrong += frame.silently_wrong;
    squares += (frame.confidence - right) * (frame.confidence - right);
    ++metrics.bins[bin].frames;
    said[bin] += frame.confidence;
    came_true[bin] += right;
  }
  if (metrics.frames > 0) metrics.brier = squares / static_cast<double>(metrics.frames);
  for (std::size_t b = 0; b < metrics.bins.size(); ++b) {
    ConfidenceBin& bin = metrics.bins[b];
    if (bin.frames == 0) continue;
    bin.said = said[b] / static_cast<double>(bin.frames);
    bin.came_true = came_true[b] / static_cast<double>(bin.frames);
  }
  for (std::size_t k = 0; k < within.size() && metrics.vertices > 0; ++k) {
    metrics.within_percent[k] =
        kPercent * static_cast<double>(within[k]) / static_cast<double>(metrics.vertices);
  }
  metrics.in_interval_percent = all.percent();
  metrics.measured_in_interval_percent = measured.percent();
  metrics.filled_in_interval_percent = filled_in.percent();
  return metrics;
}

}  // namespace weft::lab
