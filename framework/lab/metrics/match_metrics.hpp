// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>
#include <weft/data/array.hpp>

#include "lab/metrics/field.hpp"

namespace weft::lab {

/// Numbers of scores in equal parts of [0, 1]; what is beyond counts at the ends.
using ScoreCounts = std::array<std::int64_t, 40>;

/// The decisions of a filter on the matches of one frame. Positive is a mismatch, as in
/// Shetab-Bushehri et al. 2023, Section V. Only matches count that were kept before the filter and
/// have a label.
struct FilterCounts {
  std::int64_t entered = 0;         ///< [] kept before the filter, labelled or not
  std::int64_t kept = 0;            ///< [] of these, kept by it
  std::int64_t mismatches = 0;      ///< [] labelled wrong
  std::int64_t correct = 0;         ///< [] labelled right
  std::int64_t rejected_wrong = 0;  ///< [] true positives
  std::int64_t rejected_right = 0;  ///< [] false positives
  ScoreCounts wrong_scores{};       ///< [] what the filter thinks of mismatches
  ScoreCounts right_scores{};       ///< [] and of inliers

  std::int64_t labelled() const { return mismatches + correct; }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"entered", "matches that the filter was given"}, self.entered);
    visit({"kept", "of these, kept by it"}, self.kept);
    visit({"mismatches", "of those with a label, wrong ones"}, self.mismatches);
    visit({"correct", "of those with a label, right ones"}, self.correct);
    visit({"rejected_wrong", "mismatches that it rejected"}, self.rejected_wrong);
    visit({"rejected_right", "inliers that it rejected"}, self.rejected_right);
  }
};

/// Rates of a filter over a run: means over the frames in which they are defined.
struct FilterMetrics {
  std::string stage;
  std::int64_t frames = 0;                     ///< [] with labelled matches
  std::int64_t frames_without_mismatch = 0;    ///< [] not in the TPR
  std::int64_t frames_without_correct = 0;     ///< [] not in the FPR, recall and F1
  std::int64_t frames_without_kept = 0;        ///< [] no labelled match kept: not in the precision
  std::int64_t labelled = 0, entered = 0;      ///< [] matches
  std::int64_t mismatches = 0;                 ///< [] of those labelled
  double tpr_percent = kNoRate;                ///< [] mismatches that were rejected
  double fpr_percent = kNoRate;                ///< [] inliers that were rejected
  double kept_percent = kNoRate;               ///< [] n_s: matches kept of those that entered
  double precision_percent = kNoRate;          ///< [] AoS: correct ones among those kept
  double recall_percent = kNoRate;             ///< [] correct ones that were kept
  double f1_percent = kNoRate;                 ///< [] of the inlier class
  ScoreCounts wrong_scores{}, right_scores{};  ///< [] sums over the frames

  static constexpr double kNoRate = std::numeric_limits<double>::quiet_NaN();

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"stage", "name of the filter's stage", {}, "filter"}, self.stage);
    visit({"frames", "with labelled matches", {}, "frames"}, self.frames);
    visit({"frames_without_mismatch", "not in the TPR", {}, "no mismatch"},
          self.frames_without_mismatch);
    visit({"frames_without_correct", "not in FPR, recall and F1", {}, "none correct"},
          self.frames_without_correct);
    visit({"frames_without_kept", "not in the precision", {}, "none kept"},
          self.frames_without_kept);
    visit({"matches", "that entered", {}, "matches"}, self.entered);
    visit({"matches_labelled", "of them, with a known truth", {}, "labelled"}, self.labelled);
    visit({"mismatches", "of those with a known truth, wrong ones"}, self.mismatches);
    visit({"tpr_percent", "mismatches rejected, of all mismatches (a positive is a mismatch)",
           kHigher, "TPR %", 1},
          self.tpr_percent);
    visit({"fpr_percent", "inliers rejected, of all inliers", kLower, "FPR %", 1},
          self.fpr_percent);
    visit({"kept_percent", "matches kept, of those that entered", kHigher, "kept %", 1},
          self.kept_percent);
    visit({"precision_percent", "correct ones, of those kept whose truth is known", kHigher,
           "precision %", 1},
          self.precision_percent);
    visit({"recall_percent", "correct ones kept, of all correct ones", kHigher, "recall %", 1},
          self.recall_percent);
    visit({"f1_percent", "harmonic mean of precision and recall", kHigher, "F1 %", 1},
          self.f1_percent);
    visit({"scores_of_mismatches", "how many, in 40 equal parts of [0, 1]"}, self.wrong_scores);
    visit({"scores_of_correct", "how many, in 40 equal parts of [0, 1]"}, self.right_scores);
  }
};

/// Counts of one frame from what was kept before and after the filter, an entry a match, 0 or 1,
/// the filter's scores, and the labels of the matches.
FilterCounts count_filter(const Array<std::uint8_t>& before, const Array<std::uint8_t>& after,
                          const Array<double>& scores, const std::vector<std::int8_t>& labels);

/// Rates of one stage over its frames.
FilterMetrics summarise_filter(const std::string& stage, const std::vector<FilterCounts>& frames);

}  // namespace weft::lab
