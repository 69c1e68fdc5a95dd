// SPDX-License-Identifier: Apache-2.0
// The set of matches of this repository: its shapes, and filters compared on it.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kTolerancePx = 2.0;

class MatchGrid : public PipelineTest {
 protected:
  Ended weft(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS});
    return Child(std::move(words), path("said")).wait();
  }

  /// The metrics of each cell of a plan over the axis `filter`, by its value.
  std::map<std::string, json> cells_of(const std::string& plan, const std::string& out) const {
    const Ended ended = weft({"ablate", plan, "--out", path(out)});
    EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
    std::map<std::string, json> by_key, by_filter;
    for (const auto& file : fs::directory_iterator(path(out) + "/results")) {
      for (const std::string& line : read_lines(file.path().string())) {
        const json cell = json::parse(line);
        EXPECT_EQ(cell.at("outcome"), "done") << line;
        by_key[cell.at("key")] = cell.at("metrics");
      }
    }
    const json listed = json::parse(read_text(path(out) + "/plan.json"));
    for (const json& cell : listed.at("cells")) {
      by_filter[cell.at("axes").at("filter")] = by_key[cell.at("key")];
    }
    return by_filter;
  }

  /// Writes the places of the repository's set with only labels instead of true images.
  void write_labelled_set() const {
    fs::create_directories(path("labelled"));
    for (const auto& file : fs::directory_iterator(WEFT_PIPELINES "/data/match_set/matches")) {
      std::ofstream out(path("labelled/") + file.path().filename().string());
      std::vector<std::string> lines = read_lines(file.path().string());
      ASSERT_TRUE(
          lines.at(0).starts_with("template_x_px,template_y_px,image_x_px,image_y_px,"
                                  "true_x_px,true_y_px"));
      out << "template_x_px,template_y_px,image_x_px,image_y_px,label\n";
      lines.erase(lines.begin());
      for (const std::string& line : lines) {
        std::istringstream cells(line);
        std::vector<std::string> cell;
        for (std::string each; std::getline(cells, each, ',');) cell.push_back(each);
        const double off_px = std::hypot(std::stod(cell.at(2)) - std::stod(cell.at(4)),
                                         std::stod(cell.at(3)) - std::stod(cell.at(5)));
        for (std::size_t i = 0; i < 4; ++i) out << cell[i] << ",";
        out << (off_px < kTolerancePx ? 1 : 0) << "\n";
      }
    }
  }
};

TEST_F(MatchGrid, ShapesFollowFromASetOfFiles) {
  const Ended ran = weft({"run", WEFT_PIPELINES "/matches.yaml", "--out", path("run"), "--quiet"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const Ended measured = weft({"eval", path("run"), "--json", path("metrics.json")});
  ASSERT_EQ(measured.exit_code, 0) << measured.err;
  const json metrics = json::parse(read_text(path("metrics.json")));
  EXPECT_EQ(metrics.at("counts").at("solved_percent"), 100.0);
  EXPECT_LT(metrics.at("all").at("error_solved").at("of_depth_percent"), 2.5);
  EXPECT_EQ(metrics.at("filters").at(0).at("matches_labelled"), 4 * 300);
  EXPECT_GT(metrics.at("filters").at(0).at("tpr_percent"), 95.0);
}

TEST_F(MatchGrid, FiltersHaveTheSameRatesByLabelsAsByTrueImages) {
  write_labelled_set();
  write("weft: 1\nname: labels\npipeline: " WEFT_PIPELINES
        "/matches.yaml\ndata_use: tuning\nmetrics: {match_tolerance_px: 2}\n"
        "axes:\n  filter:\n    values:\n      myneighbor: {}\n"
        "      oracle: {set: {filters.use: filters/oracle, filters.tolerance_px: 2}}\n"
        "      vfc: {set: {filters.use: filters/vfc, filters.preset: weft}}\n"
        "data:\n  labelled: {without: [warps, passes, solvers], source: {use: sources/matches, "
        "params: {path: labelled/*.csv, camera: " WEFT_PIPELINES "/data/match_set/camera.yaml}}}\n",
        "labels.yaml");
  auto by_images = cells_of(WEFT_PIPELINES "/ablations/match_sets.yaml", "images");
  auto by_labels = cells_of(path("labels.yaml"), "labels");
  for (const char* filter : {"myneighbor", "oracle", "vfc"}) {
    const json& images = by_images[filter].at("filters").at(0);
    const json& labels = by_labels[filter].at("filters").at(0);
    EXPECT_EQ(labels.at("matches_labelled"), 4 * 300) << filter;
    for (const char* rate : {"tpr_percent", "fpr_percent", "precision_percent"}) {
      EXPECT_EQ(labels.at(rate), images.at(rate)) << filter << " " << rate;
    }
  }
  const auto error_mm = [&](const char* filter) -> double {
    return by_images[filter].at("all").at("error_solved").at("mean_mm");
  };
  EXPECT_LT(error_mm("myneighbor"), 1.1 * error_mm("oracle")) << "the filter costs no shape";
  EXPECT_EQ(by_labels["oracle"].at("filters").at(0).at("tpr_percent"), 100.0);
  EXPECT_EQ(by_labels["oracle"].at("filters").at(0).at("fpr_percent"), 0.0);
}

}  // namespace
}  // namespace weft::testing
