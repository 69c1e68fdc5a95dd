// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/sdk/filter.hpp>

#include "chart_parts.hpp"
#include "common/candidates.hpp"
#include "joint_pose.hpp"

namespace weft::charts {
namespace {

enum class Small { reject, keep };

/// The verdict of the nested filter on the matches of one chart.
struct ChartVerdict {
  std::vector<std::size_t> candidates;  ///< [.] of the chart
  double kept = 0.0;                    ///< [] number of kept candidates
  double confidence = 1.0;              ///< [] of the nested filter; 1 if it gives none
  bool has_confidence = false;
  std::string doubt;  ///< why the chart's result is degenerate or absent; mostly empty
};

/// State of a frame while its charts are judged.
struct Frame {
  const FilterInput& in;
  const filters::Candidates& candidates;
  std::vector<ChartVerdict> charts;                                 ///< [.] one for each chart
  std::vector<std::uint8_t> keep;                                   ///< [n] one for each candidate
  std::vector<double> score;                                        ///< [n]
  double small = 0.0, beyond = 0.0, judged = 0.0, misplaced = 0.0;  ///< [] counts for diagnostics
};

/// Judges the matches of each chart of the texture separately.
class Charts final : public Filter {
 public:
  static constexpr About kAbout{
      .reference = "own: another filter for each chart, and one rough pose for all",
      .needs = "template",
      .reads = "camera previous.shape"};

  explicit Charts(Params& p) {
    p.component("filter", filter_, "filter for the matches of each chart");
    p.read("min_matches", min_matches_, "", {3, 100000},
           "minimum number of matches of a chart that is judged");
    p.choice("small", small_, {{"reject", Small::reject}, {"keep", Small::keep}},
             "matches of charts with fewer matches; reject: rejected; keep: kept with the score "
             "0.5 if they fit the joint pose");
    p.read("rigid_tolerance", rigid_tolerance_, "", {0, 10},
           "maximum residual of a chart in the joint pose, relative to the object's size in the "
           "image; 0: no joint pose");
  }

  Result<InlierMask> filter(const FilterInput& in) override {
    parts_.update(*in.templ);
    if (parts_.count() < 2) return filter_.filter(in);
    const auto candidates = filters::candidates_of(in.correspondences);
    if (!candidates) return candidates.error();
    const std::size_t count = candidates->count();
    Frame frame{
        in, *candidates, {}, std::vector<std::uint8_t>(count, 0), std::vector<double>(count, 0.0)};
    sort_by_chart(frame);
    for (std::size_t c = 0; c < frame.charts.size(); ++c) {
      if (auto judged = judge(frame, static_cast<int>(c)); !judged) return judged.error();
    }
    if (frame.judged == 0.0) {
      return no_result("no chart has " + std::to_string(min_matches_) + " matches");
    }
    check_jointly(frame);
    return answer(frame);
  }

 private:
  void sort_by_chart(Frame& frame) const {
    frame.charts.resize(to_index(parts_.count()));
    for (std::size_t k = 0; k < frame.candidates.count(); ++k) {
      const std::int64_t match = frame.candidates.matches[k];
      const int chart = parts_.of_face(frame.in.correspondences.face(match));
      if (chart < 0) {
        ++frame.beyond;
      } else {
        frame.charts[to_index(chart)].candidates.push_back(k);
      }
    }
  }

  bool is_small(const ChartVerdict& chart) const {
    return chart.candidates.size() < to_index(min_matches_);
  }

  /// Calls the nested filter for one chart. A chart without a result loses its matches; other
  /// errors are those of the frame.
  Result<void> judge(Frame& frame, int index) const {
    ChartVerdict& chart = frame.charts[to_index(index)];
    if (is_small(chart)) {
      frame.small += static_cast<double>(chart.candidates.size());
      return {};
    }
    ++frame.judged;
    std::vector<std::int64_t> rows;
    for (const std::size_t k : chart.candidates) rows.push_back(frame.candidates.matches[k]);
    const auto mask = filter_.filter(parts_.part(frame.in, index, rows));
    if (!mask) {
      if (mask.error().code != Errc::no_result) return mask.error();
      chart.doubt = mask.error().message;
      return {};
    }
    if (mask->kept.rows() != static_cast<std::int64_t>(rows.size())) {
      return Error{Errc::plugin_failure, "the nested filter judged another number of matches"};
    }
    chart.doubt = mask.degenerate_reason();
    chart.has_confidence = mask->confidence.present();
    if (chart.has_confidence) chart.confidence = *mask->confidence.data();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto row = static_cast<std::int64_t>(i);
      frame.keep[chart.candidates[i]] = mask->kept(row);
      frame.score[chart.candidates[i]] = mask->score(row);
      chart.kept += mask->kept(row) != 0 ? 1.0 : 0.0;
    }
    return {};
  }

  /// Matches of the object at rest, chart by chart.
  static RestMatches rest_matches(const Frame& frame, const std::vector<std::size_t>& chosen,
                                  const ChartParts& parts) {
    const Template& templ = *frame.in.templ;
    const auto vertices_m = templ.vertices_m.matrix<3>();
    const auto faces = templ.faces.matrix<3>();
    const Correspondences& all = frame.in.correspondences;
    const auto count = static_cast<Eigen::Index>(chosen.size());
    RestMatches rest{Points3(count, 3), Points3(count, 3), Points2(count, 2), {}};
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::int64_t match = frame.candidates.matches[chosen[to_index(i)]];
      const std::int32_t face = all.face(match);
      const Eigen::Vector3d weights = all.barycentrics.matrix<3>().row(match).transpose();
      rest.points_m.row(i) = interpolate(vertices_m, faces, face, weights).transpose();
      const Eigen::RowVector3d a = vertices_m.row(faces(face, 0));
      const Eigen::RowVector3d b = vertices_m.row(faces(face, 1)) - a;
      rest.normals.row(i) = b.cross(vertices_m.row(faces(face, 2)) - a).normalized();
      rest.pixels.row(i) = all.image_px.matrix<2>().row(match);
      rest.chart.push_back(parts.of_face(face));
    }
    return rest;
  }

  /// Rejects charts that do not fit the rough pose of the others, and judges small charts.
  void check_jointly(Frame& frame) const {
    std::vector<std::size_t> kept, small;
    double charts = 0.0;
    for (const ChartVerdict& chart : frame.charts) {
      charts += chart.kept > 0.0 ? 1.0 : 0.0;
      for (const std::size_t k : chart.candidates) {
        if (is_small(chart)) small.push_back(k);
        if (frame.keep[k] != 0) kept.push_back(k);
      }
    }
    std::optional<JointPose> pose;
    if (frame.in.camera && rigid_tolerance_ > 0.0 && charts > 0.0) {
      const RestMatches rest = rest_matches(frame, kept, parts_);
      pose = joint_pose(rest, *frame.in.templ, *frame.in.camera, rigid_tolerance_);
      if (pose && charts > 1.0) reject_misplaced(frame, *pose, rest);
    }
    if (small_ == Small::keep) keep_small(frame, pose, small);
  }

  void reject_misplaced(Frame& frame, const JointPose& pose, const RestMatches& rest) const {
    const Eigen::VectorXd residuals = residuals_px(pose, rest, *frame.in.camera);
    for (std::size_t c = 0; c < frame.charts.size(); ++c) {
      ChartVerdict& chart = frame.charts[c];
      if (chart.kept == 0.0 || fits(pose, rest, residuals, static_cast<int>(c))) continue;
      ++frame.misplaced;
      chart.kept = 0.0;
      chart.doubt = "it does not fit the pose of the other charts";
      for (const std::size_t k : chart.candidates) frame.keep[k] = 0, frame.score[k] = 0.0;
    }
  }

  void keep_small(Frame& frame, const std::optional<JointPose>& pose,
                  const std::vector<std::size_t>& small) const {
    constexpr double kUndecided = 0.5;
    const RestMatches rest = rest_matches(frame, small, parts_);
    Eigen::VectorXd residuals = Eigen::VectorXd::Zero(rest.pixels.rows());
    if (pose) residuals = residuals_px(*pose, rest, *frame.in.camera);
    for (std::size_t i = 0; i < small.size(); ++i) {
      if (pose && residuals[static_cast<Eigen::Index>(i)] > pose->tolerance_px) continue;
      frame.keep[small[i]] = 1;
      frame.score[small[i]] = kUndecided;
    }
  }

  /// The mask of all matches. Its confidence is the mean over the charts, weighted with their kept
  /// matches, so that a chart without a coherent set does not change it.
  static Result<InlierMask> answer(const Frame& frame) {
    double kept = 0.0, confidence = 0.0, doubtful = 0.0, most_doubtful = -1.0, charts_kept = 0.0;
    bool has_confidence = false;
    std::string doubt;
    for (const ChartVerdict& chart : frame.charts) {
      kept += chart.kept;
      charts_kept += chart.kept > 0.0 ? 1.0 : 0.0;
      confidence += chart.kept * chart.confidence;
      has_confidence = has_confidence || chart.has_confidence;
      if (chart.doubt.empty()) continue;
      doubtful += chart.kept;
      const double weight =
          std::max(chart.kept, 1e-6 * static_cast<double>(chart.candidates.size()));
      if (weight > most_doubtful) most_doubtful = weight, doubt = chart.doubt;
    }
    if (kept == 0.0) {
      return no_result("no chart has a coherent set of matches" +
                       (doubt.empty() ? "" : ": " + doubt));
    }
    InlierMask mask =
        filters::mask_of(frame.in.correspondences, frame.candidates, frame.keep, frame.score);
    if (has_confidence) {
      mask.confidence = make_scalar(confidence / kept);
      mask.diag.set("confidence", confidence / kept);
    }
    mask.diag.set("charts", static_cast<double>(frame.charts.size()));
    mask.diag.set("judged_charts", frame.judged);
    mask.diag.set("kept_charts", charts_kept);
    mask.diag.set("misplaced_charts", frame.misplaced);
    mask.diag.set("small_chart_matches", frame.small);
    mask.diag.set("matches_beyond_charts", frame.beyond);
    if (2.0 * doubtful > kept) return degenerate(std::move(mask), doubt);
    return mask;
  }

  FilterComponent filter_{"filters/aem"};
  int min_matches_ = 8;
  Small small_ = Small::reject;
  double rigid_tolerance_ = 0.25;

  ChartParts parts_;
};

}  // namespace
}  // namespace weft::charts

using weft::charts::Charts;
WEFT_PLUGIN(Charts, "filters/charts", "1.0.0",
            "Judges the matches of each chart of the texture with another filter.")
