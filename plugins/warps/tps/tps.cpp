// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/warp_model.hpp>

#include "thin_plate.hpp"

namespace {

using weft::Errc;
using weft::Error;
using weft::ThinPlateSpline;
using weft::tps::Fitted;

enum class Centres { grid, matches };
enum class Smoothing { fixed, leave_one_out };

constexpr int kFoldingSteps = 10;
constexpr double kLeastLog = -8.0, kLargestLog = 1.0;  // logarithm of lambda, for leave_one_out
constexpr int kSearchSteps = 14;

/// A thin-plate spline from the texture to the image, with a centre at each match or on a grid.
class Tps final : public weft::WarpModel {
 public:
  static constexpr weft::About kAbout{
      .reference =
          "paper: Duchon 1976; Bookstein 1989, IEEE PAMI 11(6); Bartoli et al. 2010, IJCV 88",
      .reads = "weights"};

  explicit Tps(weft::Params& p) {
    p.choice(
        "centres", centres_, {{"grid", Centres::grid}, {"matches", Centres::matches}},
        "positions of the spline's centres; grid: on a regular grid; matches: one at each match");
    p.read("grid_u", grid_u_, "", {2, 40}, "number of centres along the domain's width");
    p.read("grid_v", grid_v_, "", {2, 40}, "number of centres along the domain's height");
    p.read("most_matches", most_matches_, "", {3, 5000},
           "number of matches above which the grid replaces centres at matches");
    p.read("margin_px", margin_px_, "px of the texture", {0, 1e4},
           "width of the border that the domain adds to the object's box in the texture");
    p.choice("smoothing", smoothing_,
             {{"fixed", Smoothing::fixed}, {"leave_one_out", Smoothing::leave_one_out}},
             "choice of the bending weight; fixed: lambda; leave_one_out: the best value between "
             "1e-8 and 10 by cross-validation");
    p.read("lambda", lambda_, "", {0, 1e9},
           "bending weight per match, for fixed; 0 interpolates, 1 is stiff");
  }

  weft::Result<weft::Warp> fit(const weft::FitInput& in) override;
  weft::Result<weft::WarpSamples> evaluate(const weft::EvaluateInput& in) override;

 private:
  std::optional<Fitted> fit_with(double lambda, bool leave_one_out = false);
  std::optional<Fitted> search();
  double predicted_px2(double log_lambda);
  Fitted affine_only(const weft::warps::AffineFit& affine) const;
  weft::Warp make_warp(const ThinPlateSpline& spline, const weft::TextureBox& box,
                       double rms_px) const;

  Centres centres_ = Centres::grid;
  int grid_u_ = 8;
  int grid_v_ = 5;
  int most_matches_ = 1500;
  double margin_px_ = 20.0;
  Smoothing smoothing_ = Smoothing::fixed;
  double lambda_ = 1e-4;

  weft::warps::FitData data_;
  weft::tps::GridFit grid_;
  bool on_grid_ = true;
  double used_lambda_ = 0.0;
};

std::optional<Fitted> Tps::fit_with(double lambda, bool leave_one_out) {
  const weft::tps::Samples samples{data_.points_px(), data_.values_px(), data_.weights()};
  return on_grid_ ? grid_.fit(samples, lambda, leave_one_out)
                  : weft::tps::fit_at_matches(samples, lambda, leave_one_out);
}

/// How far the values are from what the others predict, their squares summed.
double Tps::predicted_px2(double log_lambda) {
  const auto fitted = fit_with(std::pow(10.0, log_lambda), true);
  if (!fitted) return std::numeric_limits<double>::infinity();
  const Eigen::Map<const Eigen::VectorXd> weights(data_.weights().data(),
                                                  static_cast<Eigen::Index>(data_.count()));
  return weights.dot(fitted->left_out_px.rowwise().squaredNorm());
}

/// Golden section over log10 lambda.
std::optional<Fitted> Tps::search() {
  constexpr double kGolden = 0.6180339887498949;
  double low = kLeastLog, high = kLargestLog;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = predicted_px2(left);
  double at_right = predicted_px2(right);
  for (int i = 0; i < kSearchSteps; ++i) {
    if (at_left <= at_right) {
      high = std::exchange(right, left);
      left = high - kGolden * (high - low);
      at_right = std::exchange(at_left, predicted_px2(left));
    } else {
      low = std::exchange(left, right);
      right = low + kGolden * (high - low);
      at_left = std::exchange(at_right, predicted_px2(right));
    }
  }
  used_lambda_ = std::pow(10.0, 0.5 * (low + high));
  return fit_with(used_lambda_);
}

/// The affine map or what fewer matches determine of it, where they determine no more.
Fitted Tps::affine_only(const weft::warps::AffineFit& affine) const {
  Fitted fitted;
  fitted.spline.centre = affine.centre_px.transpose();
  fitted.spline.affine << affine.offset_px, affine.slope;
  fitted.residuals_px.resize(data_.points_px().rows(), 2);
  for (Eigen::Index k = 0; k < fitted.residuals_px.rows(); ++k) {
    fitted.residuals_px.row(k) = data_.values_px().row(k) - affine(data_.points_px().row(k));
  }
  return fitted;
}

weft::Result<weft::Warp> Tps::fit(const weft::FitInput& in) {
  const weft::TextureBox box = weft::object_box(in.templ).grown(margin_px_);
  if (auto taken = data_.take(in, box); !taken) return taken.error();
  on_grid_ = centres_ == Centres::grid || data_.count() > weft::to_index(most_matches_);
  if (on_grid_) grid_.set_grid(box, grid_u_, grid_v_);
  const weft::warps::AffineFit affine =
      weft::warps::fit_affine(data_.points_px(), data_.values_px(), data_.weights());
  used_lambda_ = lambda_;
  std::optional<Fitted> fitted;
  if (!affine.collinear) {
    fitted = smoothing_ == Smoothing::leave_one_out ? search() : fit_with(lambda_);
  }
  const bool determined = fitted.has_value();
  if (!determined) fitted = affine_only(affine);
  const double rms_px =
      std::sqrt(fitted->residuals_px.squaredNorm() / static_cast<double>(data_.count()));
  weft::Warp warp = make_warp(fitted->spline, box, rms_px);
  if (affine.collinear) {
    return weft::degenerate(std::move(warp), weft::warps::kCollinearMatches);
  }
  if (!determined) {
    return weft::degenerate(std::move(warp),
                            "the matches do not determine a spline: the warp is affine");
  }
  return warp;
}

weft::Warp Tps::make_warp(const ThinPlateSpline& spline, const weft::TextureBox& box,
                          double rms_px) const {
  weft::Warp warp;
  warp.producer = "warps/tps";
  warp.domain_px = weft::make_array<double>(Eigen::Vector4d(box.u0, box.u1, box.v0, box.v1));
  warp.model.entries = {{"model.frame", weft::make_array<double>(Eigen::Vector3d(
                                            spline.centre.x(), spline.centre.y(), spline.scale))},
                        {"model.centres", weft::make_array<double>(spline.centres)},
                        {"model.coefficients", weft::make_array<double>(spline.coefficients)},
                        {"model.affine", weft::make_array<double>(spline.affine)}};
  std::vector<double> determinants;
  for (int a = 0; a < kFoldingSteps; ++a) {
    for (int b = 0; b < kFoldingSteps; ++b) {
      const Eigen::RowVector2d point(box.u0 + (a + 0.5) / kFoldingSteps * (box.u1 - box.u0),
                                     box.v0 + (b + 0.5) / kFoldingSteps * (box.v1 - box.v0));
      determinants.push_back(weft::tps::evaluate(spline, point, 1).jacobian.determinant());
    }
  }
  warp.diag.set("matches", static_cast<double>(data_.count()));
  warp.diag.set("dropped_outside", data_.dropped_outside());
  warp.diag.set("centres", static_cast<double>(spline.centres.rows()));
  warp.diag.set("lambda", used_lambda_);
  warp.diag.set("rms_residual_px", rms_px);
  warp.diag.set("min_det_jacobian", *std::min_element(determinants.begin(), determinants.end()));
  warp.diag.set("median_det_jacobian", weft::median_in_place(determinants));
  return warp;
}

weft::Result<weft::WarpSamples> Tps::evaluate(const weft::EvaluateInput& in) {
  const auto part = [&](const char* name, std::int64_t columns) -> const weft::Array<double>* {
    const weft::Array<double>* found = in.warp.model.find(name);
    const bool whole =
        found != nullptr &&
        (columns == 0 ? found->size() == 3 : found->ndim() == 2 && found->dim(1) == columns);
    return whole ? found : nullptr;
  };
  const auto* frame = part("model.frame", 0);
  const auto* centres = part("model.centres", 2);
  const auto* coefficients = part("model.coefficients", 2);
  const auto* affine = part("model.affine", 2);
  if (frame == nullptr || centres == nullptr || coefficients == nullptr || affine == nullptr ||
      centres->rows() != coefficients->rows() || affine->rows() != 3 || !(*frame->row(2) > 0.0)) {
    return Error{Errc::invalid_data,
                 "the warp holds no thin-plate spline: it was not made by warps/tps, evaluate it "
                 "with '" +
                     in.warp.producer + "'"};
  }
  ThinPlateSpline spline;
  spline.centre << *frame->row(0), *frame->row(1);
  spline.scale = *frame->row(2);
  spline.centres = centres->matrix<2>();
  spline.coefficients = coefficients->matrix<2>();
  spline.affine = affine->matrix<2>();
  const auto border = in.warp.domain_px.matrix<1>();
  const weft::TextureBox box{border[0], border[1], border[2], border[3]};
  auto samples = weft::warps::make_samples(in.points);
  if (!samples) return samples.error();
  for (std::int64_t i = 0; i < in.points.xy_px.rows(); ++i) {
    const Eigen::RowVector2d point = in.points.xy_px.matrix<2>().row(i);
    weft::worked(2 * centres->rows());
    weft::warps::WarpAt at = weft::tps::evaluate(spline, point, in.points.order);
    at.inside = box.contains(point.x(), point.y());
    weft::warps::set_sample(*samples, i, at);
  }
  return samples;
}

}  // namespace

WEFT_PLUGIN(Tps, "warps/tps", "1.2.0",
            "Fits a thin-plate spline warp, exact or with centres on a grid.")
