// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/warp_metrics.hpp"

#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/truth/truth_map.hpp>

#include "lab/statistics/unknown.hpp"

namespace weft::lab {
namespace {

/// Which vertices are corners of a face in which a match was kept.
std::vector<bool> salient_vertices(const Correspondences& matches, const Array<std::uint8_t>& kept,
                                   const Template& sheet) {
  std::vector<bool> salient(to_index(sheet.flat_px.rows()), false);
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    if (kept(n) == 0 || matches.face(n) < 0) continue;
    for (int k = 0; k < 3; ++k) {
      salient[to_index(sheet.faces(matches.face(n), k))] = true;
    }
  }
  return salient;
}

}  // namespace

WarpErrors warp_errors(const WarpSamples& samples, const Correspondences& matches,
                       const Array<std::uint8_t>& kept, const Template& sheet,
                       const TruthMap& truth, const Pinhole& camera) {
  const Eigen::Vector2d m_per_px = sheet.m_per_px.matrix<1>();
  const std::vector<bool> is_salient = salient_vertices(matches, kept, sheet);
  std::vector<double> salient_px, other_px;
  for (Eigen::Index v = 0; v < samples.xy_px.rows(); ++v) {
    const Eigen::Vector2d flat_px = sheet.flat_px.matrix<2>().row(v);
    const auto place = truth.at(flat_px.cwiseProduct(m_per_px));
    if (!place) continue;
    const Eigen::Vector2d warped_px = samples.xy_px.matrix<2>().row(v);
    const double error_px = (warped_px - project(camera, place->point_m)).norm();
    if (!std::isfinite(error_px)) continue;
    (is_salient[to_index(v)] ? salient_px : other_px).push_back(error_px);
  }
  return {mean_or_unknown(salient_px), mean_or_unknown(other_px),
          static_cast<std::int64_t>(salient_px.size()), static_cast<std::int64_t>(other_px.size())};
}

WarpMetrics summarise_warp(const std::string& stage, const std::vector<WarpErrors>& frames) {
  WarpMetrics metrics;
  metrics.stage = stage;
  metrics.frames = static_cast<std::int64_t>(frames.size());
  std::vector<double> salient_px, other_px;
  for (const WarpErrors& frame : frames) {
    metrics.salient += frame.salient;
    metrics.other += frame.other;
    if (frame.salient > 0) salient_px.push_back(frame.salient_px);
    if (frame.other > 0) other_px.push_back(frame.other_px);
  }
  metrics.salient_px = mean_or_unknown(salient_px);
  metrics.other_px = mean_or_unknown(other_px);
  return metrics;
}

}  // namespace weft::lab
