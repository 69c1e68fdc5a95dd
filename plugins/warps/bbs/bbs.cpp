// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/sdk/warp_model.hpp>

#include "common/fit_data.hpp"
#include "spline_fit.hpp"
#include "spline_model.hpp"

namespace {

using weft::Errc;
using weft::Error;
using weft::bbs::SplinePenalty;

enum class Smoothing { paper_px2, dimensionless };
enum class Robust { off, tukey, geman_mcclure };

constexpr double kSingular = 1e-12;  // pivot ratio below which the data do not determine the warp
constexpr double kTukey = 4.685;     // 95 % efficient for normal noise
constexpr double kLeastSigmaPx = 0.3;
constexpr std::size_t kFewestLeft = 3;  // matches with a weight after reweighting
constexpr int kFoldingSteps = 20;

/// A uniform bicubic B-spline from the texture to the image, fitted by regularised least squares.
class Bbs final : public weft::WarpModel {
 public:
  static constexpr weft::About kAbout{
      .reference = "paper: Rueckert et al. 1999, IEEE TMI 18(8); Brunet 2010, PhD thesis",
      .reads = "weights"};

  explicit Bbs(weft::Params& p) {
    p.read("control_u", control_u_, "", {4, 100},
           "number of control points along the domain's width");
    p.read("control_v", control_v_, "", {4, 100},
           "number of control points along the domain's height");
    p.read("margin_px", margin_px_, "px of the texture", {0, 1e4},
           "width of the border that the domain adds to the object's box in the texture");
    p.choice(
        "smoothing", smoothing_,
        {{"paper_px2", Smoothing::paper_px2}, {"dimensionless", Smoothing::dimensionless}},
        "parameter that sets the bending weight; paper_px2: lambda_px2; dimensionless: lambda");
    p.read("lambda_px2", lambda_px2_, "px^2 of the texture", {0, 1e15},
           "bending weight for paper_px2; depends on the size of the texture");
    p.read("lambda", lambda_, "", {0, 1e9},
           "bending weight for dimensionless, in areas of a knot cell; 0.001 interpolates, 1 is "
           "stiff");
    p.read("scale_with_count", scale_with_count_,
           "multiplication of the bending weight by (number of matches) / 200");
    p.read("ridge", ridge_, "", {0, 1},
           "weight of the pull to the affine map, relative to the largest diagonal element");
    p.choice(
        "robust", robust_,
        {{"off", Robust::off}, {"tukey", Robust::tukey}, {"geman_mcclure", Robust::geman_mcclure}},
        "refits with less weight on matches of large residual; off: none");
    p.read("tukey_refits", tukey_refits_, "", {1, 100}, "number of refits; for tukey");
    p.read(
        "scales_px", scales_px_, "px", {0.01, 1e4},
        "scales s of the refits, one each, with weights (s^2 / (s^2 + r^2))^2; for geman_mcclure");
  }

  weft::Result<weft::Warp> fit(const weft::FitInput& in) override;

  weft::Result<weft::WarpSamples> evaluate(const weft::EvaluateInput& in) override {
    auto model = weft::bbs::read_model(in.warp);
    if (!model) return model.error();
    return weft::bbs::evaluate_model(*model, in.points);
  }

 private:
  SplinePenalty penalty() const;
  weft::bbs::SplineSystem refit(const SplinePenalty& penalty, weft::bbs::SplineSystem system);
  bool reweight(std::size_t refit);
  double tukey_limit_px(const weft::Points2& residuals);
  weft::Warp make_warp(const SplinePenalty& penalty);

  int control_u_ = 12;
  int control_v_ = 12;
  double margin_px_ = 20.0;
  Smoothing smoothing_ = Smoothing::paper_px2;
  double lambda_px2_ = 500.0;
  double lambda_ = 0.1;
  bool scale_with_count_ = false;
  double ridge_ = 1e-9;
  Robust robust_ = Robust::off;
  int tukey_refits_ = 8;
  std::vector<double> scales_px_{20, 12, 8, 5, 4, 3, 3, 3};

  weft::bbs::SplineFit spline_;
  weft::warps::FitData data_;
  std::vector<double> weights_, scratch_;
};

weft::Result<weft::Warp> Bbs::fit(const weft::FitInput& in) {
  const weft::TextureBox box = weft::object_box(in.templ).grown(margin_px_);
  const weft::SplineDomain domain{box.u0, box.u1, box.v0, box.v1, control_u_, control_v_};
  if (auto checked = weft::check_domain(domain); !checked) return checked.error();
  spline_.set_domain(domain);
  if (auto taken = data_.take(in, box); !taken) return taken.error();
  spline_.set_data(data_.points_px(), data_.values_px());
  const SplinePenalty penalty = this->penalty();
  weights_ = data_.weights();
  weft::bbs::SplineSystem system = spline_.solve(weights_, penalty);
  if (system.pivot_ratio > 0.0) system = refit(penalty, system);
  if (!(system.pivot_ratio > 0.0)) {
    return weft::no_result(
        "the matches do not determine the warp: raise the smoothing or the ridge");
  }
  weft::Warp warp = make_warp(penalty);
  if (system.collinear) {
    return weft::degenerate(std::move(warp), weft::warps::kCollinearMatches);
  }
  if (system.pivot_ratio < kSingular) {
    return weft::degenerate(std::move(warp), "the matches hardly determine the warp");
  }
  return warp;
}

SplinePenalty Bbs::penalty() const {
  const weft::SplineDomain& domain = spline_.domain();
  double lambda_px2 =
      smoothing_ == Smoothing::paper_px2 ? lambda_px2_ : lambda_ * domain.su() * domain.sv();
  if (scale_with_count_) lambda_px2 *= static_cast<double>(data_.count()) / 200.0;
  return {lambda_px2, ridge_};
}

weft::bbs::SplineSystem Bbs::refit(const SplinePenalty& penalty, weft::bbs::SplineSystem system) {
  std::size_t refits = 0;
  if (robust_ == Robust::tukey) refits = weft::to_index(tukey_refits_);
  if (robust_ == Robust::geman_mcclure) refits = scales_px_.size();
  for (std::size_t i = 0; i < refits && system.pivot_ratio > 0.0 && reweight(i); ++i) {
    system = spline_.solve(weights_, penalty);
  }
  return system;
}

/// Weights from the residuals of the last fit; false, and no change, when too few would be left.
bool Bbs::reweight(std::size_t refit) {
  const weft::Points2& residuals = spline_.residuals();
  const double limit = robust_ == Robust::tukey ? tukey_limit_px(residuals) : scales_px_[refit];
  const double limit2 = limit * limit;
  scratch_.resize(weights_.size());
  std::size_t left = 0;
  for (std::size_t k = 0; k < scratch_.size(); ++k) {
    const double r2 = residuals.row(static_cast<Eigen::Index>(k)).squaredNorm();
    const double root =
        robust_ == Robust::tukey ? std::max(0.0, 1.0 - r2 / limit2) : limit2 / (limit2 + r2);
    scratch_[k] = data_.weights()[k] * root * root;
    left += scratch_[k] > 0.0 ? 1 : 0;
  }
  if (left < kFewestLeft) return false;
  weights_.swap(scratch_);
  return true;
}

double Bbs::tukey_limit_px(const weft::Points2& residuals) {
  scratch_.assign(residuals.data(), residuals.data() + residuals.size());
  for (double& component : scratch_) component = std::abs(component);
  return kTukey * std::max(weft::kSigmaPerMad * weft::median_in_place(scratch_), kLeastSigmaPx);
}

weft::Warp Bbs::make_warp(const SplinePenalty& penalty) {
  weft::Warp warp;
  warp.producer = "warps/bbs";
  weft::bbs::write_model(spline_.domain(), spline_.control(), warp);
  const weft::Points2& residuals = spline_.residuals();
  spline_.sample_determinants(kFoldingSteps, scratch_);
  const double smallest = *std::min_element(scratch_.begin(), scratch_.end());
  warp.diag.set("matches", static_cast<double>(data_.count()));
  warp.diag.set("dropped_outside", data_.dropped_outside());
  warp.diag.set("lambda_px2", penalty.lambda_px2);
  warp.diag.set("rms_residual_px",
                std::sqrt(residuals.squaredNorm() / static_cast<double>(residuals.rows())));
  warp.diag.set("min_det_jacobian", smallest);
  warp.diag.set("median_det_jacobian", weft::median_in_place(scratch_));
  warp.diag.set("mean_weight", weft::mean(weights_));
  return warp;
}

}  // namespace

WEFT_PLUGIN(Bbs, "warps/bbs", "1.2.0",
            "Fits a bicubic B-spline warp by least squares with a bending penalty.")
