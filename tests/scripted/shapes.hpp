// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/QR>
#include <weft/data/matrix.hpp>
#include <weft/geometry/types.hpp>
#include <weft/sdk/pass.hpp>
#include <weft/sdk/solver.hpp>
#include <weft/sdk/warp_model.hpp>

#include "filters.hpp"
#include "script.hpp"

namespace scripted {

/// The affine map that fits the kept matches best.
class AffineWarp final : public weft::WarpModel {
 public:
  explicit AffineWarp(weft::Params& p) : script_(p) {
    read_frames(p, "evaluate_no_result_at", evaluate_no_result_, "frames of no samples");
    read_frames(p, "short_samples_at", short_samples_, "frames with a sample too few");
  }

  weft::Result<weft::Warp> fit(const weft::FitInput& in) override {
    if (auto failure = script_.failure(in.call)) return *failure;
    const weft::Correspondences& matches = in.correspondences;
    const auto kept = static_cast<Eigen::Index>(matches.kept.matrix<1>().cast<double>().sum());
    if (kept < 3) return weft::no_result("too few matches: " + std::to_string(kept) + " of 3");
    Eigen::MatrixX3d texels(kept, 3);
    Eigen::MatrixX2d pixels(kept, 2);
    for (std::int64_t i = 0, row = 0; i < matches.count(); ++i) {
      if (matches.kept(i) == 0) continue;
      texels.row(row) << matches.template_px(i, 0), matches.template_px(i, 1), 1.0;
      pixels.row(row++) << matches.image_px(i, 0), matches.image_px(i, 1);
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> solver(texels);
    if (solver.rank() < 3) return weft::no_result("the matches lie on a line");
    weft::Warp warp;
    warp.producer = "warps/test.scripted";
    warp.domain_px = weft::Array<double>({4}, 0.0);
    warp.model.entries.push_back(
        {"model.affine", weft::make_array<double>(Eigen::MatrixX2d(solver.solve(pixels)))});
    return script_.answer(in.call, std::move(warp));
  }

  weft::Result<weft::WarpSamples> evaluate(const weft::EvaluateInput& in) override {
    if (has(evaluate_no_result_, in.call)) return weft::no_result("scripted no samples");
    const auto affine = in.warp.model.find("model.affine")->matrix<2>();
    const std::int64_t count = in.points.xy_px.rows() - (has(short_samples_, in.call) ? 1 : 0);
    weft::WarpSamples samples;
    samples.xy_px = weft::Array<double>({count, 2}, 0.0);
    samples.valid = weft::Array<std::uint8_t>({count}, 0);
    for (std::int64_t i = 0; i < count; ++i) {
      const Eigen::RowVector3d texel(in.points.xy_px(i, 0), in.points.xy_px(i, 1), 1.0);
      samples.xy_px.matrix<2>().row(i) = texel * affine;
      samples.valid(i) = 1;
    }
    return samples;
  }

 private:
  Script script_;
  Frames evaluate_no_result_, short_samples_;
};

inline weft::Visibility all_visible(std::int64_t count) {
  weft::Visibility visibility{weft::Array<std::uint8_t>({count}, 0),
                              weft::Array<double>({count}, 0.0),
                              weft::Array<std::uint8_t>({count}, 0),
                              {}};
  std::fill_n(visibility.visible.data(), count, std::uint8_t{1});
  return visibility;
}

/// A sightline through each vertex, where the warp puts it.
class VertexPass final : public weft::Pass {
 public:
  static constexpr weft::About kAbout{.needs = "warp_samples", .produces = "sightlines visibility"};

  explicit VertexPass(weft::Params& p) : script_(p) {
    read_frames(p, "bad_vertex_at", bad_vertex_, "frames with a vertex that does not exist");
    read_frames(p, "silent_at", silent_, "frames in which nothing is said");
  }

  weft::Result<weft::PassOutput> run(const weft::PassInput& in) override {
    if (auto failure = script_.failure(in.call)) return *failure;
    weft::PassOutput out;
    if (has(silent_, in.call)) return out;
    const std::int64_t count = in.templ.vertices_m.rows();
    out.visibility = all_visible(script_.length(in.call, count));
    weft::Sightlines& lines = out.sightlines.emplace();
    lines.vertex = weft::Array<std::int32_t>({count}, 0);
    lines.face = weft::Array<std::int32_t>({count}, 0);
    lines.barycentrics = weft::Array<double>({count, 3}, 0.0);
    lines.pixel_px = weft::Array<double>({count, 2}, 0.0);
    lines.ray = weft::Array<double>({count, 3}, 0.0);
    lines.weight = weft::Array<double>({count}, 0.0);
    lines.coverage = 1.0;
    for (std::int64_t v = 0; v < count; ++v) {
      const double x = in.warp_samples->xy_px(v, 0), y = in.warp_samples->xy_px(v, 1);
      const Eigen::Vector3d ray =
          Eigen::Vector3d((x - in.camera.cx) / in.camera.fx, (y - in.camera.cy) / in.camera.fy, 1.0)
              .normalized();
      lines.vertex(v) = static_cast<std::int32_t>(has(bad_vertex_, in.call) ? v + 1 : v);
      for (int k = 0; k < 3; ++k) lines.ray(v, k) = script_.number(in.call, ray(k));
      lines.pixel_px(v, 0) = x;
      lines.pixel_px(v, 1) = y;
      lines.weight(v) = 1.0;
    }
    return script_.answer(in.call, std::move(out));
  }

 private:
  Script script_;
  Frames bad_vertex_, silent_;
};

/// Reports which records were fed back to it.
class MemoryPass final : public weft::Pass {
 public:
  static constexpr weft::About kAbout{
      .needs = "previous.visibility", .reads = "previous.shape", .produces = "visibility"};

  explicit MemoryPass(weft::Params&) {}

  weft::Result<weft::PassOutput> run(const weft::PassInput& in) override {
    weft::PassOutput out;
    out.visibility = all_visible(in.templ.vertices_m.rows());
    tell_previous(in.previous_shape, out.visibility->diag);
    out.visibility->diag.set("previous_visibility", in.previous_visibility ? 1 : 0);
    return out;
  }
};

/// The plane z = distance, cut by the sightlines of the vertices.
class PlaneSolver final : public weft::Solver {
 public:
  static constexpr weft::About kAbout{.needs = "sightlines", .reads = "previous.shape"};

  explicit PlaneSolver(weft::Params& p) : script_(p) {
    p.read("distance_m", distance_m_, "m", {0.01, 100}, "of the plane");
    read_frames(p, "weak_at", weak_, "frames whose shape is weak");
    read_frames(p, "bad_state_at", bad_state_, "frames whose shape claims to be predicted");
  }

  void check(weft::Mistakes& mistakes) const { script_.check(mistakes); }

  weft::Result<void> prepare(const weft::PrepareInput&) override { return script_.prepare(); }

  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override {
    if (auto failure = script_.failure(in.call)) return *failure;
    const std::int64_t count = script_.length(in.call, in.templ.vertices_m.rows());
    weft::Shape shape;
    shape.vertices_m = weft::Array<double>({count, 3}, 0.0);
    shape.source = weft::Array<std::uint8_t>({count}, 0);
    for (std::int64_t i = 0; i < in.sightlines->count(); ++i) {
      const std::int32_t v = in.sightlines->vertex(i);
      for (int k = 0; k < 3; ++k) {
        shape.vertices_m(v, k) = script_.number(
            in.call, distance_m_ * in.sightlines->ray(i, k) / in.sightlines->ray(i, 2));
      }
      shape.source(v) = 1;
    }
    if (has(weak_, in.call)) shape.state = static_cast<int>(weft::ShapeState::weak);
    if (has(bad_state_, in.call)) shape.state = static_cast<int>(weft::ShapeState::predicted);
    tell_previous(in.previous_shape, shape.diag);
    shape.diag.set("draw", in.call.rng().uniform());
    return script_.answer(in.call, std::move(shape));
  }

 private:
  Script script_;
  double distance_m_ = kDistance_m;
  Frames weak_, bad_state_;
};

/// Leaves the work to a nested solver.
class HolderSolver final : public weft::Solver {
 public:
  explicit HolderSolver(weft::Params& p) {
    p.formerly("start").component("initial_guess", start_, "does the work");
    p.deprecated().read("rounds", rounds_, "", {0, 10}, "no effect: choose another initial_guess");
  }
  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override { return start_.solve(in); }

 private:
  weft::SolverComponent start_{"solvers/test.scripted"};
  int rounds_ = 1;
};

/// The plane z = distance, where the warp puts the vertices.
class WarpSolver final : public weft::Solver {
 public:
  static constexpr weft::About kAbout{.needs = "warp"};

  explicit WarpSolver(weft::Params&) {}

  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override {
    const auto samples = weft::evaluate(in.call, *in.warp, {in.templ.flat_px, 1});
    if (!samples) return samples.error();
    const std::int64_t count = in.templ.vertices_m.rows();
    weft::Shape shape;
    shape.vertices_m = weft::Array<double>({count, 3}, 0.0);
    shape.source = weft::Array<std::uint8_t>({count}, 0);
    for (std::int64_t v = 0; v < count; ++v) {
      shape.vertices_m(v, 0) = (samples->xy_px(v, 0) - in.camera.cx) * kDistance_m / in.camera.fx;
      shape.vertices_m(v, 1) = (samples->xy_px(v, 1) - in.camera.cy) * kDistance_m / in.camera.fy;
      shape.vertices_m(v, 2) = kDistance_m;
    }
    return shape;
  }
};

/// The template at rest, moved away; wants a known point.
class KnownSolver final : public weft::Solver {
 public:
  static constexpr weft::About kAbout{.needs = "known_points"};

  explicit KnownSolver(weft::Params&) {}

  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override {
    weft::Shape shape;
    shape.vertices_m = weft::make_array<double>(weft::Points3View(in.templ.vertices_m.matrix<3>()));
    shape.source = weft::Array<std::uint8_t>({shape.vertices_m.rows()}, 0);
    for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) shape.vertices_m(v, 2) = kDistance_m;
    shape.vertices_m(in.known_points->vertex(0), 2) = 1.01 * kDistance_m;
    return shape;
  }
};

}  // namespace scripted
