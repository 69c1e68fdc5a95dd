// SPDX-License-Identifier: Apache-2.0
#include "local_models.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/texture_metric.hpp>

namespace weft::salzmann_local {
namespace {

/// Share of the size of a patch: smaller reliefs count as flat, and smaller differences as the
/// same.
constexpr double kSame = 1e-6;

/// Where a patch lies at rest, from its middle.
struct Layout {
  Points2 flat_m;  ///< [n,2] m, in the texture
  Points3 rest_m;  ///< [n,3] m
  double reach_m;  ///< [] m, from the middle in the texture

  Layout(const Template& templ, const Eigen::Vector2d& m_per_px,
         const std::vector<std::int32_t>& vertices)
      : flat_m(static_cast<Eigen::Index>(vertices.size()), 2), rest_m(flat_m.rows(), 3) {
    for (Eigen::Index k = 0; k < flat_m.rows(); ++k) {
      const std::int32_t v = vertices[to_index(k)];
      flat_m.row(k) = templ.flat_px.matrix<2>().row(v).cwiseProduct(m_per_px.transpose());
      rest_m.row(k) = templ.vertices_m.matrix<3>().row(v);
    }
    flat_m.rowwise() -= flat_m.colwise().mean().eval();
    rest_m.rowwise() -= rest_m.colwise().mean().eval();
    reach_m = flat_m.rowwise().norm().maxCoeff();
  }

  bool same_as(const Layout& other) const {
    return flat_m.rows() == other.flat_m.rows() &&
           (flat_m - other.flat_m).cwiseAbs().maxCoeff() <= kSame * reach_m &&
           (rest_m - other.rest_m).cwiseAbs().maxCoeff() <= kSame * reach_m;
  }
};

/// [n,k] orthonormal, what is orthogonal to 1 and to the rest shape [n,3].
Eigen::MatrixXd beyond_affine(const Points3& rest_m) {
  Eigen::MatrixXd affine(rest_m.rows(), 4);
  affine << Eigen::VectorXd::Constant(rest_m.rows(), rest_m.rowwise().norm().maxCoeff()), rest_m;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(affine.rows(), affine.cols());
  factor.setThreshold(kSame);
  factor.compute(affine);
  const Eigen::MatrixXd basis = factor.householderQ();
  return basis.rightCols(rest_m.rows() - factor.rank());
}

}  // namespace

LocalModel learn_model(const Points2& flat_m, const Points3& rest_m,
                       const std::vector<IsometricBend>& bends) {
  const Eigen::MatrixXd beyond = beyond_affine(rest_m);
  LocalModel model;
  if (beyond.cols() == 0) return model;
  Eigen::MatrixXd covariance_m2 = Eigen::MatrixXd::Zero(beyond.cols(), beyond.cols());
  Points3 bent_m(flat_m.rows(), 3);
  for (const IsometricBend& bend : bends) {
    worked(40 * flat_m.rows());
    for (Eigen::Index k = 0; k < flat_m.rows(); ++k)
      bent_m.row(k) = bend.at(flat_m.row(k)).transpose();
    const Eigen::MatrixXd departure_m = beyond.transpose() * bent_m;
    covariance_m2 += departure_m * departure_m.transpose();
  }
  covariance_m2 /= 3.0 * static_cast<double>(std::max<std::size_t>(bends.size(), 1));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> components(covariance_m2);
  model.modes = beyond * components.eigenvectors().rowwise().reverse();
  model.variances_m2 = components.eigenvalues().reverse().cwiseMax(0.0);
  return model;
}

Eigen::MatrixXd prior_rows(const LocalModel& model, double floor_m) {
  const Eigen::VectorXd deviations_m =
      (model.variances_m2.array() + floor_m * floor_m).sqrt().matrix();
  return deviations_m.cwiseInverse().asDiagonal() * model.modes.transpose();
}

Result<solvers::PatchPrior> local_models(const Template& templ, const LocalPatches& patches,
                                         double mean_edge_m, const LocalModelOptions& options) {
  const auto rest_m = templ.vertices_m.matrix<3>();
  const Eigen::Vector2d m_per_px =
      texel_pitch(rest_m, templ.flat_px.matrix<2>(), templ.faces.matrix<3>()).m_per_px;
  if (!m_per_px.allFinite()) {
    return Error{Errc::invalid_data, "a face has no area in the texture: correct 'flat_px'"};
  }
  std::vector<Layout> layouts;
  BendSpec spec;
  spec.reach_m = 0.0;
  for (const std::vector<std::int32_t>& patch : patches) {
    spec.reach_m = std::max(spec.reach_m, layouts.emplace_back(templ, m_per_px, patch).reach_m);
  }
  spec.size_m = (rest_m.colwise().maxCoeff() - rest_m.colwise().minCoeff()).norm();
  spec.turn_rad = options.turn_rad;
  spec.count = options.training_shapes;
  const std::vector<IsometricBend> bends = draw_bends(spec, options.seed);
  solvers::PatchPrior prior;
  std::vector<std::pair<const Layout*, std::size_t>> known;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    worked(static_cast<std::int64_t>(10 * known.size()));
    auto same = std::find_if(known.begin(), known.end(),
                             [&](const auto& one) { return layouts[p].same_as(*one.first); });
    if (same == known.end()) {
      const LocalModel model = learn_model(layouts[p].flat_m, layouts[p].rest_m, bends);
      if (model.modes.cols() == 0) continue;
      const std::size_t rows = prior.add_rows(prior_rows(model, options.floor_edges * mean_edge_m));
      same = known.insert(known.end(), {&layouts[p], rows});
    }
    prior.add_patch(patches[p], same->second);
  }
  return prior;
}

}  // namespace weft::salzmann_local
