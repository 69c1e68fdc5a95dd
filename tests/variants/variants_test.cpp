// SPDX-License-Identifier: Apache-2.0
// Plugins compiled for other instruction sets, under one host: masks are equal and shapes agree
// within a micrometre, whichever ran.
#include <gmock/gmock.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/geometry/types.hpp>

#include "host/loading/registry.hpp"
#include "host/records/npz.hpp"
#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Child;
using testing::Ended;

constexpr int kFrames = 8;
constexpr double kShapeTolerance_m = 1e-6;

/// The results of a frame of a run, without times and machine.
struct Frame {
  Points3 vertices_m;
  std::map<std::string, std::vector<std::uint8_t>> masks;  ///< by filter
  std::map<std::string, double> counts;                    ///< by stage
  std::vector<std::string> statuses;
};

bool processor_has(const std::string& isa) {
  if (isa == "avx2") return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (isa == "avx512") {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  }
  return true;
}

class Variants : public testing::PipelineTest {
 protected:
  Ended program(std::vector<std::string> words) const {
    words.insert(words.begin(), WEFT_PROGRAM);
    return Child(words, path("printed")).wait();
  }

  /// The folder of the libraries for an instruction set, each with its manifest.
  std::string plugins(const std::string& isa) const {
    std::string folder = std::string(WEFT_VARIANTS) + "/" + isa;
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() != ".so") continue;
      const Ended ended = program({"plugins", "describe", entry.path().string()});
      EXPECT_EQ(ended.exit_code, 0) << ended.err;
    }
    return folder;
  }

  /// Runs the beginning of the paper's pipeline with the plugins of these folders before all
  /// others.
  std::string run(const std::string& name, const std::vector<std::string>& folders) const {
    const std::string file =
        write("weft: 1\nextends: " WEFT_ROBUSFT "\nwithout: [overlay, meshes]\n");
    std::vector<std::string> words;
    for (const std::string& folder : folders) {
      words.insert(words.end(), {"--plugin-path", folder});
    }
    words.insert(words.end(), {"run", file, "--out", path(name), "--quiet", "--set",
                               "source.frames=" + std::to_string(kFrames)});
    const Ended ended = program(words);
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    return path(name);
  }

  /// Folder of the library that was run, by stage.
  static std::map<std::string, std::string> libraries(const std::string& run) {
    std::map<std::string, std::string> folders;
    const json manifest = json::parse(testing::read_text(run + "/manifest.json"));
    for (const json& component : manifest["components"]) {
      folders[component["stage"]] = fs::path(std::string(component["library"])).parent_path();
    }
    return folders;
  }

  static std::vector<Frame> frames(const std::string& run);
  static void expect_agreement(const std::string& reference, const std::string& other);
};

std::vector<Frame> Variants::frames(const std::string& run) {
  std::vector<Frame> all;
  for (const std::string& line : testing::read_lines(run + "/frames.jsonl")) {
    Frame frame;
    const json written = json::parse(line);
    for (const json& stage : written["stages"]) {
      const std::string name = stage["stage"];
      frame.statuses.push_back(name + " " + std::string(stage["status"]));
      for (const char* count : {"keypoints", "matches", "kept", "sightlines"}) {
        if (stage.contains(count)) frame.counts[name + "." + count] = stage[count];
      }
    }
    const auto records = host::read_npz(run + "/frames/" + std::string(written["stem"]) + ".npz");
    if (!records) throw std::runtime_error(records.error().message);
    for (const auto& [slot, record] : *records) {
      if (record->type() == Shape::kType) {
        frame.vertices_m = host::view_as<Shape>(*record)->vertices_m.matrix<3>();
      }
      if (record->type() != InlierMask::kType) continue;
      const auto kept = host::view_as<InlierMask>(*record)->kept;
      frame.masks[slot].assign(kept.data(), kept.data() + kept.rows());
    }
    all.push_back(std::move(frame));
  }
  return all;
}

void Variants::expect_agreement(const std::string& reference, const std::string& other) {
  const std::vector<Frame> expected = frames(reference), given = frames(other);
  ASSERT_EQ(expected.size(), std::size_t{kFrames});
  ASSERT_EQ(given.size(), std::size_t{kFrames});
  double worst_m = 0.0;
  for (std::size_t f = 0; f < expected.size(); ++f) {
    SCOPED_TRACE("frame " + std::to_string(f));
    EXPECT_EQ(given[f].statuses, expected[f].statuses);
    EXPECT_EQ(given[f].counts, expected[f].counts);
    EXPECT_EQ(given[f].masks, expected[f].masks);  // no match is that near to a threshold
    EXPECT_EQ(expected[f].masks.size(), 1U);
    ASSERT_GT(expected[f].vertices_m.rows(), 0);
    ASSERT_EQ(given[f].vertices_m.rows(), expected[f].vertices_m.rows());
    const Points3 distance_m = given[f].vertices_m - expected[f].vertices_m;
    worst_m = std::max(worst_m, distance_m.rowwise().norm().maxCoeff());
  }
  std::cout << "largest distance of a vertex " << 1e3 * worst_m << " mm\n";
  EXPECT_LT(worst_m, kShapeTolerance_m);
}

class InstructionSet : public Variants, public ::testing::WithParamInterface<const char*> {};

TEST_P(InstructionSet, GivesTheMasksAndShapesOfTheOrdinaryBuild) {
  const std::string isa = GetParam();
  if (!processor_has(isa)) GTEST_SKIP() << "this processor has no " << isa;
  const std::string folder = plugins(isa);
  const std::string given = run("given", {folder});
  const auto used = libraries(given);
  for (const char* stage : {"detectors", "matchers", "filters", "filters/warp", "warps", "passes",
                            "solvers", "solvers/initial_guess"}) {
    EXPECT_EQ(used.at(stage), folder) << stage;
  }
  EXPECT_NE(used.at("sources"), folder);
  expect_agreement(run("ordinary", {}), given);
}

INSTANTIATE_TEST_SUITE_P(, InstructionSet, ::testing::Values("plain", "avx2", "avx512"),
                         [](const auto& isa) { return std::string(isa.param); });

TEST_F(Variants, TheirManifestsSayWhatTheyNeed) {
  const std::map<std::string, std::vector<std::string>> needed{
      {"plain", {}}, {"avx2", {"avx2", "fma"}}, {"avx512", {"avx2", "fma", "avx512f"}}};
  for (const auto& [isa, features] : needed) {
    if (!processor_has(isa)) continue;
    const auto registry = host::Registry::scan({{plugins(isa), "test"}});
    EXPECT_EQ(registry.installed().size(), 7U) << isa;
    EXPECT_TRUE(registry.refusals().empty()) << isa;
    for (const host::Installed& installed : registry.installed()) {
      EXPECT_EQ(installed.library->isa.empty(), features.empty()) << isa;
      EXPECT_THAT(installed.library->isa, ::testing::IsSupersetOf(features)) << isa;
    }
  }
}

TEST_F(Variants, MixInOneRun) {
  for (const char* isa : {"avx2", "avx512"}) {
    if (!processor_has(isa)) GTEST_SKIP() << "this processor has no " << isa;
  }
  // Both solvers with AVX-512, both warps without any of it, the rest with AVX2.
  const std::map<std::string, std::vector<std::string>> chosen{
      {"avx512", {"solvers_particle_sft", "solvers_brunet_mdh"}}, {"plain", {"warps_bbs"}}};
  for (const auto& [isa, names] : chosen) {
    const std::string all = plugins(isa);
    fs::create_directory(path(isa));
    for (const std::string& name : names) {
      for (const char* suffix : {".so", ".plugin.yaml"}) {
        fs::copy(all + "/" + name + suffix, path(isa) + "/" + name + suffix);
      }
    }
  }
  const std::string rest = plugins("avx2");
  const std::string mixed = run("mixed", {path("avx512"), path("plain"), rest});
  const auto used = libraries(mixed);
  for (const char* stage : {"solvers", "solvers/initial_guess"})
    EXPECT_EQ(used.at(stage), path("avx512"));
  for (const char* stage : {"warps", "filters/warp"}) EXPECT_EQ(used.at(stage), path("plain"));
  for (const char* stage : {"detectors", "matchers", "filters", "passes"}) {
    EXPECT_EQ(used.at(stage), rest) << stage;
  }
  expect_agreement(run("ordinary", {}), mixed);
}

}  // namespace
}  // namespace weft
