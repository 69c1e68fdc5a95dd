// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

#include "common/candidates.hpp"
#include "common/nearest.hpp"

namespace {

using weft::FilterInput;
using weft::InlierMask;
using weft::Points2;
using weft::filters::Nearest;

constexpr int kRounds = 3;      // rounds of the first test
constexpr double kFlat = 1e-9;  // pivot ratio below which neighbours are on a line
constexpr int kFewestForAffine = 4;

/// The prediction of a match by its neighbours.
struct Predicted {
  double residual = std::numeric_limits<double>::infinity();  ///< [] in spacings of neighbours
  double oriented = 0.0;  ///< [] share of triangles that keep their orientation
};

/// Keeps the matches that have the same neighbours in both images and that a local affine map of
/// these predicts.
class Famouri final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{
      .reference =
          "reconstruction: Famouri, Bartoli and Azimifar 2018, Machine Vision and Applications 29"};
  static constexpr weft::Sweep kSweep{"tau2", {0.02, 0.1, 0.2, 0.3, 0.5, 0.7, 1, 2.5, 5}};

  explicit Famouri(weft::Params& p) {
    p.read("neighbours", neighbours_, "", {4, 100}, "number of nearest neighbours of a match");
    p.read("tau1", tau1_, "", {0, 1},
           "minimum share of neighbours that are the same in template and image");
    p.read("tau2", tau2_, "", {0, 100},
           "maximum prediction error of a kept match, in spacings of its neighbours in the image");
    p.read("least_oriented", least_oriented_, "", {0, 1},
           "minimum share of triangles with two neighbours that keep their orientation");
  }

  weft::Result<InlierMask> filter(const FilterInput& in) override {
    const auto candidates = weft::filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    const std::size_t n = candidates->count();
    if (n <= weft::to_index(neighbours_)) {
      return weft::no_result("too few matches for neighbourhoods: " + std::to_string(n) + " of " +
                             std::to_string(neighbours_ + 1));
    }
    const std::vector<int> survivors = with_common_neighbours(*candidates);
    const bool enough = survivors.size() > weft::to_index(kFewestForAffine);
    std::vector<std::uint8_t> keep(n, 0);
    std::vector<double> score(n, 0.0);
    if (enough) {
      const Nearest near =
          weft::filters::nearest_of(candidates->template_px, survivors, neighbours_);
      for (const int i : survivors) {
        weft::worked(20 * neighbours_ + neighbours_ * neighbours_);
        const Predicted predicted = predict(*candidates, near, i);
        const auto k = weft::to_index(i);
        const bool oriented = predicted.oriented >= least_oriented_;
        keep[k] = oriented && predicted.residual < tau2_ ? 1 : 0;
        score[k] = oriented && tau2_ > 0.0 ? tau2_ / (tau2_ + predicted.residual) : 0.0;
      }
    }
    InlierMask mask = weft::filters::mask_of(in.correspondences, *candidates, keep, score);
    mask.diag.set("with_common_neighbours", static_cast<double>(survivors.size()));
    if (!enough) {
      return weft::degenerate(std::move(mask), "only " + std::to_string(survivors.size()) +
                                                   " matches have common neighbours");
    }
    return mask;
  }

 private:
  /// Those that share neighbours in both images; the others are removed.
  std::vector<int> with_common_neighbours(const weft::filters::Candidates& candidates) const {
    std::vector<int> among(candidates.count());
    std::iota(among.begin(), among.end(), 0);
    for (int round = 0; round < kRounds; ++round) {
      const Nearest in_template =
          weft::filters::nearest_of(candidates.template_px, among, neighbours_);
      const Nearest in_image = weft::filters::nearest_of(candidates.image_px, among, neighbours_);
      const std::size_t before = among.size();
      std::erase_if(among, [&](int i) {
        const int* end = in_image.row(i).data() + neighbours_;
        int common = 0;
        for (int k = 0; k < neighbours_; ++k) {
          const int j = in_template(i, k);
          common += j >= 0 && std::find(in_image.row(i).data(), end, j) != end ? 1 : 0;
        }
        return common < tau1_ * neighbours_;
      });
      if (among.size() == before) break;
    }
    return among;
  }

  /// The affine map of the neighbours, the nearer the weightier, at the match.
  static Predicted predict(const weft::filters::Candidates& candidates, const Nearest& near,
                           int i) {
    const Points2 &p = candidates.template_px, &q = candidates.image_px;
    std::vector<int> others;
    std::vector<double> distances_px, spacings_px;
    for (Eigen::Index k = 0; k < near.cols() && near(i, k) >= 0; ++k) {
      others.push_back(near(i, k));
      distances_px.push_back((p.row(others.back()) - p.row(i)).norm());
      spacings_px.push_back((q.row(others.back()) - q.row(i)).norm());
    }
    Predicted predicted;
    if (others.size() < weft::to_index(kFewestForAffine)) return predicted;
    const double h_px = weft::median(distances_px), spacing_px = weft::median(spacings_px);
    if (!(h_px > 0.0) || !(spacing_px > 0.0)) return predicted;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> moments = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::size_t k = 0; k < others.size(); ++k) {
      const Eigen::RowVector2d d = (p.row(others[k]) - p.row(i)) / h_px;
      const Eigen::Vector3d basis(1.0, d.x(), d.y());
      const double weight = std::exp(-0.5 * d.squaredNorm());
      normal += weight * basis * basis.transpose();
      moments += weight * basis * (q.row(others[k]) - q.row(i));
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    const auto pivots = solver.vectorD();
    if (!(pivots.minCoeff() > kFlat * pivots.maxCoeff())) return predicted;
    const Eigen::Matrix<double, 3, 2> map = solver.solve(moments);
    predicted.residual = map.row(0).norm() / spacing_px;
    predicted.oriented = oriented_share(p, q, i, others);
    return predicted;
  }

  static double oriented_share(const Points2& p, const Points2& q, int i,
                               const std::vector<int>& others) {
    const auto side = [&](const Points2& points, int j, int l) {
      const Eigen::RowVector2d a = points.row(j) - points.row(i), b = points.row(l) - points.row(i);
      return a.x() * b.y() - a.y() * b.x();
    };
    int alike = 0, compared = 0;
    for (std::size_t j = 0; j < others.size(); ++j) {
      for (std::size_t l = j + 1; l < others.size(); ++l) {
        ++compared;
        alike += side(p, others[j], others[l]) * side(q, others[j], others[l]) > 0.0 ? 1 : 0;
      }
    }
    return compared > 0 ? static_cast<double>(alike) / compared : 0.0;
  }

  int neighbours_ = 8;
  double tau1_ = 0.25;
  double tau2_ = 0.3;
  double least_oriented_ = 0.6;
};

}  // namespace

WEFT_PLUGIN(Famouri, "filters/famouri", "1.0.0",
            "Rejects matches that their nearest neighbours do not predict.")
