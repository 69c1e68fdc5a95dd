// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/texture_survey.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>

#include "host/roles/role_rules.hpp"
#include "pipeline/execution/compose.hpp"
#include "pipeline/survey/texture_view.hpp"

namespace weft {
namespace {

constexpr double kView_px = 400.0;       // a surface that fills two thirds of an image of 640 px
constexpr std::uint64_t kSeed = 1;       // seed of the view's noise
constexpr double kRatio = 0.8;           // threshold of the matchers' ratio test
constexpr double kUsualDistance = 0.25;  // distance of inliers (RootSIFT), where there are too few

// Half of the matches may be hidden or blurred, and 30 are the least that a template is checked by.
constexpr std::int64_t kFewestMatches = 60;
// With every fourth keypoint ambiguous, copies of a place get as many matches as a filter bears.
constexpr double kMostTwins = 0.25;
// A circle of two edges holds a whole cell of the mesh wherever it lies.
constexpr double kMostGapEdges = 2.0, kMostGapOfSize = 0.1;

using Floats = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The product of a stage for these inputs; null if the data do not determine an answer.
Result<host::RecordPtr> made_by(host::ExecutionContext& context, host::Instance& instance,
                                std::span<const weft_record> inputs, const char* slot) {
  const host::Outcome outcome = context.call(instance, kRunStage, inputs, host::kOfflineFrame);
  if (outcome.usable()) return outcome.find(slot);
  if (outcome.status == WEFT_NO_RESULT) return host::RecordPtr();
  return outcome.error;
}

/// Null where there are none.
struct FoundKeypoints {
  host::RecordPtr of_texture;  ///< with their places on the mesh
  host::RecordPtr of_view;
};

Result<FoundKeypoints> keypoints_of(host::ExecutionContext& context, host::Instance& detector,
                                    const TextureView& view, const host::Record& templ) {
  const auto texture = texture_input(templ);
  if (!texture) return texture.error();
  const auto view_record = host::Record::copy_of(view.image);
  if (texture->image == nullptr || texture->region == nullptr || view_record == nullptr) {
    return Error{Errc::no_memory, "no memory for a view of the texture"};
  }
  const weft_record texture_inputs[] = {texture->image->view("image"),
                                        texture->region->view("region")};
  const weft_record view_inputs[] = {view_record->view("image")};
  auto of_texture = made_by(context, detector, texture_inputs, "keypoints");
  if (!of_texture) return of_texture.error();
  auto of_view = made_by(context, detector, view_inputs, "keypoints");
  if (!of_view) return of_view.error();
  FoundKeypoints found{nullptr, *std::move(of_view)};
  if (*of_texture == nullptr) return found;
  auto located = locate_on_template(**of_texture, templ);
  if (!located) return located.error();
  found.of_texture = *std::move(located);
  return found;
}

/// The inliers of the texture with a view of it.
struct RightMatches {
  std::vector<Eigen::Vector2d> places_px;  ///< places in the texture
  std::vector<double> distances;           ///< distances of their descriptors
};

Result<RightMatches> right_matches(host::ExecutionContext& context, host::Instance& matcher,
                                   const FoundKeypoints& found, const TextureView& view) {
  constexpr double kRight_px = 2.0;
  RightMatches right;
  if (found.of_view == nullptr) return right;
  const weft_record inputs[] = {found.of_view->view("keypoints"),
                                found.of_texture->view("template_keypoints")};
  const auto record = made_by(context, matcher, inputs, "correspondences");
  if (!record) return record.error();
  if (*record == nullptr) return right;
  const auto matches = host::view_as<Correspondences>(**record);
  if (!matches) return matches.error();
  for (std::int64_t i = 0; i < matches->count(); ++i) {
    const Eigen::Vector2d place(matches->template_px(i, 0), matches->template_px(i, 1));
    const Eigen::Vector2d seen(matches->image_px(i, 0), matches->image_px(i, 1));
    if ((view.seen_at(place) - seen).norm() > kRight_px) continue;
    right.places_px.push_back(place);
    if (matches->distance.present()) right.distances.push_back(matches->distance(i));
  }
  return right;
}

void set_twins(const Keypoints& points, const std::vector<double>& right_distances,
               TextureSurvey& survey) {
  constexpr std::size_t kFewest = 8;
  const double usual = right_distances.size() < kFewest ? kUsualDistance : median(right_distances);
  survey.keypoints = points.count();
  survey.twins = look_alikes(points, usual / kRatio);
  const auto* kept = survey.twins.kept.data();
  const auto twins = std::count(kept, kept + survey.twins.count(), std::uint8_t{1});
  survey.twin_share =
      static_cast<double>(twins) / static_cast<double>(std::max<std::int64_t>(1, survey.keypoints));
}

/// Sets the widest circle around a vertex or the middle of a face that holds none of the places.
void find_gap(const Template& templ, const TemplateSurvey& numbers,
              const std::vector<Eigen::Vector2d>& places_px, TextureSurvey& survey) {
  constexpr Eigen::Index kMostMiddles = 4000;
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const Faces faces = templ.faces.matrix<3>();
  const Eigen::Index all = flat_px.rows() + faces.rows();
  for (Eigen::Index i = 0; i < all; i += 1 + all / kMostMiddles) {
    Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
    if (i < flat_px.rows()) {
      middle_px = flat_px.row(i).transpose();
    } else {
      for (int k = 0; k < 3; ++k) {
        middle_px += flat_px.row(faces(i - flat_px.rows(), k)).transpose() / 3.0;
      }
    }
    double nearest_mm = 0.5 * numbers.size_mm.norm();
    for (const Eigen::Vector2d& place_px : places_px) {
      nearest_mm =
          std::min(nearest_mm, (place_px - middle_px).cwiseProduct(numbers.texel_mm).norm());
    }
    if (2.0 * nearest_mm <= survey.gap_mm) continue;
    survey.gap_mm = 2.0 * nearest_mm;
    survey.gap_px = middle_px;
  }
}

/// Square roots of the shares of the descriptors' sums: of length 1.
Floats root_sift(const Array<float>& descriptors) {
  Floats roots(descriptors.rows(), descriptors.dim(1));
  for (Eigen::Index i = 0; i < roots.rows(); ++i) {
    const Eigen::Map<const Eigen::RowVectorXf> row(descriptors.row(i), roots.cols());
    roots.row(i) = (row.cwiseAbs() / std::max(row.lpNorm<1>(), 1e-9F)).cwiseSqrt();
  }
  return roots;
}

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f", value);
  return text;
}

}  // namespace

Correspondences look_alikes(const Keypoints& points, double twin_distance) {
  constexpr Eigen::Index kBlock = 128;
  constexpr double kElsewhere = 4.0;  // scales
  const std::int64_t count = points.descriptors.present() ? points.count() : 0;
  Correspondences pairs;
  pairs.template_px = Array<double>({count, 2});
  pairs.image_px = Array<double>({count, 2});
  pairs.face = Array<std::int32_t>({count}, -1);
  pairs.barycentrics = Array<double>({count, 3}, 0.0);
  pairs.distance = Array<double>({count});
  pairs.kept = Array<std::uint8_t>({count}, 0);
  pairs.score = Array<double>({count}, 1.0);
  if (count == 0) return pairs;
  const Floats roots = root_sift(points.descriptors);
  const auto place = [&](std::int64_t i) {
    return Eigen::Vector2d(points.xy_px(i, 0), points.xy_px(i, 1));
  };
  const auto is_elsewhere = [&](std::int64_t i, std::int64_t k) {
    const double near_px = kElsewhere * std::max(points.scale_px(i), points.scale_px(k));
    return (place(i) - place(k)).norm() > near_px;
  };
  for (Eigen::Index first = 0; first < count; first += kBlock) {
    const Eigen::Index rows = std::min<Eigen::Index>(kBlock, count - first);
    const Floats alike = roots.middleRows(first, rows) * roots.transpose();  // cosines
    for (Eigen::Index row = 0; row < rows; ++row) {
      const std::int64_t i = first + row;
      std::int64_t best = i;
      float most = -1.0F;
      for (std::int64_t k = 0; k < count; ++k) {
        if (alike(row, k) <= most || !is_elsewhere(i, k)) continue;
        most = alike(row, k);
        best = k;
      }
      const double distance = std::sqrt(std::max(0.0, 2.0 - 2.0 * static_cast<double>(most)));
      for (int axis = 0; axis < 2; ++axis) {
        pairs.template_px(i, axis) = points.xy_px(i, axis);
        pairs.image_px(i, axis) = points.xy_px(best, axis);
      }
      pairs.distance(i) = distance;
      pairs.kept(i) = best != i && distance < twin_distance ? 1 : 0;
    }
  }
  return pairs;
}

Result<TextureSurvey> survey_texture(const host::Record& templ, const TemplateSurvey& numbers,
                                     const host::ComponentSpec& detector,
                                     const host::ComponentSpec& matcher) {
  host::ExecutionContext context(0, {});
  const auto detecting = context.instantiate(detector, "detectors");
  if (!detecting) return detecting.error();
  const auto matching = context.instantiate(matcher, "matchers");
  if (!matching) return matching.error();
  const auto typed = host::view_as<Template>(templ);
  if (!typed) return typed.error();
  const TextureView view = view_of_texture(*typed, kView_px, kSeed);
  const auto found = keypoints_of(context, **detecting, view, templ);
  if (!found) return found.error();
  TextureSurvey survey;
  survey.view_px = kView_px;
  RightMatches right;
  if (found->of_texture != nullptr) {
    auto matches = right_matches(context, **matching, *found, view);
    if (!matches) return matches.error();
    right = *std::move(matches);
    const auto points = host::view_as<Keypoints>(*found->of_texture);
    if (!points) return points.error();
    set_twins(*points, right.distances, survey);
  }
  survey.expected_matches = static_cast<std::int64_t>(right.places_px.size());
  find_gap(*typed, numbers, right.places_px, survey);
  return survey;
}

std::vector<std::string> warnings_of(const TextureSurvey& texture, const TemplateSurvey& numbers) {
  std::vector<std::string> warnings;
  if (texture.expected_matches < kFewestMatches) {
    warnings.push_back("the texture is poor: " + std::to_string(texture.expected_matches) +
                       " matches are to be expected in a view of " + rounded(texture.view_px) +
                       " px, and " + std::to_string(kFewestMatches) +
                       " are wanted, for half of them may be hidden or blurred");
  }
  if (texture.twin_share > kMostTwins) {
    warnings.push_back("the texture repeats itself: " + rounded(100.0 * texture.twin_share) +
                       " % of its keypoints have a twin elsewhere and may be matched with it");
  }
  const double most_mm =
      std::max(kMostGapEdges * numbers.mean_edge_mm, kMostGapOfSize * numbers.size_mm.maxCoeff());
  if (texture.gap_mm > most_mm) {
    warnings.push_back(
        "no match is to be expected within " + rounded(0.5 * texture.gap_mm) + " mm of (" +
        rounded(texture.gap_px.x()) + ", " + rounded(texture.gap_px.y()) +
        ") px of the texture, an edge of the mesh or more: how the object bends there is unknown");
  }
  return warnings;
}

}  // namespace weft
