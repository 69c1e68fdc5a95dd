// SPDX-License-Identifier: Apache-2.0
// Components that are correct about geometry. On demand they break one of its laws: the flaw names
// the law.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>
#include <weft/data/matrix.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/sdk/matcher.hpp>
#include <weft/sdk/pass.hpp>
#include <weft/sdk/solver.hpp>
#include <weft/sdk/warp_model.hpp>

#include "cubic.hpp"

namespace flawed {
namespace {

/// The one parameter that all have.
class Flaw {
 public:
  explicit Flaw(weft::Params& p) { p.text("flaw", name_, "what is wrong; empty: nothing"); }
  bool is(const char* name) const { return name_ == name; }

 private:
  std::string name_;
};

/// Keeps what most agree with.
class Filter final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{.needs = "template camera"};

  explicit Filter(weft::Params& p) : flaw_(p) {
    p.read("limit_px", limit_px_, "px", {0.1, 100}, "kept up to this");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const weft::Correspondences& matches = in.correspondences;
    const std::int64_t count = matches.count();
    if (count < 2 * Cubic::kTerms) return weft::no_result("too few matches");
    const auto across_m = in.templ->vertices_m.matrix<3>().col(0);
    if (flaw_.is("one_size") && across_m.maxCoeff() - across_m.minCoeff() > 0.45) {
      return weft::Error{weft::Errc::unsupported, "made for smaller templates", {}};
    }
    const Eigen::VectorXd off_px = residuals_px(matches);
    const weft::Points2 at_px = matches.image_px.matrix<2>();
    const weft::Points2 offset_px = at_px.rowwise() - at_px.colwise().mean();
    const Eigen::RowVector2d spread_px = offset_px.array().square().colwise().mean().sqrt();
    weft::InlierMask mask{
        weft::Array<std::uint8_t>({count}, 0), weft::Array<double>({count}, 0.0), {}};
    for (std::int64_t i = 0; i < count; ++i) {
      bool keep = matches.kept(i) != 0 && off_px(i) <= limit_px_;
      if (flaw_.is("order")) keep = keep && i % 7 != 0;
      if (flaw_.is("twin")) keep = keep && (i < 1 || !has_twin(at_px, i));
      if (flaw_.is("place")) keep = keep && at_px(i, 0) > 0.25 * in.camera->width_px;
      if (flaw_.is("pixels")) keep = keep && offset_px.row(i).norm() < 60.0;
      if (flaw_.is("axis")) keep = keep && std::abs(offset_px(i, 0)) < 1.5 * spread_px(0);
      if (flaw_.is("side")) keep = keep && offset_px(i, 0) < 1.2 * spread_px(0);
      if (flaw_.is("metres")) {
        keep = keep && in.templ->m_per_px(0) * matches.template_px(i, 0) < 0.25;
      }
      if (flaw_.is("numbers")) keep = keep && matches.face(i) > 9;
      if (flaw_.is("exact")) keep = keep && off_px(i) > 0.01;
      mask.kept(i) = keep ? 1 : 0;
    }
    return mask;
  }

 private:
  static bool has_twin(const weft::Points2& at_px, Eigen::Index i) {
    return (at_px.topRows(i).rowwise() - at_px.row(i)).rowwise().norm().minCoeff() == 0.0;
  }

  Flaw flaw_;
  double limit_px_ = 8.0;
};

/// Pairs each keypoint with the most similar one.
class Matcher final : public weft::Matcher {
 public:
  static constexpr weft::About kAbout{.needs = "keypoints template_keypoints"};

  explicit Matcher(weft::Params& p) : flaw_(p) {}

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    const weft::Keypoints &image = *in.keypoints, &templ = *in.template_keypoints;
    const std::int64_t count = image.count();
    if (count == 0 || templ.count() == 0 || image.metric != "l2" || templ.metric != "l2") {
      return weft::no_result("nothing to compare");
    }
    weft::Correspondences matches;
    matches.template_px = weft::Array<double>({count, 2}, 0.0);
    matches.image_px = weft::make_array<double>(weft::Points2(image.xy_px.matrix<2>()));
    matches.face = weft::Array<std::int32_t>({count}, 0);
    matches.barycentrics = weft::Array<double>({count, 3}, 0.0);
    matches.kept = weft::Array<std::uint8_t>({count}, 0);
    matches.score = weft::Array<double>({count}, 0.0);
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t like = flaw_.is("order") ? i / 2 : most_similar(image, i, templ);
      const double aside_px = flaw_.is("place") ? 0.01 * image.xy_px(i, 0) : 0.0;
      matches.template_px(i, 0) = templ.xy_px(like, 0) + aside_px;
      matches.template_px(i, 1) = templ.xy_px(like, 1);
      matches.face(i) = -1;
      matches.kept(i) = 1;
      matches.score(i) = 1.0;
    }
    return matches;
  }

 private:
  static std::int64_t most_similar(const weft::Keypoints& image, std::int64_t i,
                                   const weft::Keypoints& templ) {
    const Eigen::Index length = image.descriptors.dim(1);
    const Eigen::Map<const Eigen::RowVectorXf> wanted(image.descriptors.row(i), length);
    std::int64_t best = 0;
    float least = std::numeric_limits<float>::infinity();
    for (std::int64_t k = 0; k < templ.count(); ++k) {
      const Eigen::Map<const Eigen::RowVectorXf> offered(templ.descriptors.row(k), length);
      const float distance2 = (wanted - offered).squaredNorm();
      if (distance2 < least) least = distance2, best = k;
    }
    return best;
  }

  Flaw flaw_;
};

/// Polynomials of degree 3.
class Warp final : public weft::WarpModel {
 public:
  explicit Warp(weft::Params& p) : flaw_(p) {}

  weft::Result<weft::Warp> fit(const weft::FitInput& in) override {
    const weft::Correspondences& matches = in.correspondences;
    const Eigen::VectorXd weights = matches.kept.matrix<1>().cast<double>();
    if (weights.sum() < 2 * Cubic::kTerms) return weft::no_result("too few matches");
    weft::Warp warp;
    warp.producer = "warps/test_flawed";
    warp.domain_px = weft::Array<double>({4}, 0.0);
    warp.model.entries.push_back({"model.cubic", Cubic(matches, weights).coefficients()});
    const double off_px = residuals_px(matches).mean();
    warp.model.entries.push_back({"model.off_px", weft::Array<double>({1}, off_px)});
    return warp;
  }

  weft::Result<weft::WarpSamples> evaluate(const weft::EvaluateInput& in) override {
    const Cubic map(*in.warp.model.find("model.cubic"));
    const double noise_px = (*in.warp.model.find("model.off_px"))(0);
    const std::int64_t count = in.points.xy_px.rows();
    weft::WarpSamples samples{
        weft::Array<double>({count, 2}, 0.0), weft::Array<double>({count, 2, 2}, 0.0),
        weft::Array<double>({count, 2, 3}, 0.0), weft::Array<std::uint8_t>({count}, 0)};
    for (std::int64_t i = 0; i < count; ++i) {
      const Eigen::RowVector2d texel = in.points.xy_px.matrix<2>().row(i);
      Eigen::RowVector2d at_px = map.at(texel);
      if (flaw_.is("aside")) at_px(0) += 3.0;
      if (flaw_.is("noise")) at_px(0) += 1.5 / (1.0 + noise_px);
      const Eigen::RowVector2d du = map.at(texel, 1, 0), dv = map.at(texel, 0, 1);
      const Eigen::RowVector2d duu = map.at(texel, 2, 0), duv = map.at(texel, 1, 1);
      for (int k = 0; k < 2; ++k) {
        samples.xy_px(i, k) = at_px(k);
        samples.jacobian.row(i)[2 * k] = du(k) * (flaw_.is("jacobian") ? 1.001 : 1.0);
        samples.jacobian.row(i)[2 * k + 1] = dv(k);
        samples.hessian.row(i)[3 * k] = duu(k);
        samples.hessian.row(i)[3 * k + 1] = duv(k) * (flaw_.is("hessian") ? 1.01 : 1.0);
        samples.hessian.row(i)[3 * k + 2] = map.at(texel, 0, 2)(k);
      }
      samples.valid(i) = 1;
    }
    return samples;
  }

 private:
  Flaw flaw_;
};

/// A sightline for each match, all vertices visible, and the box around the matches as region.
class Pass final : public weft::Pass {
 public:
  static constexpr weft::About kAbout{.needs = "correspondences",
                                      .produces = "sightlines visibility region"};

  explicit Pass(weft::Params& p) : flaw_(p) {}

  weft::Result<weft::PassOutput> run(const weft::PassInput& in) override {
    const weft::Correspondences& matches = *in.correspondences;
    std::vector<std::int64_t> used;
    for (std::int64_t i = flaw_.is("order") ? 5 : 0; i < matches.count(); ++i) {
      if (matches.kept(i) != 0 && matches.face(i) >= 0) used.push_back(i);
    }
    if (used.empty()) return weft::no_result("no match is on the mesh");
    weft::PassOutput out;
    add_sightlines(in, matches, used, out);
    const std::int64_t vertices = in.templ.vertices_m.rows();
    out.visibility = {weft::Array<std::uint8_t>({vertices}, 0),
                      weft::Array<double>({vertices}, 1.0),
                      weft::Array<std::uint8_t>({vertices}, 0),
                      {}};
    for (std::int64_t v = 0; v < vertices; ++v) {
      const bool hidden = (flaw_.is("numbers") && v == 0) || flaw_.is("hidden");
      out.visibility->visible(v) = hidden ? 0 : 1;
    }
    add_region(in, matches, out);
    return out;
  }

 private:
  void add_sightlines(const weft::PassInput& in, const weft::Correspondences& matches,
                      const std::vector<std::int64_t>& used, weft::PassOutput& out) const {
    const auto count = static_cast<std::int64_t>(used.size());
    weft::Sightlines& lines = out.sightlines.emplace();
    lines.vertex = weft::Array<std::int32_t>({count}, -1);
    lines.face = weft::Array<std::int32_t>({count}, 0);
    lines.barycentrics = weft::Array<double>({count, 3}, 0.0);
    lines.pixel_px = weft::Array<double>({count, 2}, 0.0);
    lines.ray = weft::Array<double>({count, 3}, 0.0);
    lines.weight = weft::Array<double>({count}, 1.0);
    lines.coverage = 1.0;
    for (std::int64_t k = 0; k < count; ++k) {
      const std::int64_t i = used[static_cast<std::size_t>(k)];
      lines.face(k) = matches.face(i);
      std::copy_n(matches.barycentrics.row(i), 3, lines.barycentrics.row(k));
      const double aside_px = flaw_.is("aside") ? 3.0 : 0.0;
      const double x = matches.image_px(i, 0) + aside_px, y = matches.image_px(i, 1);
      lines.pixel_px(k, 0) = x;
      lines.pixel_px(k, 1) = y;
      lines.ray.matrix<3>().row(k) = Eigen::RowVector3d((x - in.camera.cx) / in.camera.fx,
                                                        (y - in.camera.cy) / in.camera.fy, 1.0)
                                         .normalized();
    }
  }

  void add_region(const weft::PassInput& in, const weft::Correspondences& matches,
                  weft::PassOutput& out) const {
    const auto at_px = matches.image_px.matrix<2>();
    const Eigen::RowVector2d low = at_px.colwise().minCoeff(), high = at_px.colwise().maxCoeff();
    const double margin_px = flaw_.is("pixels") ? 10.0 : 0.05 * (high - low).norm();
    const double left_px = flaw_.is("place") ? 5.0 : low(0) - margin_px;
    weft::Region& region = out.region.emplace();
    region.mask = weft::Array<std::uint8_t>({in.camera.height_px, in.camera.width_px}, 0);
    for (std::int64_t y = 0; y < in.camera.height_px; ++y) {
      for (std::int64_t x = 0; x < in.camera.width_px; ++x) {
        const double u = static_cast<double>(x), v = static_cast<double>(y);
        const bool inside = u >= left_px && u <= high(0) + margin_px && v >= low(1) - margin_px &&
                            v <= high(1) + margin_px;
        region.mask(y, x) = inside && !flaw_.is("nowhere") ? 1 : 0;
      }
    }
  }

  Flaw flaw_;
};

/// The answer of another solver, with a flaw.
class Solver final : public weft::Solver {
 public:
  static constexpr weft::About kAbout{.needs = "correspondences"};

  explicit Solver(weft::Params& p) : flaw_(p) { p.component("start", start_, "does the work"); }

  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override {
    auto solved = start_.solve(in);
    if (!solved) return solved;
    const weft::Correspondences& matches = *in.correspondences;
    const double count = static_cast<double>(matches.count());
    auto vertices_m = solved->vertices_m.matrix<3>();
    weft::Points3 spoilt_m = vertices_m;
    const double depth_m = spoilt_m.col(2).mean();
    if (flaw_.is("depth")) spoilt_m *= 0.8 / depth_m;
    if (flaw_.is("metres")) spoilt_m.col(2).array() += 0.001;
    if (flaw_.is("order")) spoilt_m *= 1.0 + 1e-3 * matches.image_px(0, 0) / in.camera.width_px;
    if (flaw_.is("count")) spoilt_m *= 1.0 + 0.1 * (count / 200.0 - 1.0);
    if (flaw_.is("pixels")) spoilt_m *= 1.0 + 1e-6 * in.camera.fx;
    if (flaw_.is("place")) spoilt_m *= 1.0 + 1e-6 * in.camera.cx;
    if (flaw_.is("axis")) spoilt_m.col(0).array() += 0.001 * depth_m;
    if (flaw_.is("numbers")) spoilt_m.row(0) *= 1.001;
    solved->vertices_m = weft::make_array<double>(spoilt_m);
    return solved;
  }

 private:
  Flaw flaw_;
  weft::SolverComponent start_{"solvers/bartoli_conformal"};
};

}  // namespace
}  // namespace flawed

WEFT_LIBRARY(
    WEFT_COMPONENT(flawed::Filter, "filters/test_flawed", "1.0.0", "Keeps what most agree with."),
    WEFT_COMPONENT(flawed::Matcher, "matchers/test_flawed", "1.0.0", "Pairs the most similar."),
    WEFT_COMPONENT(flawed::Warp, "warps/test_flawed", "1.0.0", "Polynomials of degree 3."),
    WEFT_COMPONENT(flawed::Pass, "passes/test_flawed", "1.0.0", "A sightline for each match."),
    WEFT_COMPONENT(flawed::Solver, "solvers/test_flawed", "1.0.0", "What another solver says."))
