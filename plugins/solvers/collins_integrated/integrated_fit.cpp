// SPDX-License-Identifier: Apache-2.0
#include "integrated_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

#include "common/least_bending.hpp"

namespace weft::collins_integrated {
namespace {

constexpr double kHuber = 2.45;     // sqrt(5.991): 95 % of two normal deviates
constexpr double kSoft = 8.0;       // factor by which lengths are softer at first ...
constexpr double kStiff_rad = 0.1;  // ... and bends by less, which keeps corners from folding
constexpr double kFlat_rad = 0.02;  // and so that no bend stays
constexpr double kMuchLess = 0.99;  // share of the energy
constexpr int kApproach = 10;       // iterations on the matches alone
constexpr int kMoreLooks = 1;       // at full size
constexpr double kAgreeing_px = 3.0;
constexpr double kOpenCosine = 0.3, kFoldedCosine = 0.0;
constexpr int kTextureLevels = 12;
constexpr std::int64_t kPassesPerLook = 150;  // passes of about ten nanoseconds each

}  // namespace

Result<void> IntegratedFit::prepare(const Template& templ, const Camera& camera,
                                    const MeshModel& mesh) {
  mesh_ = &mesh;
  texture_.load(templ.texture, kTextureLevels);
  auto chosen = choose_samples(templ, texture_, camera, options_.samples, samples_);
  if (!chosen) return chosen;
  search_.load(templ, texture_);
  return minimiser_.prepare(mesh);
}

void IntegratedFit::settle(const FrameData& frame, const Scales& scales, int max_iterations,
                           Fit& fit, Points3& vertices_m) {
  const MinimiserResult result = minimiser_.run(frame, scales, max_iterations, vertices_m);
  fit.iterations += result.iterations;
  fit.energy = result.energy;
}

Fit IntegratedFit::run(bool with_texture, FrameData& frame, Points3& vertices_m) {
  Fit fit;
  frame.texture.clear();
  if (!frame.matches.empty()) settle(frame, soft_scales(), kApproach, fit, vertices_m);
  if (with_texture) {
    search_coarse_to_fine(frame, fit, vertices_m);
    measure(frame, vertices_m, fit);
    if (!fit.looks_right()) search_again(frame, fit, vertices_m);
    return fit;
  }
  settle(frame, exact_scales(), 2 * kApproach, fit, vertices_m);
  smooth_once(frame, fit, vertices_m);
  measure(frame, vertices_m, fit);
  return fit;
}

Scales IntegratedFit::exact_scales() const {
  Scales scales = options_.scales;
  scales.loss = {options_.outlier, true};
  return scales;
}

Scales IntegratedFit::soft_scales() const {
  Scales scales = options_.scales;
  scales.loss = {kHuber, false};
  scales.strain *= kSoft;
  scales.bend_rad = std::min(scales.bend_rad, kStiff_rad);
  return scales;
}

void IntegratedFit::search_coarse_to_fine(FrameData& frame, Fit& fit, Points3& vertices_m) {
  for (int level = image_.levels() - 1; level >= 0; --level) {
    // Softer, smoother and less choosy where much is still to be moved.
    const double width = 1 << level;
    Scales scales = options_.scales;
    scales.loss = {width * options_.outlier, true};
    scales.strain *= width;
    scales.bend_rad /= width;
    const int rounds = options_.rounds + (level == 0 ? kMoreLooks : 0);
    for (int round = 0; round < rounds; ++round) {
      look(level, vertices_m, frame, fit);
      settle(frame, scales, options_.max_iterations, fit, vertices_m);
    }
  }
  if (!smooth_once(frame, fit, vertices_m)) return;
  for (int round = 0; round < options_.rounds; ++round) {
    look(0, vertices_m, frame, fit);
    settle(frame, exact_scales(), options_.max_iterations, fit, vertices_m);
  }
}

/// A bend looks much like its mirror image, and a corner may stay bent the wrong way. This flattens
/// the shape, lets it bend again, and keeps the result where the same observations cost less.
bool IntegratedFit::smooth_once(const FrameData& frame, Fit& fit, Points3& vertices_m) {
  other_m_ = vertices_m;
  Fit other = fit;
  Scales flat = soft_scales();
  flat.bend_rad = std::min(flat.bend_rad, kFlat_rad);
  settle(frame, flat, kApproach, other, other_m_);
  settle(frame, exact_scales(), kApproach, other, other_m_);
  fit.iterations = other.iterations;
  if (!(other.energy < kMuchLess * fit.energy)) return false;
  fit.energy = other.energy;
  vertices_m = other_m_;
  return true;
}

/// From where the parts that are seen lead the others.
void IntegratedFit::search_again(FrameData& frame, Fit& fit, Points3& vertices_m) {
  const Points3 first_m = vertices_m;
  const std::vector<std::uint8_t> first_observed = observed_;
  const Fit first = fit;
  const auto filled = solvers::fill_with_least_bending(mesh_->rest_m, mesh_->bending,
                                                       mesh_->mean_edge_m, observed_, vertices_m);
  const bool is_filled = filled && filled->allFinite() && filled->col(2).minCoeff() > 0.0;
  if (is_filled) vertices_m = *filled;
  settle(frame, soft_scales(), kApproach, fit, vertices_m);
  search_coarse_to_fine(frame, fit, vertices_m);
  measure(frame, vertices_m, fit);
  if (fit.support() > first.support()) return;
  const int iterations = fit.iterations;
  vertices_m = first_m;
  observed_ = first_observed;
  fit = first;
  fit.iterations = iterations;
}

/// Looks for all samples near where the shape has them.
void IntegratedFit::look(int level, const Points3& vertices_m, FrameData& frame, Fit& fit) {
  frame.texture.clear();
  const LineSearchOptions options{level, options_.reach_px, static_cast<float>(options_.min_zncc)};
  const double per_px = 1.0 / (options_.texture_noise_px * static_cast<double>(1 << level));
  for (const Sample& sample : samples_) {
    worked(kPassesPerLook);
    if (!frame.hidden_faces.empty() && frame.hidden_faces[to_index(sample.face)] != 0) continue;
    const Sighting sighting = search_.look(image_, frame.camera, vertices_m, sample, options);
    if (sighting.look != Look::found) continue;
    Observation seen;
    seen.face = sample.face;
    seen.weights = sample.weights;
    seen.seen_px = sighting.seen_px;
    seen.whitening_per_px.row(0) = per_px * sighting.normal.transpose();
    frame.texture.push_back(seen);
  }
  fit.found = static_cast<int>(frame.texture.size());
}

void IntegratedFit::measure(const FrameData& frame, const Points3& vertices_m, Fit& fit) {
  observed_.assign(to_index(mesh_->vertex_count()), 0);
  compare(frame, vertices_m, fit);
  measure_matches(frame, vertices_m, fit);
  measure_mesh(vertices_m, fit);
}

void IntegratedFit::hold(std::int32_t face) {
  for (Eigen::Index k = 0; k < 3; ++k) observed_[to_index(mesh_->faces(face, k))] = 1;
}

/// Compares image and texture where the shape has the samples.
void IntegratedFit::compare(const FrameData& frame, const Points3& vertices_m, Fit& fit) {
  values_.clear();
  fit.alike = fit.turned = 0;
  for (const Sample& sample : samples_) {
    worked(kPassesPerLook / 3);
    if (!frame.hidden_faces.empty() && frame.hidden_faces[to_index(sample.face)] != 0) continue;
    const Sighting sighting = search_.look(image_, frame.camera, vertices_m, sample, {0, 0, 0.0F});
    fit.turned += sighting.look == Look::hidden ? 1 : 0;
    if (sighting.look != Look::unlike && sighting.look != Look::found) continue;
    values_.push_back(static_cast<double>(sighting.zncc_here));
    if (values_.back() < options_.min_zncc) continue;
    ++fit.alike;
    hold(sample.face);
  }
  fit.in_sight = static_cast<int>(values_.size());
  fit.median_zncc = values_.empty() ? 0.0 : median_in_place(values_);
}

void IntegratedFit::measure_matches(const FrameData& frame, const Points3& vertices_m, Fit& fit) {
  values_.clear();
  fit.agreeing = 0;
  for (const Observation& seen : frame.matches) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) {
      point += seen.weights[k] * vertices_m.row(mesh_->faces(seen.face, k)).transpose();
    }
    const double off_px = (project(frame.camera, point) - seen.seen_px).norm();
    const bool in_front = off_px >= 0.0;  // false for NaN
    values_.push_back(in_front ? off_px : std::numeric_limits<double>::infinity());
    if (!(off_px < kAgreeing_px)) continue;
    ++fit.agreeing;
    hold(seen.face);
  }
  fit.residual_px = values_.empty() ? 0.0 : median_in_place(values_);
}

void IntegratedFit::measure_mesh(const Points3& vertices_m, Fit& fit) const {
  double sum = 0.0;
  for (const Edge& edge : mesh_->edges) {
    const double length_m = (vertices_m.row(edge.j) - vertices_m.row(edge.i)).norm();
    sum += std::abs(length_m / edge.rest_m - 1.0);
  }
  fit.strain = sum / static_cast<double>(mesh_->edges.size());
  const auto is_folded = [&](const Hinge& hinge) {
    return hinge.rest_cosine > kOpenCosine && cosine_of(hinge, vertices_m) < kFoldedCosine;
  };
  fit.folds =
      static_cast<int>(std::count_if(mesh_->hinges.begin(), mesh_->hinges.end(), is_folded));
}

}  // namespace weft::collins_integrated
