// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <weft/core/index.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>

#include "host/records/npz.hpp"
#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Matches that go to files and come back; the random ones have the seed 3.
class MatchSets : public PipelineTest {
 protected:
  Ended weft(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS});
    return Child(std::move(words), path("said")).wait();
  }

  std::string trials() const {
    return write(
        "weft: 1\nsource: {use: sources/match_trials, params: {trials: 2, seed: 3, matches: 40, "
        "inlier_rate: 0.6, noise_px: 0.4}}\n"
        "template: {use: templates/rectangular, params: {texture: " WEFT_DATA_FOLDER
        "/plain_sheet.png, width_m: 0.297, height_m: 0.178, columns: 10, rows: 6}}\n",
        "trials.yaml");
  }

  void run(const std::string& file, const std::string& out) const {
    const Ended ended = weft({"run", file, "--out", path(out), "--quiet"});
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
  }

  void convert(const std::string& from, const std::string& out, const std::string& form,
               const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"data", "convert", from, "--matches", form, "--out", path(out)};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = weft(std::move(words));
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
  }

  /// The bytes of an array of a record of a file, and nothing for one that is not there.
  static std::string bytes(const std::string& file, const std::string& slot, const char* array) {
    const auto records = host::read_npz(file);
    if (!records) return records.error().message;
    for (const auto& [name, record] : *records) {
      if (name != slot) continue;
      const weft_record view = record->view("");
      const weft_array* found = find_array(view, array);
      if (found == nullptr) return {};
      return {static_cast<const char*>(found->data),
              to_index(host::array_bytes(found->dtype, found->ndim, found->shape))};
    }
    return {};
  }

  nlohmann::json metrics(const std::string& folder) const {
    const Ended ended = weft({"eval", path(folder), "--json", path(folder + ".json")});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    return nlohmann::json::parse(read_text(path(folder + ".json")), nullptr, false);
  }
};

TEST_F(MatchSets, ComeBackBitForBitFromNpzAndFromCsv) {
  run(trials(), "made");
  for (const std::string form : {"npz", "csv"}) {
    convert(path("trials.yaml"), form, form);
    write("weft: 1\nextends: " + form + "/sequence.yaml\n", form + ".yaml");
    run(path(form + ".yaml"), "from_" + form);
    for (const std::string frame : {"/frames/000000.npz", "/frames/000001.npz"}) {
      for (const char* array :
           {"template_px", "image_px", "face", "barycentrics", "kept", "score"}) {
        const std::string made = bytes(path("made" + frame), "sources.correspondences", array);
        EXPECT_GE(made.size(), 40U) << array;
        EXPECT_TRUE(bytes(path("from_" + form + frame), "sources.correspondences", array) == made)
            << form << " " << array;
      }
      for (const char* array : {"match_xy_px", "points_m", "template_xy_m", "faces"}) {
        const std::string made = bytes(path("made" + frame), "ground_truth", array);
        EXPECT_FALSE(made.empty()) << array;
        EXPECT_TRUE(bytes(path("from_" + form + frame), "ground_truth", array) == made)
            << form << " " << array;
      }
    }
  }
}

TEST_F(MatchSets, HaveTheSameTextAfterEveryWayThroughNpz) {
  convert(trials(), "first", "csv");
  convert(path("first"), "binary", "npz");
  convert(path("binary"), "again", "csv");
  for (const char* file : {"/matches/000000.csv", "/matches/000001.csv", "/camera.yaml"}) {
    const std::string text = read_text(path("first") + file);
    EXPECT_GT(text.size(), 80U);
    EXPECT_EQ(read_text(path("again") + file), text);
  }
  EXPECT_THAT(read_text(path("first/matches/000000.csv")),
              HasSubstr("template_x_px,template_y_px,image_x_px,image_y_px,true_x_px,true_y_px"));
}

TEST_F(MatchSets, OfARunHoldWhatAFilterLeft) {
  trials();
  write(
      "weft: 1\nextends: trials.yaml\nstages:\n"
      "  - {use: filters/oracle, params: {tolerance_px: 2}}\n",
      "filtered.yaml");
  run(path("filtered.yaml"), "filtered");
  convert(path("filtered"), "all", "csv", {"--stage", "sources"});
  convert(path("filtered"), "left", "csv", {"--stage", "sources.filters"});
  const auto kept = [&](const std::string& folder) {
    std::size_t count = 0;
    for (const std::string& line : read_lines(path(folder) + "/matches/000000.csv")) {
      count += line.ends_with(",1") ? 1 : 0;  // kept is the last column
    }
    return count;
  };
  EXPECT_EQ(kept("all"), 40U);
  EXPECT_GE(kept("left"), 24U);
  EXPECT_LE(kept("left"), 30U) << "16 of 40 matches are random";
  const Ended unknown = weft({"data", "convert", path("filtered"), "--matches", "csv", "--out",
                              path("none"), "--stage", "matchers"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err,
              HasSubstr("no stage 'matchers' made matches, of sources, sources.filters"));
  EXPECT_FALSE(fs::exists(path("none")));
  const Ended misplaced = weft({"data", "convert", path("all"), "--matches", "csv", "--out",
                                path("none"), "--stage", "sources"});
  EXPECT_EQ(misplaced.exit_code, 2);
  EXPECT_THAT(misplaced.err, HasSubstr("is no run folder: leave --stage out"));
}

TEST_F(MatchSets, OfARunGiveTheShapesOfThatRunBitForBit) {
  write("weft: 1\nextends: " WEFT_PIPELINES
        "/robusft_plus.yaml\nwithout: [overlay, meshes]\nsource: {params: {frames: 3}}\n",
        "images.yaml");
  run(path("images.yaml"), "images");
  const auto by_points = metrics("images")["filters"][0];
  const std::string stages =
      "stages:\n  - {use: filters/myneighbor, params: {warp: {use: warps/bbs}}}\n"
      "  - {use: warps/bbs, params: {robust: geman_mcclure}}\n  - {use: passes/salient_cells}\n"
      "  - {use: solvers/particle_sft, params: {initial_guess: {use: solvers/brunet_mdh}}}\n";
  for (const std::string form : {"npz", "csv"}) {
    convert(path("images"), form, form);
    write("weft: 1\nextends: " + form + "/sequence.yaml\n" + stages, form + ".yaml");
    run(path(form + ".yaml"), "from_" + form);
    for (const std::string frame : {"/frames/000000.npz", "/frames/000002.npz"}) {
      const std::string made = bytes(path("images" + frame), "shape", "vertices_m");
      EXPECT_GE(made.size(), 40U);
      EXPECT_TRUE(bytes(path("from_" + form + frame), "shape", "vertices_m") == made) << form;
    }
    const auto by_labels = metrics("from_" + form)["filters"][0];
    for (const char* rate : {"matches_labelled", "tpr_percent", "fpr_percent"}) {
      EXPECT_EQ(by_labels[rate], by_points[rate]) << form << " " << rate;
    }
  }
}

TEST_F(MatchSets, WithLabelsAloneGiveTheRatesOfAFilter) {
  fs::create_directories(path("set"));
  std::ofstream(path("set/all.csv"))
      << "frame,template_x_px,template_y_px,image_x_px,image_y_px,label\n"
         "0,10,20,100,120,1\n0,30,20,120,120,0\n0,30,40,120,140,1\n0,50,40,140,140,\n"
         "1,10,20,100,120,0\n1,30,20,120,120,0\n";
  std::ofstream(path("set/camera.yaml"))
      << "{fx: 800, fy: 800, cx: 319.5, cy: 239.5, width: 640, height: 480}\n";
  write(
      "weft: 1\nsource: {use: sources/matches, params: {path: set/all.csv, camera: "
      "set/camera.yaml}}\ntemplate: {use: templates/rectangular, params: "
      "{texture: " WEFT_DATA_FOLDER
      "/plain_sheet.png, width_m: 0.297}}\nstages: [{use: filters/oracle, params: {keep_unknown: "
      "true}}]\n",
      "labelled.yaml");
  run(path("labelled.yaml"), "labelled");
  const auto filters = metrics("labelled")["filters"];
  ASSERT_EQ(filters.size(), 1U);
  EXPECT_EQ(filters[0]["matches_labelled"], 5) << "one match has no label";
  EXPECT_EQ(filters[0]["tpr_percent"], 100.0) << "the oracle obeys the labels";
  EXPECT_EQ(filters[0]["fpr_percent"], 0.0);
  EXPECT_EQ(filters[0]["kept_percent"], 37.5) << "3 of 4 (one of them unknown), then none of 2";
}

TEST_F(MatchSets, FarFromTheTemplateAreAnErrorThatNamesTheUnits) {
  fs::create_directories(path("set"));
  std::ofstream(path("set/a.csv"))
      << "template_x_m,template_y_m,image_x_px,image_y_px\n120,80,100,120\n";
  std::ofstream(path("set/camera.yaml"))
      << "{fx: 800, fy: 800, cx: 319.5, cy: 239.5, width: 640, height: 480}\n";
  write(
      "weft: 1\nsource: {use: sources/matches, params: {path: set/a.csv, camera: "
      "set/camera.yaml}}\ntemplate: {use: templates/rectangular, params: "
      "{texture: " WEFT_DATA_FOLDER "/plain_sheet.png, width_m: 0.297}}\n",
      "far.yaml");
  const Ended ended = weft({"run", path("far.yaml"), "--out", path("far"), "--quiet"});
  EXPECT_NE(ended.exit_code, 0);
  EXPECT_THAT(read_text(path("far/frames.jsonl")),
              HasSubstr("none of the 1 matches lies on the template"));
}

}  // namespace
}  // namespace weft::testing
