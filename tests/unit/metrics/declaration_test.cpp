// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "lab/metrics/forms/catalogue.hpp"
#include "lab/metrics/forms/json.hpp"
#include "lab/metrics/forms/metric_path.hpp"
#include "lab/metrics/forms/metrics_report.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::IsSupersetOf;

/// A run that has all that a run may have, each number another one.
RunMetrics full_run() {
  RunMetrics metrics;
  metrics.run = "a run";
  metrics.alignment = Alignment::rigid;
  metrics.truth_users = {"filters/oracle"};
  metrics.implements = {"filters/tran: reconstruction"};
  metrics.counts = {.frames = 9, .estimated = 4, .weak = 2, .predicted = 1, .lost = 1, .none = 1};
  metrics.strain_mean = 0.0625;
  metrics.all.frames = 7;
  metrics.all.solved = 6;
  metrics.all.missing = 1;
  metrics.all.solved_error.frames = 6;
  metrics.all.solved_error.mean_mm = 1.25;
  metrics.all.solved_error.worst_frame = "f3";
  metrics.all.carried_over_error.worst_frame = "f5";
  metrics.groups.push_back({metrics.all, "mdh", "texture source"});
  metrics.image.overlay_px = 0.75;
  metrics.depth.worst_mm = 11.5;
  metrics.visibility.hidden_mm = 4.5;
  metrics.certainty.brier = 0.03125;
  metrics.certainty.bins[9] = {6, 0.9375, 0.875};
  metrics.certainty.within_percent = {68.0, 95.0, 99.0};
  metrics.filters.emplace_back().stage = "aem";
  metrics.filters.back().tpr_percent = 97.5;
  metrics.filters.back().wrong_scores[39] = 12;
  metrics.warps.emplace_back().stage = "warps";
  metrics.warps.back().salient_px = 0.5;
  metrics.parts.emplace_back().part = "hidden";
  metrics.parts.back().surface.sampled.chamfer_mm = 6.5;
  metrics.jitter.cuts = 2;
  FrameMetrics& frame = metrics.frames.emplace_back();
  frame.frame = 3;
  frame.stem = "f3";
  frame.state = ShapeState::weak;
  frame.outcome = FrameOutcome::solved;
  frame.strain_mean = 0.125;
  frame.has_truth = true;
  frame.kind = "mdh";
  frame.points = 5;
  frame.error.emplace().mean_mm = 2.5;
  frame.depth.emplace().median_mm = 3.5;
  frame.visibility.emplace().seen_right = 8;
  frame.certainty.emplace().confidence = 0.75;
  frame.filters.emplace_back("aem", FilterCounts{}).second.entered = 40;
  frame.surface.emplace().sampled.emplace().to_truth_mm = 1.75;
  frame.parts.emplace_back("hidden", FramePart{}).second.surface.emplace().from_truth_mm = 2.25;
  frame.warps.emplace_back("bbs", WarpErrors{}).second.salient_px = 0.375;
  return metrics;
}

/// The paths of all numbers in an object, as `metric:` names them.
void add_numbers(const json& place, const std::string& path, std::set<std::string>& paths) {
  const std::string start = path.empty() ? "" : path + ".";
  if (place.is_number() || place.is_null()) paths.insert(path);
  if (place.is_object()) {
    for (const auto& [name, value] : place.items()) add_numbers(value, start + name, paths);
  }
  if (!place.is_array()) return;
  for (const json& entry : place) {
    if (!entry.is_object()) continue;
    for (const char* label : {"stage", "kind", "part"}) {
      if (entry.contains(label))
        add_numbers(entry, start + entry.at(label).get<std::string>(), paths);
    }
  }
}

TEST(DeclaredMetrics, AreTheSameAfterAWayThroughJson) {
  RunMetrics metrics = full_run();
  metrics.frames[0].visibility.reset();  // its rates are written, not the counts behind them
  const auto again = metrics_of(json::parse(to_json(metrics)));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(to_json(*again), to_json(metrics));
  EXPECT_EQ(again->alignment, Alignment::rigid);
  EXPECT_EQ(again->frames.at(0).state, ShapeState::weak);
  EXPECT_DOUBLE_EQ(again->frames.at(0).strain_mean, 0.125);
  EXPECT_EQ(again->filters.at(0).wrong_scores[39], 12);
  EXPECT_DOUBLE_EQ(again->parts.at(0).surface.sampled.chamfer_mm, 6.5);
  EXPECT_DOUBLE_EQ(again->frames.at(0).surface->sampled->to_truth_mm, 1.75);
  EXPECT_DOUBLE_EQ(again->frames.at(0).parts.at(0).second.surface->from_truth_mm, 2.25);
  EXPECT_DOUBLE_EQ(again->frames.at(0).warps.at(0).second.salient_px, 0.375);
}

TEST(DeclaredMetrics, OfOlderProgramsLackWhatTheseDidNotMeasure) {
  json object = json::parse(to_json(full_run()));
  object.erase("certainty");
  object["all"].erase("error_carried_over");
  const auto metrics = metrics_of(object);
  ASSERT_TRUE(metrics) << metrics.error().message;
  EXPECT_TRUE(std::isnan(metrics->certainty.brier));
  EXPECT_DOUBLE_EQ(metrics->all.solved_error.mean_mm, 1.25);
}

TEST(DeclaredMetrics, AreReadByTheirFormerNames) {
  json object = json::parse(to_json(full_run()));
  json& all = object["all"];
  all["error_held"] = all["error_carried_over"];
  all.erase("error_carried_over");
  all["held"] = 3;
  all.erase("carried_over");
  json& frame = object["frames"][0];
  frame["outcome"] = "held";
  frame["truth"]["apart"] = "texture source";
  frame["truth"].erase("excluded");
  const auto metrics = metrics_of(object);
  ASSERT_TRUE(metrics) << metrics.error().message;
  EXPECT_EQ(metrics->all.carried_over_error.worst_frame, "f5");
  EXPECT_EQ(metrics->all.carried_over, 3);
  EXPECT_EQ(metrics->frames.at(0).outcome, FrameOutcome::carried_over);
  EXPECT_EQ(metrics->frames.at(0).exclusion, "texture source");
  for (const char* path : {"all.held", "all.carried_over"}) {
    EXPECT_DOUBLE_EQ(*metric_at(object, path), 3.0) << path;
  }
  EXPECT_TRUE(metric_at(json::parse(to_json(full_run())), "all.held"));
}

TEST(DeclaredMetrics, OfAnotherTypeAreRefused) {
  json object = json::parse(to_json(full_run()));
  object["all"]["error_solved"]["mean_mm"] = "small";
  const auto metrics = metrics_of(object);
  ASSERT_FALSE(metrics);
  EXPECT_EQ(metrics.error().code, Errc::invalid_data);
  EXPECT_THAT(metrics.error().message, ::testing::HasSubstr("must be number"));
  for (const char* name : {"all", "jitter"}) {
    json without = json::parse(to_json(full_run()));
    without[name] = 3;
    EXPECT_FALSE(metrics_of(without)) << name;
  }
  EXPECT_FALSE(metrics_of(json::array()));
}

TEST(DeclaredMetrics, AreAllInTheCatalogueWithTheirUnits) {
  const json object = json::parse(to_json(full_run()));
  std::set<std::string> written;
  add_numbers(object, "", written);
  for (const std::string& path : written) {
    EXPECT_NE(field_of(path), nullptr) << path;
    EXPECT_TRUE(metric_at(object, path)) << path;
  }
  std::set<std::string> known;
  for (const CatalogueEntry& entry : run_catalogue()) {
    std::string path = entry.path;
    for (const auto& [word, name] :
         {std::pair{"groups.KIND", "groups.mdh"}, std::pair{"filters.STAGE", "filters.aem"},
          std::pair{"warps.STAGE", "warps.warps"}, std::pair{"parts.PART", "parts.hidden"}}) {
      if (path.starts_with(word)) path.replace(0, std::string(word).size(), name);
    }
    known.insert(path);
    EXPECT_NE(std::string(entry.field.meaning), "") << path;
  }
  EXPECT_EQ(known, written);
}

TEST(DeclaredMetrics, SayWhichWayIsBetterWithTheNameOfAStageAndWithout) {
  EXPECT_EQ(field_of("all.error_solved.mean_mm")->better, Better::lower);
  EXPECT_EQ(field_of("filters.aem.tpr_percent")->better, Better::higher);
  EXPECT_EQ(field_of("filters.tpr_percent")->better, Better::higher);
  EXPECT_EQ(field_of("filters.fpr_percent")->better, Better::lower);
  EXPECT_EQ(field_of("counts.frames")->better, std::nullopt);
  EXPECT_EQ(field_of("filters.aem.nothing"), nullptr);
  EXPECT_EQ(unit_of("filters.aem.tpr_percent"), "%");
}

TEST(DeclaredMetrics, HaveNamesForPeople) {
  EXPECT_EQ(metric_name("all.error_solved.mean_mm"), "mean 3D error");
  EXPECT_EQ(metric_heading("all.error_solved.mean_mm"), "mean 3D error, mm");
  EXPECT_EQ(metric_name("groups.mdh.error_carried_over.worst_mm"),
            "3D error of the worst frame of carried-over frames, mdh");
  EXPECT_EQ(metric_heading("filters.aem.tpr_percent"), "mismatches rejected (TPR), aem, %");
  EXPECT_EQ(metric_name("filters.tpr_percent"), "mismatches rejected (TPR)");
  EXPECT_EQ(metric_name("image.reprojection_frames"), "reprojection frames");
  EXPECT_EQ(metric_name("nothing.of_this"), "nothing.of_this");
  for (const CatalogueEntry& entry : run_catalogue()) {
    EXPECT_EQ(metric_name(entry.path).find('_'), std::string::npos) << entry.path;
  }
}

TEST(DeclaredMetrics, HaveNoNameForWhatIsNotMeasured) {
  const std::vector<CatalogueEntry> entries = run_catalogue();
  for (const std::string& ending : named_endings()) {
    EXPECT_TRUE(std::any_of(entries.begin(), entries.end(), [&](const CatalogueEntry& entry) {
      return entry.path.ends_with(ending);
    })) << ending;
  }
}

TEST(DeclaredMetrics, OfFramesAreTheColumnsOfTheCsvFile) {
  const RunMetrics metrics = full_run();
  std::stringstream header(to_csv(metrics).substr(0, to_csv(metrics).find('\n')));
  std::vector<std::string> columns;
  for (std::string name; std::getline(header, name, ',');) columns.push_back(name);
  std::vector<std::string> known;
  for (const CatalogueEntry& entry : frame_catalogue()) {
    std::string name = entry.path;
    const bool is_warps = name.ends_with("_px") || name.ends_with("_vertices");
    if (name.starts_with("STAGE")) name.replace(0, 5, is_warps ? "bbs" : "aem");
    if (name.starts_with("PART")) name.replace(0, 4, "hidden");
    known.push_back(name);
  }
  EXPECT_THAT(columns, IsSupersetOf(known));
  EXPECT_THAT(columns, Contains("visibility_hidden_f1_percent"));
  EXPECT_THAT(columns, Contains("confidence"));
  EXPECT_THAT(columns, Contains("aem_entered"));
  EXPECT_THAT(columns, Contains("bbs_salient_px"));
  EXPECT_THAT(columns, Contains("hidden_sampled_to_truth_mm"));
}

}  // namespace
}  // namespace weft::lab
