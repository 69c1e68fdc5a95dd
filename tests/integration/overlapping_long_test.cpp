// SPDX-License-Identifier: Apache-2.0
// Every pipeline of this repository with several frames at once against one after another.
#include <algorithm>
#include <cstdlib>

#include "overlapping_pipelines.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;

// A sanitizer looks at memory and threads, in the run where most is on its way: that numbers are
// the same whatever the overlap counts in release.
#if defined(WEFT_SANITIZED)
constexpr bool kIsSanitized = true;
constexpr const char *kFrames = "4", *kRecorded = "004";
#else
constexpr bool kIsSanitized = false;
constexpr const char *kFrames = "8", *kRecorded = "010";
#endif

/// But those that show a camera live: which of its frames they take depends on time.
std::vector<std::string> all_pipelines() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(WEFT_PIPELINES)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".yaml" && !name.starts_with("live")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool is_recorded(const std::string& pipeline) { return pipeline.starts_with("kinect_"); }

class EveryPipeline : public testing::OverlappingPipelines,
                      public ::testing::WithParamInterface<std::string> {
 protected:
  /// Those whose source has another parameter for it than `frames`.
  std::vector<std::string> few_frames(const std::string& pipeline) const override {
    const std::string few = std::string("=") + kFrames;
    if (pipeline == "matches.yaml") return {};  // it has three
    if (pipeline == "match_trials.yaml") return {"source.trials" + few};
    if (pipeline == "cuts.yaml") {
      return {"source.frames" + few, "source.cut_frames=[2]", "source.invisible_frames=[1]"};
    }
    if (pipeline == "known_points.yaml" || pipeline == "true_matches.yaml") {
      return {"source.frames.frames" + few};
    }
    if (is_recorded(pipeline)) {
      return {"source.path=" + folder_ + "/data/frames/*.png",
              "source.truth=" + folder_ + "/data/gt/*.csv"};
    }
    return {"source.frames" + few};
  }

  /// The first frames of the recorded sequence and their truth, by links; false where it is not
  /// there.
  bool few_recorded_frames() const {
    const char* root = std::getenv("WEFT_DATA");
    const fs::path data = fs::path(root != nullptr ? root : "") / "kinect_paper";
    if (root == nullptr || !fs::exists(data)) return false;
    for (const char* kind : {"frames", "gt"}) {
      fs::create_directories(folder_ + "/data/" + kind);
      for (const auto& entry : fs::directory_iterator(data / kind)) {
        const std::string name = entry.path().filename().string();
        if (name >= kRecorded && !name.starts_with("009")) continue;  // which pipelines name
        fs::create_symlink(entry.path(), folder_ + "/data/" + kind + "/" + name);
      }
    }
    return true;
  }
};

TEST_P(EveryPipeline, GivesTheSameWithAnyNumberOfFramesAtOnce) {
  const std::string& pipeline = GetParam();
  if (is_recorded(pipeline) && !few_recorded_frames()) {
    GTEST_SKIP() << "WEFT_DATA does not name a folder that holds kinect_paper/";
  }
  if (kIsSanitized && pipeline.starts_with("robusft_gpu")) {
    GTEST_SKIP() << "the compiler of the kernels takes half a minute: counts in release alone";
  }
  const std::vector<std::string> stages = stages_of(pipeline);
  ASSERT_FALSE(stages.empty());
  std::vector<std::vector<std::string>> overlaps{{"frames_at_once=4", "threads=4"}};
  if (!kIsSanitized) {
    overlaps.push_back({"frames_at_once=2", "threads=2"});
    overlaps.push_back(
        {"frames_at_once=3", "threads=3", stages[stages.size() / 2] + ".isolate=process"});
  }
  expect_the_same(pipeline, overlaps);
}

INSTANTIATE_TEST_SUITE_P(Pipelines, EveryPipeline, ::testing::ValuesIn(all_pipelines()),
                         [](const auto& each) { return fs::path(each.param).stem().string(); });

}  // namespace
}  // namespace weft
