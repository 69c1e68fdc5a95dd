// SPDX-License-Identifier: Apache-2.0
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/object_box.hpp>
#include <weft/sdk/warp_model.hpp>

namespace {

constexpr const char* kId = "warps/my_plugin";
constexpr std::int64_t kFewest = 6;  ///< matches, as many as terms
constexpr double kDetermined = 1e-6;

using Terms = Eigen::Matrix<double, 1, kFewest>;
using Coefficients = Eigen::Matrix<double, kFewest, 2>;

/// The terms of a quadratic polynomial in (s, t) = ((u, v) - centre) / scale, and what they become
/// when they are derived by u and v, px of the texture.
struct Quadratic {
  double centre_u = 0.0, centre_v = 0.0, scale = 1.0;

  Terms value(double u, double v) const {
    const double s = (u - centre_u) / scale, t = (v - centre_v) / scale;
    return (Terms() << 1.0, s, t, s * s, s * t, t * t).finished();
  }
  Terms by_u(double u, double v) const {
    const double s = (u - centre_u) / scale, t = (v - centre_v) / scale;
    return (Terms() << 0.0, 1.0, 0.0, 2.0 * s, t, 0.0).finished() / scale;
  }
  Terms by_v(double u, double v) const {
    const double s = (u - centre_u) / scale, t = (v - centre_v) / scale;
    return (Terms() << 0.0, 0.0, 1.0, 0.0, s, 2.0 * t).finished() / scale;
  }
  Terms by_uu() const {
    return (Terms() << 0.0, 0.0, 0.0, 2.0, 0.0, 0.0).finished() / (scale * scale);
  }
  Terms by_uv() const {
    return (Terms() << 0.0, 0.0, 0.0, 0.0, 1.0, 0.0).finished() / (scale * scale);
  }
  Terms by_vv() const {
    return (Terms() << 0.0, 0.0, 0.0, 0.0, 0.0, 2.0).finished() / (scale * scale);
  }
};

/// The quadratic polynomial from texture to image that is nearest to the matches.
class MyPluginWarp final : public weft::WarpModel {
 public:
  static constexpr weft::About kAbout{.reads = "weights"};

  explicit MyPluginWarp(weft::Params& p) {
    p.read("margin_px", margin_px_, "px of the texture", {0, 10000},
           "width of the border that the warp's domain adds to the object's box in the texture");
  }

  weft::Result<weft::Warp> fit(const weft::FitInput& in) override {
    const weft::Correspondences& matches = in.correspondences;
    if (in.weights && in.weights->weight.rows() != matches.count()) {
      return weft::Error{weft::Errc::invalid_data, "there is not one weight for each match"};
    }
    std::vector<std::int64_t> used;
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      if (matches.kept(i) != 0 && weight_of(in, i) > 0.0) used.push_back(i);
    }
    const std::int64_t count = std::ssize(used);
    if (count < kFewest) {
      return weft::no_result(std::to_string(count) + " matches count; at least " +
                             std::to_string(kFewest) + " are needed");
    }
    const weft::TextureBox box = weft::object_box(in.templ).grown(margin_px_);
    const Quadratic map{0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1),
                        0.5 * std::max(box.width_px(), box.height_px())};
    Eigen::MatrixXd terms(count, kFewest), seen_px(count, 2);
    for (std::int64_t k = 0; k < count; ++k) {
      const std::int64_t i = used[weft::to_index(k)];
      const double root = std::sqrt(weight_of(in, i));
      terms.row(k) = root * map.value(matches.template_px(i, 0), matches.template_px(i, 1));
      seen_px.row(k) << root * matches.image_px(i, 0), root * matches.image_px(i, 1);
    }
    weft::worked(10 * count);
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> equations(terms);
    equations.setThreshold(kDetermined);
    if (equations.rank() < kFewest) {
      return weft::no_result("the matches lie on a line, a circle or the like");
    }
    const Coefficients coefficients = equations.solve(seen_px);

    weft::Warp warp;
    warp.producer = kId;
    warp.domain_px = weft::make_array<double>(Eigen::Vector4d(box.u0, box.u1, box.v0, box.v1));
    warp.model.entries = {{"model.frame", weft::make_array<double>(Eigen::Vector3d(
                                              map.centre_u, map.centre_v, map.scale))},
                          {"model.coefficients", weft::make_array<double>(coefficients)}};
    warp.diag.set("rms_residual_px",
                  (terms * coefficients - seen_px).norm() / std::sqrt(static_cast<double>(count)));
    return warp;
  }

  weft::Result<weft::WarpSamples> evaluate(const weft::EvaluateInput& in) override {
    const weft::Array<double>* frame = in.warp.model.find("model.frame");
    const weft::Array<double>* model = in.warp.model.find("model.coefficients");
    if (frame == nullptr || frame->size() != 3 || model == nullptr || model->rows() != kFewest ||
        model->row_elements() != 2 || in.warp.domain_px.size() != 4) {
      return weft::Error{weft::Errc::invalid_data, "the warp was not made by warps/my_plugin"};
    }
    const std::int64_t order = in.points.order, count = in.points.xy_px.rows();
    if (order < 0 || order > 2) {
      return weft::Error{weft::Errc::invalid_value, "derivatives have the order 0, 1 or 2"};
    }
    const Quadratic map{*frame->row(0), *frame->row(1), *frame->row(2)};
    const Coefficients coefficients = model->matrix<2>();
    const auto domain = in.warp.domain_px.matrix<1>();
    const weft::TextureBox box{domain[0], domain[1], domain[2], domain[3]};

    weft::WarpSamples samples;
    samples.xy_px = weft::Array<double>({count, 2});
    if (order >= 1) samples.jacobian = weft::Array<double>({count, 2, 2});
    if (order >= 2) samples.hessian = weft::Array<double>({count, 2, 3});
    samples.valid = weft::Array<std::uint8_t>({count});
    for (std::int64_t i = 0; i < count; ++i) {
      weft::worked_in_loop(i, 10);
      const double u = in.points.xy_px(i, 0), v = in.points.xy_px(i, 1);
      const auto put = [&](weft::Array<double>& into, std::int64_t columns, std::int64_t column,
                           const Terms& terms) {
        const Eigen::RowVector2d xy = terms * coefficients;
        into(i, column) = xy.x();
        into(i, columns + column) = xy.y();
      };
      put(samples.xy_px, 1, 0, map.value(u, v));
      if (order >= 1) {
        put(samples.jacobian, 2, 0, map.by_u(u, v));
        put(samples.jacobian, 2, 1, map.by_v(u, v));
      }
      if (order >= 2) {
        put(samples.hessian, 3, 0, map.by_uu());
        put(samples.hessian, 3, 1, map.by_uv());
        put(samples.hessian, 3, 2, map.by_vv());
      }
      samples.valid(i) = box.contains(u, v) ? 1 : 0;  // 0 for NaN, too
    }
    return samples;
  }

 private:
  static double weight_of(const weft::FitInput& in, std::int64_t match) {
    return in.weights ? in.weights->weight(match) : 1.0;
  }

  double margin_px_ = 20.0;
};

}  // namespace

WEFT_PLUGIN(MyPluginWarp, "warps/my_plugin", "1.0.0", "Fits a quadratic polynomial to the matches.")
