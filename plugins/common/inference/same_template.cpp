// SPDX-License-Identifier: Apache-2.0
#include "common/inference/same_template.hpp"

#include <cmath>
#include <cstdio>
#include <string>
#include <weft/data/matrix.hpp>

#include "common/inference/hash.hpp"

namespace weft::inference {
namespace {

constexpr double kSameSize = 1e-6;  // relative
constexpr double kFlat = 1e-6;      // share of the diagonal
constexpr double kStraight_px = 0.01;

Error not_flat(const std::string& how) {
  return {Errc::unsupported, "the network needs a flat rectangular template, but this one " + how +
                                 ": use templates/rectangular or templates/photo"};
}

std::string size_of(double width_m, double height_m) {
  char text[80];
  std::snprintf(text, sizeof text, "%.10g x %.10g m", width_m, height_m);
  return text;
}

bool is_same(double a, double b) { return std::abs(a - b) <= kSameSize * std::abs(b); }

}  // namespace

Result<FlatSheet> flat_sheet(const Template& templ) {
  if (templ.vertices_m.rows() < 3 || !templ.texture.present()) {
    return not_flat("has no mesh or no texture");
  }
  const auto rest_m = templ.vertices_m.matrix<3>();
  const auto flat_px = templ.flat_px.matrix<2>();
  FlatSheet sheet;
  const Eigen::RowVector3d low_m = rest_m.colwise().minCoeff();
  const Eigen::RowVector3d extent_m = rest_m.colwise().maxCoeff() - low_m;
  sheet.corner_m = low_m.head<2>().transpose();
  sheet.size_m = extent_m.head<2>().transpose();
  sheet.corner_px = flat_px.colwise().minCoeff().transpose();
  sheet.size_px = flat_px.colwise().maxCoeff().transpose().array() - sheet.corner_px;
  if (!(sheet.size_m.minCoeff() > 0.0) || !(sheet.size_px.minCoeff() > 0.0)) {
    return not_flat("has no extent along x or y");
  }
  if (extent_m.z() > kFlat * extent_m.norm()) return not_flat("is not flat at rest");
  for (Eigen::Index v = 0; v < rest_m.rows(); ++v) {
    const Eigen::Array2d texel = sheet.texel(sheet.shares(rest_m(v, 0), rest_m(v, 1)));
    const double off_px = (texel - flat_px.row(v).transpose().array()).abs().maxCoeff();
    if (!(off_px <= kStraight_px)) return not_flat("has a texture that is turned or distorted");
  }
  return sheet;
}

Result<void> check_same_template(const NetworkFile& file, const Template& templ,
                                 const FlatSheet& sheet) {
  const TrainedTemplate& trained = file.templ;
  const auto other = [&](const std::string& what) {
    return Error{Errc::unsupported, file.path +
                                        ": the network was trained for another template: " + what +
                                        "; train one with this template or give its " + "template"};
  };
  if (!is_same(sheet.size_m.x(), trained.width_m) || !is_same(sheet.size_m.y(), trained.height_m)) {
    return other(size_of(trained.width_m, trained.height_m) + " instead of " +
                 size_of(sheet.size_m.x(), sheet.size_m.y()));
  }
  const std::string hash = texture_hash(templ.texture);
  if (hash == trained.texture_hash) return {};
  return other("its texture has the hash " + trained.texture_hash + ", this one " + hash);
}

}  // namespace weft::inference
