// SPDX-License-Identifier: Apache-2.0
#include "foreign_data.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>

#include "host/records/npz.hpp"
#include "lab/metrics/shapes/true_surface.hpp"
#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// `weft run` and `weft eval` on data of others.
class ForeignDataTest : public PipelineTest {
 protected:
  void SetUp() override {
    for (const char* folder : {"frames", "masks", "gt/visible", "gt/hidden"}) {
      fs::create_directories(path(std::string("set/") + folder));
    }
    data_ = std::make_unique<ForeignData>(path("set"), WEFT_TEXTURE);
  }

  Ended weft(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS});
    return Child(std::move(words), path("said")).wait();
  }

  /// The pipeline, with further parameters of the source.
  void write_pipeline(const std::string& more) const {
    write(
        "weft: 1\n"
        "source:\n"
        "  use: sources/images\n"
        "  params:\n"
        "    path: set/frames/*.png\n"
        "    camera: set/camera.json\n" +
            more +
            "template: {use: templates/rectangular, params: {texture: " WEFT_TEXTURE
            ", width_m: 0.297, columns: 7, rows: 5}}\n"
            "stages:\n"
            "  - use: detectors/sift_fast\n"
            "  - {use: matchers/descriptor, params: {direction: image_to_template}}\n"
            "  - use: filters/aem\n"
            "  - use: warps/bbs\n"
            "  - use: passes/salient_cells\n"
            "  - {use: solvers/particle_sft, params: {initial_guess: {use: solvers/brunet_mdh}}}\n",
        "mine.yaml");
  }

  static const std::string kTruth;

  json metrics_of_run() {
    write_pipeline(kTruth + "    region: set/masks/*.png\n");
    const Ended run = weft({"run", path("mine.yaml"), "--out", path("run"), "--quiet"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const Ended eval = weft({"eval", path("run"), "--surfaces"});
    EXPECT_EQ(eval.exit_code, 0) << eval.err;
    table_ = eval.out;
    return json::parse(read_text(path("run/metrics.json")));
  }

  std::unique_ptr<ForeignData> data_;
  std::string table_;
};

const std::string ForeignDataTest::kTruth =
    "    truth: set/gt/*/*\n    truth_parts: visible hidden\n    truth_unit_m: 0.001\n";

/// The shape and the truth that a run kept of a frame.
struct KeptFrame {
  explicit KeptFrame(const std::string& file) : records(*host::read_npz(file)) {
    for (const auto& [slot, record] : records) {
      if (slot == "shape") shape = *host::view_as<Shape>(*record);
      if (slot == "ground_truth") truth = *host::view_as<GroundTruth>(*record);
      if (slot.ends_with(".correspondences")) matches = *host::view_as<Correspondences>(*record);
    }
  }

  host::NamedRecords records;
  Shape shape;
  GroundTruth truth;
  Correspondences matches;
};

TEST_F(ForeignDataTest, IsMeasuredPartByPartInAllItsForms) {
  const json metrics = metrics_of_run();
  const auto scene = host::read_npz(path("run/template.npz"));
  ASSERT_TRUE(scene);
  const auto sheet = host::view_as<Template>(*scene->front().second);
  ASSERT_TRUE(sheet);
  for (int frame = 0; frame < ForeignData::kFrames; ++frame) {
    const KeptFrame kept(path("run/frames/00000" + std::to_string(frame) + ".npz"));
    ASSERT_TRUE(kept.shape.vertices_m.present());
    const auto mesh = lab::corners_of(kept.shape.vertices_m.matrix<3>(), sheet->faces.matrix<3>());
    const json& parts = metrics["frames"][static_cast<std::size_t>(frame)]["parts"];
    for (const bool hidden : {false, true}) {
      // The truth as it was made, and all pairs of its points and the faces of the mesh.
      double sum_mm = 0.0, squares_mm2 = 0.0, behind_mm = 0.0;
      const auto cloud = data_->cloud(frame, hidden);
      for (const Eigen::Vector3d& point : cloud) {
        double least = 1e9;
        for (const auto& corners : mesh) {
          least = std::min(least, 1e3 * lab::distance_to(corners, point));
        }
        sum_mm += least;
        squares_mm2 += least * least;
      }
      const auto vertices_m = kept.shape.vertices_m.matrix<3>();
      for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
        const Eigen::Vector3d vertex = vertices_m.row(v);
        behind_mm += 1e3 * std::abs(ForeignData::normal(frame).dot(vertex - cloud.front()));
      }
      const auto count = static_cast<double>(cloud.size());
      const json& part = parts[hidden ? "hidden" : "visible"];
      // Files have six decimals of a millimetre, or single precision.
      EXPECT_NEAR(part["surface_from_truth_mm"].get<double>(), sum_mm / count, 1e-4) << frame;
      EXPECT_NEAR(part["surface_from_truth_squared_mm2"].get<double>(), squares_mm2 / count, 1e-3);
      behind_mm /= static_cast<double>(kept.shape.vertices_m.rows());
      EXPECT_NEAR(behind_mm, hidden ? 5.0 : 0.0, 1.5) << "the shape itself, frame " << frame;
      EXPECT_NEAR(part["surface_from_truth_mm"].get<double>(), hidden ? 5.0 : 0.0, 1.5);
      EXPECT_GT(part["sampled_from_truth_mm"].get<double>(),
                part["surface_from_truth_mm"].get<double>());
    }
    EXPECT_EQ(metrics["frames"][static_cast<std::size_t>(frame)]["truth"]["points"],
              frame == 0 ? 2400 : 0);
  }
  EXPECT_EQ(metrics["parts"][0]["part"], "visible");
  EXPECT_EQ(metrics["parts"][0]["frames"], 3);
  EXPECT_EQ(metrics["parts"][0]["points"], 2400) << "those of the first frame have places";
  EXPECT_LT(metrics["parts"][0]["mean_mm"].get<double>(), 2.0);
  EXPECT_EQ(metrics["parts"][1]["points"], 0);
  EXPECT_EQ(metrics["surface"]["frames"], 3);
  EXPECT_EQ(metrics["surface"]["sampled_frames"], 3);
  EXPECT_THAT(table_, AllOf(HasSubstr("parts of the truth"), HasSubstr("hidden, sampled")));
}

TEST_F(ForeignDataTest, IsLookedAtInItsMasksOnly) {
  const auto outside = [&](const std::string& run) {
    const KeptFrame kept(path(run + "/frames/000002.npz"));
    int count = 0;
    for (std::int64_t n = 0; n < kept.matches.count(); ++n) {
      const cv::Point at(cvRound(kept.matches.image_px(n, 0)),
                         cvRound(kept.matches.image_px(n, 1)));
      count += data_->mask().at<std::uint8_t>(at) == 0;
    }
    EXPECT_GT(kept.matches.count(), 50);
    return count;
  };
  metrics_of_run();
  EXPECT_EQ(outside("run"), 0);
  write_pipeline(kTruth);
  ASSERT_EQ(weft({"run", path("mine.yaml"), "--out", path("blind"), "--quiet"}).exit_code, 0);
  EXPECT_GT(outside("blind"), 10) << "the copy of the print";
}

TEST_F(ForeignDataTest, IsRefusedWithPlaceAndFixBeforeAnythingRuns) {
  const auto said = [&](const std::string& more) {
    write_pipeline(more);
    const Ended check = weft({"check", path("mine.yaml")});
    EXPECT_EQ(check.exit_code, 2);
    return check.err + check.out;
  };
  fs::remove(path("set/masks/shot_1.png"));
  EXPECT_THAT(said("    region: set/masks/*.png\n"), HasSubstr("the frame 'shot_1' has no mask"));
  EXPECT_THAT(said("    truth: set/gt/visible/*\n    truth_parts: visble\n"),
              HasSubstr("no truth file has the part 'visble'"));
  EXPECT_THAT(said("    truth: set/gt/*/*\n"), HasSubstr("distinguish them as parts"));
  write("v 0 0 1\n", "set/gt/visible/shot_1.obj");
  EXPECT_THAT(said("    truth: set/gt/visible/*\n"), HasSubstr("the extension '.obj' is unknown"));
}

TEST_F(ForeignDataTest, WithADamagedCloudLosesThatFrameOnly) {
  write("X_mm,Y_mm,Z_mm\n1,2,nan\n", "set/gt/hidden/shot_2.csv");
  write_pipeline(kTruth);
  const Ended run = weft({"run", path("mine.yaml"), "--out", path("run"), "--quiet"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(read_text(path("run/frames.jsonl")),
              HasSubstr("shot_2.csv:2: 'Z_mm' must be a finite number, not 'nan'"));
}

}  // namespace
}  // namespace weft::testing
