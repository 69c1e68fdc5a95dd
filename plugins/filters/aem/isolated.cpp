// SPDX-License-Identifier: Apache-2.0
#include "isolated.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/stop_check.hpp>

namespace weft::aem {
namespace {

constexpr Eigen::Index kCells = 8;     // cells of the template along each side
constexpr double kMuchCompany = 8.0;   // expected number of inliers around one, from which on their
                                       // absence counts
constexpr double kMissing = 0.15;      // share of these, below which it is isolated
constexpr double kEnough = 4.0;        // correct ones around it, with which it never is
constexpr double kPriorMatches = 2.0;  // with the share of all, added to those around

double log_odds(double probability) { return std::log(probability / (1.0 - probability)); }

/// Sums over cells of the template and those around them.
class Neighbourhood {
 public:
  explicit Neighbourhood(const Matches& matches) : matches_(matches) { sums_.setZero(); }

  void add(Eigen::Index i, double value) { sums_(row(i), column(i)) += value; }
  double around(Eigen::Index i) const {
    const Eigen::Index r = std::max<Eigen::Index>(row(i) - 1, 0);
    const Eigen::Index c = std::max<Eigen::Index>(column(i) - 1, 0);
    return sums_.block(r, c, std::min(row(i) + 2, kCells) - r, std::min(column(i) + 2, kCells) - c)
        .sum();
  }

 private:
  static Eigen::Index cell(double place_px, double size_px) {
    const auto number = static_cast<Eigen::Index>(kCells * place_px / size_px);
    return std::clamp<Eigen::Index>(number, 0, kCells - 1);
  }
  Eigen::Index row(Eigen::Index i) const {
    return cell(matches_.template_px(i, 1) - matches_.box.v0, matches_.box.height_px());
  }
  Eigen::Index column(Eigen::Index i) const {
    return cell(matches_.template_px(i, 0) - matches_.box.u0, matches_.box.width_px());
  }

  const Matches& matches_;
  Eigen::Array<double, kCells, kCells> sums_;
};

}  // namespace

Isolated find_isolated(const Matches& matches, const Eigen::ArrayXd& logit, double share) {
  const Eigen::ArrayXd probability = 1.0 / (1.0 + (-logit).exp());
  Neighbourhood correct(matches), all(matches);
  for (Eigen::Index i = 0; i < matches.count(); ++i) {
    correct.add(i, probability[i]);
    all.add(i, 1.0);
  }
  Isolated isolated(matches.count());
  for (Eigen::Index i = 0; i < matches.count(); ++i) {
    if (logit[i] <= 0.0) continue;
    worked(20);
    const double others = all.around(i) - 1.0, expected = share * others;
    const double company = correct.around(i) - probability[i];
    if (expected < kMuchCompany || company >= std::min(kEnough, kMissing * expected)) continue;
    isolated.is[i] = true;
    isolated.shift[i] =
        log_odds((company + kPriorMatches * share) / (others + kPriorMatches)) - log_odds(share);
  }
  return isolated;
}

}  // namespace weft::aem
