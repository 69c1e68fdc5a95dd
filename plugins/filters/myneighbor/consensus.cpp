// SPDX-License-Identifier: Apache-2.0
#include "consensus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>

namespace weft::myneighbor {
namespace {

constexpr std::size_t kFewestMatches = 8;
constexpr std::int64_t kAuthorsFewestSelected = 51;
constexpr double kLeastWeight = -1e-9;  // barycentric, of a point inside its face
constexpr double kNextPassPart = 0.4;

Error add_place(Error error, const char* place) {
  error.message = std::string(place) + ": " + error.message;
  return error;
}

bool finite(const Correspondences& matches, std::int64_t i) {
  return std::isfinite(matches.template_px(i, 0)) && std::isfinite(matches.template_px(i, 1)) &&
         std::isfinite(matches.image_px(i, 0)) && std::isfinite(matches.image_px(i, 1)) &&
         matches.barycentrics.matrix<3>().row(i).allFinite();
}

Points2 rows_of(const Points2& points, const std::vector<Eigen::Index>& rows) {
  return points(rows, Eigen::all);
}

}  // namespace

Result<void> Consensus::run(const FilterInput& in) {
  flag_.clear();
  if (auto collected = collect(in); !collected) return collected;
  if (auto done = run_steps(in, Marks(candidates_.size(), 1)); !done) return done;
  for (int pass = 1; pass < options_.passes; ++pass) {
    const Marks near = near_the_warp();
    const auto count = std::count(near.begin(), near.end(), std::uint8_t{1});
    if (count < static_cast<std::ptrdiff_t>(kFewestMatches)) break;
    if (auto done = run_steps(in, near); !done) return done;
  }
  if (options_.refinement == Refinement::irls) return refit_robustly(in);
  return {};
}

/// The matches that are no clear mismatches: the neighbourhoods of a further pass.
Consensus::Marks Consensus::near_the_warp() const {
  const double limit_px = kNextPassPart * object_size_px();
  Marks near(candidates_.size());
  std::transform(distance_px_.begin(), distance_px_.end(), near.begin(),
                 [=](double distance_px) { return distance_px < limit_px ? 1 : 0; });
  return near;
}

Stage Consensus::stage(std::size_t k) const {
  if (trim_.kept[k] != 0) return Stage::trusted;
  return selection_.selected[k] != 0 ? Stage::selected : Stage::candidate;
}

double Consensus::object_size_px() const {
  if (options_.mode == Mode::paper) return mean_pair_distance(vertices_px_);
  std::vector<Eigen::Index> trusted;
  for (std::size_t k = 0; k < trim_.kept.size(); ++k) {
    if (trim_.kept[k] != 0) trusted.push_back(static_cast<Eigen::Index>(k));
  }
  return mean_pair_distance(rows_of(image_px_, trusted));
}

/// The matches that take part. The authors' program also takes those that lie on no face.
Result<void> Consensus::collect(const FilterInput& in) {
  const Correspondences& matches = in.correspondences;
  if (!in.templ) return Error{Errc::invalid_data, "the template is absent: connect it"};
  const auto faces = in.templ->faces.matrix<3>();
  if (auto legal = check_face_indices(faces, in.templ->flat_px.rows()); !legal) return legal;
  candidates_.clear();
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0) continue;
    if (!finite(matches, i)) {
      return Error{Errc::invalid_data, "match " + std::to_string(i) +
                                           " has a coordinate or a weight that is not finite"};
    }
    if (matches.face(i) >= faces.rows()) {
      return Error{Errc::invalid_data,
                   "match " + std::to_string(i) + " lies on a face that the template has not"};
    }
    if (matches.face(i) >= 0 || options_.mode == Mode::authors_code) candidates_.push_back(i);
  }
  if (candidates_.size() < kFewestMatches) {
    return no_result("too few matches on the template: " + std::to_string(candidates_.size()) +
                     " of 8");
  }
  template_px_ = matches.template_px.matrix<2>()(candidates_, Eigen::all);
  image_px_ = matches.image_px.matrix<2>()(candidates_, Eigen::all);
  if (used_.rows() != matches.count()) used_ = Array<std::uint8_t>({matches.count()});
  if (weights_.weight.rows() != matches.count()) {
    weights_.weight = Array<double>({matches.count()}, 0.0);
  }
  return {};
}

Result<void> Consensus::run_steps(const FilterInput& in, const Marks& active) {
  if (auto selected = select_by_neighbours(active); !selected) return selected;
  const std::vector<double> weights = neighbour_weights();
  const std::vector<double>* given = options_.weighted_fit ? &weights : nullptr;
  if (auto fitted = fit(in, selection_.selected, given); !fitted) {
    return add_place(fitted.error(), "step I");
  }
  if (auto measured = measure(in, options_.transfer); !measured) return measured;
  trim_by_distance(distance_px_, selection_.selected, trim_);
  if (auto fitted = fit(in, trim_.kept, given); !fitted) {
    return add_place(fitted.error(), "step II");
  }
  return measure(in, options_.transfer);
}

/// Step I among the active candidates: fills mismatch_ (NaN for the others) and selection_.
Result<void> Consensus::select_by_neighbours(const Marks& active) {
  std::vector<Eigen::Index> rows;
  for (std::size_t k = 0; k < active.size(); ++k) {
    if (active[k] != 0) rows.push_back(static_cast<Eigen::Index>(k));
  }
  if (!build_neighbour_sets(rows_of(template_px_, rows), in_template_)) {
    return no_result("the matches lie on a line in the template, to 2e-9 of its length");
  }
  if (!build_neighbour_sets(rows_of(image_px_, rows), in_image_)) {
    return no_result("the matches lie on a line in the image, to 2e-9 of its length");
  }
  const bool authors = options_.mode == Mode::authors_code;
  std::vector<double> factors(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    factors[i] = mismatch_factor_percent(in_template_, in_image_, i, authors ? 101.0 : 100.0);
    if (authors) factors[i] = std::floor(factors[i]);
  }
  const int least = authors ? 0 : options_.min_selected;
  select_small(factors, options_.mf_threshold_scale, least, selection_);
  if (authors && selection_.count < kAuthorsFewestSelected) {
    return no_result(
        "too few matches with similar neighbours: " + std::to_string(selection_.count) + " of 51");
  }
  const Marks selected = selection_.selected;
  selection_.selected.assign(candidates_.size(), 0);
  mismatch_.assign(candidates_.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    selection_.selected[to_index(rows[i])] = selected[i];
    mismatch_[to_index(rows[i])] = factors[i];
  }
  return {};
}

std::vector<double> Consensus::neighbour_weights() const {
  std::vector<double> weights(candidates_.size(), 1.0);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (selection_.selected[k] == 0 || !(selection_.mean_percent > 0.0)) continue;
    const double relative = mismatch_[k] / selection_.mean_percent;
    weights[k] = 1.0 / (1.0 + relative * relative);
  }
  return weights;
}

/// Robust refits on all candidates; the last distances are those to the warp itself.
Result<void> Consensus::refit_robustly(const FilterInput& in) {
  std::vector<double> weights(candidates_.size());
  const Marks all(candidates_.size(), 1);
  if (auto measured = measure(in, Transfer::warp); !measured) return measured;
  for (const double scale_px : options_.irls_scales_px) {
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const double root = 1.0 / (1.0 + std::pow(distance_px_[k] / scale_px, 2));
      weights[k] = root * root;
    }
    if (auto fitted = fit(in, all, &weights); !fitted) return add_place(fitted.error(), "refit");
    if (auto measured = measure(in, Transfer::warp); !measured) return measured;
  }
  return {};
}

/// Fits the nested warp to the marked candidates and warps the mesh.
Result<void> Consensus::fit(const FilterInput& in, const Marks& used,
                            const std::vector<double>* weights) {
  std::fill_n(used_.data(), used_.rows(), std::uint8_t{0});
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    used_(candidates_[k]) = used[k];
    if (weights != nullptr) weights_.weight(candidates_[k]) = (*weights)[k];
  }
  Correspondences marked = in.correspondences;
  marked.kept = used_;
  auto fitted = warp_.fit(in.call, marked, *in.templ, weights != nullptr ? &weights_ : nullptr);
  if (!fitted) return fitted.error();
  flag_ = fitted.degenerate_reason();
  fitted_ = *std::move(fitted);
  const auto samples = evaluate(in.call, fitted_, {in.templ->flat_px, 0});
  if (!samples) return samples.error();
  vertices_px_ = samples->xy_px.matrix<2>();
  if (!vertices_px_.allFinite()) return no_result("the warp of the mesh is not finite");
  return {};
}

/// Fills distance_px_: how far from its image point the last warp takes each candidate.
Result<void> Consensus::measure(const FilterInput& in, Transfer transfer) {
  const Correspondences& matches = in.correspondences;
  distance_px_.resize(candidates_.size());
  if (transfer == Transfer::warp) {
    const auto samples = evaluate(in.call, fitted_, {make_array<double>(template_px_), 0});
    if (!samples) return samples.error();
    const Points2 warped = samples->xy_px.matrix<2>();
    Eigen::Map<Eigen::VectorXd>(distance_px_.data(), warped.rows()) =
        (warped - image_px_).rowwise().norm();
    return {};
  }
  const auto faces = in.templ->faces.matrix<3>();
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const std::int64_t i = candidates_[k];
    const Eigen::RowVector3d weights = matches.barycentrics.matrix<3>().row(i);
    // To the authors' program a point outside the mesh is at the origin of the image.
    const bool outside = options_.mode == Mode::authors_code &&
                         (matches.face(i) < 0 || weights.minCoeff() < kLeastWeight);
    Eigen::RowVector2d warped = Eigen::RowVector2d::Zero();
    for (Eigen::Index corner = 0; corner < 3 && !outside; ++corner) {
      warped += weights[corner] * vertices_px_.row(faces(matches.face(i), corner));
    }
    distance_px_[k] = (warped - image_px_.row(static_cast<Eigen::Index>(k))).norm();
  }
  return {};
}

}  // namespace weft::myneighbor
