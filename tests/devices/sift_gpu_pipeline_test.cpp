// SPDX-License-Identifier: Apache-2.0
// pipelines/robusft_gpu.yaml beside robusft_plus.yaml, with the program as users run it.
#include <gmock/gmock.h>
#include <stdlib.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "support/child.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using testing::Child;
using ::testing::ContainsRegex;
using testing::Ended;
using ::testing::HasSubstr;

constexpr std::size_t kFrames = 3;
const std::string kProcessor = WEFT_PIPELINES "/robusft_plus.yaml",
                  kGpu = WEFT_PIPELINES "/robusft_gpu.yaml";

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

class GpuPipeline : public ::testing::Test {
 protected:
  /// One folder for all tests, which compare with the run `gpu` in it.
  static void SetUpTestSuite() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    const Ended done = run(kGpu, "gpu");
    EXPECT_EQ(done.exit_code, 0) << done.err;
  }
  static void TearDownTestSuite() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  /// The words after the program, with `variables` NAME=VALUE in its environment.
  static Child start(const std::vector<std::string>& words,
                     const std::vector<std::string>& variables, const std::string& printed) {
    std::vector<std::string> command{"/usr/bin/env"};
    command.insert(command.end(), variables.begin(), variables.end());
    command.insert(command.end(), {WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS});
    command.insert(command.end(), words.begin(), words.end());
    return Child(command, path(printed));
  }
  static Ended weft(const std::vector<std::string>& words,
                    const std::vector<std::string>& variables = {}) {
    return start(words, variables, "printed").wait();
  }

  static Child start_run(const std::string& pipeline, const std::string& out,
                         const std::vector<std::string>& settings = {},
                         const std::vector<std::string>& variables = {}) {
    std::vector<std::string> words{"run", pipeline, "--quiet", "--out", path(out)};
    words.insert(words.end(), {"--set", "source.frames=" + std::to_string(kFrames)});
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    return start(words, variables, out + ".printed");
  }
  static Ended run(const std::string& pipeline, const std::string& out,
                   const std::vector<std::string>& settings = {},
                   const std::vector<std::string>& variables = {}) {
    return start_run(pipeline, out, settings, variables).wait();
  }

  static void expect_the_same_frames(const std::string& out, const std::string& expected) {
    std::size_t frames = 0;
    for (const fs::directory_entry& frame : fs::directory_iterator(path(expected + "/frames"))) {
      const std::string name = frame.path().filename().string();
      EXPECT_EQ(read_text(path(out + "/frames/" + name)), read_text(frame.path())) << name;
      ++frames;
    }
    EXPECT_EQ(frames, kFrames);
  }

  static json metrics(const std::string& out) {
    const Ended done =
        weft({"eval", path(out), "--json", path("metrics.json"), "--overwrite", "--quiet"});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return json::parse(read_text(path("metrics.json")));
  }

  /// The entries of a stage in frames.jsonl, frame by frame.
  static std::vector<json> reports(const std::string& out, const std::string& stage) {
    std::vector<json> found;
    std::ifstream lines(path(out + "/frames.jsonl"));
    for (std::string line; std::getline(lines, line);) {
      const json frame = json::parse(line);
      for (const json& report : frame.at("stages")) {
        if (report.at("stage") == stage) found.push_back(report);
      }
    }
    return found;
  }

  static std::string path(const std::string& name) { return (folder_ / name).string(); }

 private:
  inline static fs::path folder_;
};

/// No OpenCL driver can be found.
const std::vector<std::string> kNoDriver{"OCL_ICD_VENDORS=/nonexistent"};

TEST_F(GpuPipeline, MatchesAndRecoversAsWellAsTheDemo) {
  ASSERT_EQ(run(kProcessor, "processor").exit_code, 0);
  const json processor = metrics("processor"), gpu = metrics("gpu");
  ASSERT_EQ(gpu.at("frames").size(), kFrames);
  for (std::size_t i = 0; i < kFrames; ++i) {
    const auto correct = [&](const json& of) {
      return of.at("frames").at(i).at("filters").at("filters").at("correct").get<double>();
    };
    std::printf("frame %zu: %g correct matches of the processor, %g of the device\n", i,
                correct(processor), correct(gpu));
    EXPECT_GT(correct(processor), 100.0);
    EXPECT_GE(correct(gpu), 0.95 * correct(processor)) << "frame " << i;
  }
  const auto mean_mm = [](const json& of) {
    return of.at("all").at("error_solved").at("mean_mm").get<double>();
  };
  std::printf("mean %.3f mm of the processor, %.3f mm of the device\n", mean_mm(processor),
              mean_mm(gpu));
  EXPECT_LE(mean_mm(gpu), 1.05 * mean_mm(processor));
}

TEST_F(GpuPipeline, DescriptorsReachTheHostOnlyForThoseWhoReadThemThere) {
  ASSERT_EQ(run(kGpu, "mixed", {"matchers.use=matchers/descriptor"}).exit_code, 0);
  const std::vector<json> gpu = reports("gpu", "matchers"), mixed = reports("mixed", "matchers");
  ASSERT_EQ(gpu.size(), kFrames);
  ASSERT_EQ(mixed.size(), kFrames);
  constexpr std::uint64_t kRowBytes = 128 * sizeof(float);
  const std::vector<json> detected = reports("mixed", "detectors");
  for (std::size_t i = 0; i < kFrames; ++i) {
    EXPECT_EQ(gpu[i].value("downloaded_bytes", 0U), 0U);
    const auto rows = mixed[i].at("downloaded_bytes").get<std::uint64_t>();
    const auto keypoints = detected[i].at("keypoints").get<std::uint64_t>();
    if (i == 0) {
      EXPECT_GT(rows, kRowBytes * keypoints) << "those of the template too";
    } else {
      EXPECT_EQ(rows, kRowBytes * keypoints);
    }
  }
}

TEST_F(GpuPipeline, StagesInProcessesOfTheirOwnAnswerTheSameToTheByte) {
  const Ended isolated =
      run(kGpu, "apart", {"detectors.isolate=process", "matchers.isolate=process"});
  ASSERT_EQ(isolated.exit_code, 0) << isolated.err;
  expect_the_same_frames("apart", "gpu");
}

TEST_F(GpuPipeline, TwoRunsOnOneDeviceThatBothFindNoCompiledKernelsAnswerAsOneAlone) {
#if defined(WEFT_SANITIZED)
  GTEST_SKIP() << "the compiler of the kernels takes half a minute: counts in release alone";
#endif
  const std::vector<std::string> cold{"XDG_CACHE_HOME=" + path("cache")};
  Child first = start_run(kGpu, "first", {}, cold), second = start_run(kGpu, "second", {}, cold);
  for (Child* one : {&first, &second}) {
    const Ended done = one->wait();
    EXPECT_EQ(done.exit_code, 0) << done.err;
  }
  expect_the_same_frames("first", "gpu");
  expect_the_same_frames("second", "gpu");
}

TEST_F(GpuPipeline, WithoutADeviceIsRefusedBeforeTheFirstFrame) {
  const Ended refused = run(kGpu, "run", {}, kNoDriver);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("detectors/sift_gpu: there is no OpenCL device"),
                                 HasSubstr("pocl-opencl-icd"), HasSubstr("without_device")));
  EXPECT_TRUE(reports("run", "sources").empty());
  const Ended doctor = weft({"doctor"}, kNoDriver);
  EXPECT_THAT(doctor.out, HasSubstr("none for detectors/sift_gpu, matchers/gpu"));
}

TEST_F(GpuPipeline, WithoutADeviceFallsBackWhereConfiguredAndReportsItInEveryFrame) {
  const Ended done = run(WEFT_PIPELINES "/robusft_gpu_if_any.yaml", "run", {}, kNoDriver);
  ASSERT_EQ(done.exit_code, 0) << done.err;
  for (const std::string stage : {"detectors", "matchers"}) {
    const std::vector<json> flagged = reports("run", stage);
    ASSERT_EQ(flagged.size(), kFrames);
    for (const json& report : flagged) {
      EXPECT_EQ(report.at("status"), "degenerate") << report;
      EXPECT_THAT(report.at("reason").get<std::string>(),
                  HasSubstr("found by the fallback: there is no OpenCL device"));
    }
  }
  for (const json& report : reports("run", "detectors")) {
    EXPECT_EQ(report.at("keypoints"), 1000) << "the fallback has parameters of its own";
  }
  EXPECT_EQ(metrics("run").at("counts").at("solved"), kFrames);
}

TEST_F(GpuPipeline, DoctorListsTheDevicesOfThePluginsWithTheirIndices) {
  const Ended doctor = weft({"doctor"});
  EXPECT_THAT(doctor.out, ContainsRegex("device +0: .+ for detectors/sift_gpu, matchers/gpu"));
}

}  // namespace
}  // namespace weft
