// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <weft/data/ground_truth.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/synthetic.hpp>

#include "host/records/npz.hpp"
#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/results/cell_line.hpp"

namespace weft::lab {

/// A results folder whose figures are known, as an ablation would have written it.
///
/// Three filters: `steady` errs by 2 mm, `shaky` by 2 mm and by 1 mm more in every other sequence,
/// `broken` fails in every cell. A threshold alpha of four values, or more, that changes what is
/// rejected. On top of these each sequence k (from 0) adds k/10 mm and each frame t t/100 mm. The
/// last frame of `shaky` is missing in the first sequence.
///
/// `steady` has no errors and confidence 0.95, in the second half 0.85. `shaky` has confidence 0.65
/// and 0.55. It is wrong in the second half of every other sequence, silently in the last frame.
/// Within 1, 2 and 3 standard deviations are 42, 60 and 63 of 63 vertices.
class FakeResults {
 public:
  static constexpr int kFrames = 10;
  static constexpr const char* kReason = "the worker ended with signal 11 </script><b>";

  struct Choice {
    int sequences = 8, alphas = 4;
    std::vector<std::uint64_t> seeds = {1, 2};
    bool timing = false;
    bool old_times = false;  ///< without CPU times of detectors, as earlier programs wrote them
    bool shapes = false;
    bool errors = false;  ///< in two frames of each cell of `shaky`, which is done all the same
    std::string data_use = "reporting";
    double more_mm = 0.0;  ///< added to every error
  };

  explicit FakeResults(Choice choice) : choice_(std::move(choice)) {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = ::testing::TempDir() + "weft_report_" + test->name() + "_" +
              std::to_string(getpid()) + "_" + std::to_string(count_++);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ + "/results");
    write("manifest.json", {{"schema", "weft.results/1"}, {"weft", "0.1.0"}, {"plan", "stages"}});
    write_plan();
    for (const nlohmann::json& cell : cells_) write_cell(cell);
  }
  ~FakeResults() {
    if (!kept_) std::filesystem::remove_all(folder_);
  }
  FakeResults(const FakeResults&) = delete;
  FakeResults& operator=(const FakeResults&) = delete;

  const std::string& folder() const { return folder_; }
  void keep() { kept_ = true; }

  static double alpha(int i) { return (5 * i + 5) / 100.0; }
  static double tpr(int i) { return 99.0 - 10.0 * std::min(i, 9); }
  static double fpr(int i) { return 40.0 / (1 << std::min(i, 9)); }

  void append(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ + "/" + file, std::ios::app | std::ios::binary) << text;
  }
  void write(const std::string& file, const nlohmann::json& content) const {
    std::ofstream(folder_ + "/" + file, std::ios::binary) << content.dump(1) << "\n";
  }
  std::string read(const std::string& file) const {
    std::ifstream stream(folder_ + "/" + file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  void write_plan() {
    using nlohmann::json;
    json sequences = json::array(), alphas = json::array();
    for (int s = 0; s < choice_.sequences; ++s) {
      sequences.push_back("plain_" + std::to_string(101 + s));
    }
    for (int i = 0; i < choice_.alphas; ++i) alphas.push_back(alpha(i));
    const json filters{"steady", "shaky", "broken"};
    for (const auto& filter : filters) {
      for (const auto& value : alphas) {
        for (const auto& sequence : sequences) {
          for (const std::uint64_t seed : choice_.seeds) {
            const std::size_t index = cells_.size();
            char key[33];
            std::snprintf(key, sizeof(key), "%032zx", index + 1);
            cells_.push_back({{"cell", index},
                              {"axes", {{"filter", filter}, {"alpha", value}}},
                              {"sequence", sequence},
                              {"seed", seed},
                              {"key", key}});
          }
        }
      }
    }
    const json comparison{
        {"axis", "filter"}, {"reference", "steady"}, {"metric", "all.error_solved.mean_mm"}};
    write("plan.json",
          {{"name", "Filters <on> a plain sheet"},
           {"command", "weft ablate stages.yaml --out results/stages"},
           {"axes",
            {{{"name", "filter"}, {"values", filters}},
             {{"name", "alpha"}, {"values", alphas}, {"swept", "alpha"}, {"numbers", alphas}}}},
           {"sequences", sequences},
           {"seeds", choice_.seeds},
           {"data_use", choice_.data_use},
           {"cells", cells_},
           {"comparisons", json::array({comparison})},
           {"expect", json::array()}});
  }

  static int alpha_index(const nlohmann::json& cell) {
    return static_cast<int>(std::lround(cell["axes"]["alpha"].get<double>() / 0.05)) - 1;
  }
  static int sequence_index(const nlohmann::json& cell) {
    return std::stoi(cell["sequence"].get<std::string>().substr(6)) - 101;
  }

  void write_cell(const nlohmann::json& cell) {
    nlohmann::ordered_json line{{"schema", choice_.errors ? kLineSchema : kUncheckedLineSchema},
                                {"key", cell["key"]}};
    const bool broken = cell["axes"]["filter"] == "broken";
    line["outcome"] = broken ? "failed" : "done";
    line["reason"] = broken ? kReason : "";
    if (!broken) line["metrics"] = nlohmann::ordered_json::parse(to_json(metrics_of(cell)));
    if (choice_.errors && cell["axes"]["filter"] == "shaky") {
      line["metrics"]["counts"]["failed"] = 2;
      line["first_error"] = "frame 3, filters: refused";
    }
    line["stages"] = {{{"stage", "detectors"}}, {{"stage", "filters"}}};
    line["timing"] = {{"cached", !choice_.timing}};
    if (choice_.timing) {
      // The filter runs in two frames of three.
      line["timing"]["frames"] = 3;
      line["timing"]["stages"] = {
          {{"stage", "sources"},
           {"frames", 3},
           {"mean_ms", 90.0},
           {"p50_ms", 90.0},
           {"mean_processor_ms", 100.0}},
          {{"stage", "detectors"}, {"frames", 3}, {"mean_ms", 4.0}, {"p50_ms", 3.5}},
          {{"stage", "filters"},
           {"frames", 2},
           {"mean_ms", 1.5},
           {"p50_ms", 1.25},
           {"mean_processor_ms", 2.75}}};
      if (!choice_.old_times) line["timing"]["stages"][1]["mean_processor_ms"] = 6.0;
    }
    line["machine"] = {{"processor", "A <fine> one"}};
    append("results/" + std::to_string(cell["cell"].get<int>() % 2) + ".jsonl",
           (choice_.errors ? checked_line(line) : line.dump()) + "\n");
    const std::string folder = folder_ + "/cells/" + cell["key"].get<std::string>();
    std::filesystem::create_directories(folder);
    std::ofstream(folder + "/pipeline.yaml") << "weft: 1\n# " << folder << "\n";
    if (choice_.shapes && !broken) write_shapes(folder);
  }

  RunMetrics metrics_of(const nlohmann::json& cell) const {
    const int s = sequence_index(cell);
    const bool shaky = cell["axes"]["filter"] == "shaky";
    RunMetrics metrics;
    metrics.run = "cell";
    metrics.implements = {"filters/fake: reconstruction"};
    FilterCounts counts{100, 60, 40, 60, 0, 0};
    std::vector<FrameCertainty> certainties;
    double sum = 0.0;
    for (int t = 0; t < kFrames; ++t) {
      FrameMetrics frame;
      frame.frame = static_cast<std::uint64_t>(t);
      frame.has_truth = true;
      const bool missing = shaky && s == 0 && t == kFrames - 1;
      frame.outcome = missing ? FrameOutcome::missing : FrameOutcome::solved;
      frame.state = missing ? ShapeState::none : ShapeState::estimated;
      if (!missing) {
        frame.error = PointSummary{};
        frame.error->mean_mm =
            choice_.more_mm + 2.0 + 0.1 * s + 0.01 * t + (shaky && s % 2 == 1 ? 1.0 : 0.0);
        sum += frame.error->mean_mm;
        metrics.all.solved_error.worst_mm = frame.error->mean_mm;
        metrics.all.solved_error.worst_frame = std::to_string(t);
        ++metrics.all.solved;
        frame.certainty = certainty_of(shaky, s, t);
        certainties.push_back(*frame.certainty);
      }
      frame.filters.emplace_back("filters", counts);
      metrics.frames.push_back(frame);
    }
    metrics.certainty = summarise_certainty(certainties);
    metrics.counts.frames = metrics.all.frames = kFrames;
    metrics.counts.estimated = metrics.all.solved;
    metrics.all.missing = kFrames - metrics.all.solved;
    metrics.all.solved_error.frames = metrics.all.solved;
    metrics.all.solved_error.mean_mm = sum / static_cast<double>(metrics.all.solved);
    FilterMetrics filter;
    filter.stage = "filters";
    filter.frames = kFrames;
    const int a = alpha_index(cell);
    filter.tpr_percent = tpr(a);
    filter.fpr_percent = fpr(a);
    filter.kept_percent = 60.0;
    filter.precision_percent = 95.0;
    filter.entered = filter.labelled = 100 * kFrames;
    filter.mismatches = 40 * kFrames;
    filter.wrong_scores[4] = 30 * kFrames;
    filter.wrong_scores[20] = 10 * kFrames;
    filter.right_scores[36] = 60 * kFrames;
    metrics.filters.push_back(filter);
    return metrics;
  }

  static FrameCertainty certainty_of(bool shaky, int sequence, int frame) {
    const bool late = frame >= kFrames / 2;
    FrameCertainty certainty;
    certainty.confidence = (shaky ? 0.65 : 0.95) - (late ? 0.1 : 0.0);
    certainty.right = !(shaky && late && sequence % 2 == 1);
    certainty.silently_wrong = !certainty.right && frame == kFrames - 1;
    certainty.vertices = 63;
    certainty.within = {42, 60, 63};
    return certainty;
  }

  /// A surface that waves in time; the estimate differs from the truth by a multiple of the error.
  static void write_shapes(const std::string& folder) {
    const Template sheet = testing::make_template({9, 7, 0.3, 0.2, 150, 100});
    host::NamedRecords records{{"template", host::Record::copy_of(sheet)}};
    for (int t = 0; t < kFrames; ++t) {
      const auto place = [&](double x, double y, double off_m) {
        return Eigen::Vector3d(x - 0.15, y - 0.1,
                               0.6 + off_m + 0.03 * std::sin(20.0 * x + 0.6 * t));
      };
      const auto rest = sheet.vertices_m.matrix<3>();
      Points3 vertices_m(rest.rows(), 3), points_m(rest.rows(), 3);
      Points2 xy_m(rest.rows(), 2);
      for (Eigen::Index v = 0; v < rest.rows(); ++v) {
        vertices_m.row(v) = place(rest(v, 0), rest(v, 1), 0.004);
        points_m.row(v) = place(rest(v, 0), rest(v, 1), 0.0);
        xy_m.row(v) = rest.row(v).head<2>();
      }
      Shape shape;
      shape.vertices_m = make_array<double>(vertices_m);
      shape.source = Array<std::uint8_t>({vertices_m.rows()}, 0);
      char slot[16];
      std::snprintf(slot, sizeof(slot), "%06d", t);
      records.emplace_back(std::string(slot) + ".shape", host::Record::copy_of(shape));
      records.emplace_back(
          std::string(slot) + ".ground_truth",
          host::Record::copy_of(
              GroundTruth{make_array<double>(xy_m), make_array<double>(points_m), "mesh", ""}));
    }
    if (auto written = host::write_npz(folder + "/shapes.npz", records); !written) {
      throw std::runtime_error(written.error().message);
    }
    cv::Mat picture(120, 160, CV_8UC3, cv::Scalar(90, 100, 110));
    cv::rectangle(picture, {30, 25}, {130, 95}, cv::Scalar(200, 210, 220), cv::FILLED);
    cv::imwrite(folder + "/worst_000009.png", picture);
  }

  static inline int count_ = 0;  ///< folders of this process

  Choice choice_;
  std::string folder_;
  bool kept_ = false;
  std::vector<nlohmann::json> cells_;
};

}  // namespace weft::lab
