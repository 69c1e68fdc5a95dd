// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <compare>
#include <numeric>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/matcher.hpp>

#include "common/duplicates.hpp"

namespace weft::merge {
namespace {

/// A match and its row in its record.
struct Source {
  const Correspondences* record;
  std::int64_t row;
};

/// Larger is better. The ratio of distances compares across kinds of descriptors, distances do not.
struct Quality {
  explicit Quality(const Source& match)
      : kept(match.record->kept(match.row)),
        score(match.record->score(match.row)),
        minus_ratio(match.record->ratio.present() ? -match.record->ratio(match.row) : 0.0) {}
  auto operator<=>(const Quality&) const = default;

  std::uint8_t kept;
  double score, minus_ratio;
};

/// The union of several sets of matches without duplicates.
class Merge final : public Matcher {
 public:
  static constexpr About kAbout{.reads = "correspondences"};

  explicit Merge(Params& p) {
    p.read("template_radius_px", template_radius_px_, "px of the texture", {0, 100},
           "maximum distance of duplicates in the texture");
    p.read("image_radius_px", image_radius_px_, "px", {0, 100},
           "maximum distance of duplicates in the image");
  }

  Result<Correspondences> match(const MatcherInput& in) override {
    if (in.correspondences.empty()) {
      return no_result("no matches to merge: no stage of 'from' produced any");
    }
    std::vector<Source> matches;
    std::size_t most = 0;
    for (const Correspondences& record : in.correspondences) most += to_index(record.count());
    matches.reserve(most);
    for (std::size_t k = 0; k < in.correspondences.size(); ++k) {
      const Correspondences& record = in.correspondences[k];
      if (auto valid = check(record, k); !valid) return valid.error();
      for (std::int64_t i = 0; i < record.count(); ++i) matches.push_back({&record, i});
    }
    if (matches.empty()) return no_result("no matches to merge: all inputs are empty");
    if (in.correspondences.size() == 1) {
      Correspondences only = in.correspondences.front();
      only.diag = {};  // the diagnostics of its matcher alone
      return only;
    }
    keep_distinct(matches);
    return answer(in.correspondences, matches);
  }

 private:
  /// Comparisons with NaN would leave the order of the matches open.
  static Result<void> check(const Correspondences& record, std::size_t input) {
    for (std::int64_t i = 0; i < record.count(); ++i) {
      const double *texel = record.template_px.row(i), *pixel = record.image_px.row(i);
      const bool finite = std::isfinite(texel[0]) && std::isfinite(texel[1]) &&
                          std::isfinite(pixel[0]) && std::isfinite(pixel[1]) &&
                          std::isfinite(record.score(i)) &&
                          (!record.ratio.present() || std::isfinite(record.ratio(i)));
      if (finite) continue;
      return Error{Errc::invalid_data,
                   "match " + std::to_string(i) + " of input " + std::to_string(input + 1) +
                       " has a place, score or ratio that is NaN or infinite; its matcher must "
                       "leave such matches out"};
    }
    return {};
  }

  void keep_distinct(std::vector<Source>& matches) const {
    std::vector<matchers::PointPair> pairs;
    std::vector<Quality> qualities;
    pairs.reserve(matches.size());
    qualities.reserve(matches.size());
    for (const Source& match : matches) {
      pairs.push_back({Eigen::Vector2d::Map(match.record->template_px.row(match.row)),
                       Eigen::Vector2d::Map(match.record->image_px.row(match.row))});
      qualities.emplace_back(match);
    }
    std::vector<int> best_first(matches.size());
    std::iota(best_first.begin(), best_first.end(), 0);
    std::stable_sort(best_first.begin(), best_first.end(),
                     [&](int a, int b) { return qualities[to_index(a)] > qualities[to_index(b)]; });
    const std::vector<char> keep =
        matchers::distinct(pairs, best_first, template_radius_px_, image_radius_px_);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (keep[i] != 0) matches[kept++] = matches[i];
    }
    matches.resize(kept);
  }

  /// One array of the matches, column by column.
  template <class T>
  static Array<T> gather(const std::vector<Source>& matches, Array<T> Correspondences::*member) {
    const auto count = static_cast<std::int64_t>(matches.size());
    const Array<T>& first = matches.front().record->*member;
    Array<T> out = first.ndim() == 1 ? Array<T>({count}) : Array<T>({count, first.dim(1)});
    for (std::int64_t i = 0; i < count; ++i) {
      const auto& [record, row] = matches[to_index(i)];
      std::copy_n((record->*member).row(row), out.row_elements(), out.row(i));
    }
    return out;
  }

  /// Keypoint indices and distances are omitted: they refer to different keypoints and to different
  /// kinds of descriptors. Values that can be compared are kept if every input has them.
  static Correspondences answer(const std::vector<Correspondences>& inputs,
                                const std::vector<Source>& matches) {
    using C = Correspondences;
    C out;
    out.template_px = gather(matches, &C::template_px);
    out.image_px = gather(matches, &C::image_px);
    out.face = gather(matches, &C::face);
    out.barycentrics = gather(matches, &C::barycentrics);
    out.kept = gather(matches, &C::kept);
    out.score = gather(matches, &C::score);
    out.confidence = least_confidence(inputs);
    for (const auto member : {&C::ratio, &C::scale_ratio, &C::angle_difference_rad}) {
      const bool everywhere = std::all_of(
          inputs.begin(), inputs.end(), [&](const C& input) { return (input.*member).present(); });
      if (everywhere) out.*member = gather(matches, member);
    }
    return out;
  }

  /// The lowest confidence that a filter gave to the kept matches; none where no filter gave any.
  static Array<double> least_confidence(const std::vector<Correspondences>& inputs) {
    const Array<double>* least = nullptr;
    for (const Correspondences& input : inputs) {
      if (input.count() == 0 || !input.confidence.present()) continue;
      if (least == nullptr || *input.confidence.data() < *least->data()) least = &input.confidence;
    }
    return least == nullptr ? Array<double>() : make_scalar(*least->data());
  }

  double template_radius_px_ = 1.0;
  double image_radius_px_ = 1.0;
};

}  // namespace
}  // namespace weft::merge

using weft::merge::Merge;
WEFT_PLUGIN(Merge, "matchers/merge", "1.0.2",
            "Merges the matches of several stages and their duplicates.")
