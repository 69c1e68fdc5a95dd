// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "lab/ablation/plan/cell_identity.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;
using weft::testing::chain;

class Identity : public weft::testing::PipelineTest {
 protected:
  CellIdentity of(const std::string& text, std::uint64_t seed = 0,
                  const Measurement& measurement = {}) const {
    const auto [pipeline, report] = check(text);
    EXPECT_TRUE(report.ok()) << report.text();
    std::vector<yaml::Problem> problems;
    CellIdentity identity = Identifier().identify(pipeline, seed, measurement, problems);
    EXPECT_TRUE(problems.empty());
    return identity;
  }

  /// Stages, as indices, whose keys differ.
  static std::vector<std::size_t> differences(const CellIdentity& a, const CellIdentity& b) {
    std::vector<std::size_t> different;
    for (std::size_t i = 0; i < a.stages.size(); ++i) {
      if (a.stages[i] != b.stages[i]) different.push_back(i);
    }
    return different;
  }
};

constexpr std::size_t kDetector = 0, kMatcher = 1, kFilter = 2, kWarp = 3, kPass = 4, kSolver = 5;

TEST_F(Identity, IsTheSameForTheSameWork) {
  const CellIdentity once = of(chain({{"solvers", "{distance_m: 0.5}"}}));
  const CellIdentity again = of(chain({{"solvers", "{distance_m: 5.0e-1}"}}));
  EXPECT_EQ(once.key, again.key);
  EXPECT_EQ(once.stages, again.stages);
  EXPECT_EQ(once.key.size(), 32U);
}

TEST_F(Identity, DistinguishesCellsByWhatMayChangeTheirResults) {
  std::set<std::string> keys{of(chain()).key};
  EXPECT_TRUE(keys.insert(of(chain({{"solvers", "{distance_m: 0.5}"}})).key).second);
  EXPECT_TRUE(keys.insert(of(chain({{"sources", "{frames: 4}"}})).key).second);
  EXPECT_TRUE(keys.insert(of(chain({{"templates", "{columns: 7}"}})).key).second);
  EXPECT_TRUE(keys.insert(of(chain({}, "lost_after: 3")).key).second);
  Measurement scaled;
  scaled.options.alignment = Alignment::scale;
  EXPECT_TRUE(keys.insert(of(chain(), 0, scaled).key).second);
  Measurement sampled;
  sampled.options.surface_samples = 100;
  EXPECT_TRUE(keys.insert(of(chain(), 0, sampled).key).second);
  const std::string nested =
      "{use: filters/test.warped, params: {warp: {use: warps/test.scripted, "
      "params: {degenerate_at: [1]}}}}";
  std::string text = chain();
  const std::string filter = "{use: filters/test.scripted, params: {}}";
  text.replace(text.find(filter), filter.size(), nested);
  EXPECT_TRUE(keys.insert(of(text).key).second);
}

TEST_F(Identity, DependsOnWhenStagesAreCalledAndOnWhatDecidesIt) {
  const auto with = [](const std::string& when, const std::string& probe_params) {
    std::string text = chain();
    text.insert(text.find("  - {use: detectors"),
                "  - {use: matchers/test.pattern, as: probe, params: " + probe_params + "}\n");
    return text.insert(text.find("detectors/test.scripted, ") + 25, "when: " + when + ", ");
  };
  const CellIdentity plain = of(with("{not_ok: probe, every: 3}", "{}"));
  EXPECT_EQ(of(with("{every: 3, not_ok: [probe]}", "{}")).key, plain.key);
  const CellIdentity rarer = of(with("{not_ok: probe, every: 4}", "{}"));
  EXPECT_NE(rarer.key, plain.key);
  const std::vector<std::size_t> behind{1, 2, 3, 4, 5, 6};
  EXPECT_EQ(differences(rarer, plain), behind);
  const CellIdentity other = of(with("{not_ok: probe, every: 3}", "{error_at: [1]}"));
  EXPECT_EQ(differences(other, plain), (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST_F(Identity, LooksThroughPathsAtTheFiles) {
  const auto with = [&](const std::string& file, const std::string& content) {
    fs::create_directories(fs::path(path(file)).parent_path());
    std::ofstream(path(file)) << content;
    return of(chain({{"sources", "{path: " + path(file) + "}"}})).key;
  };
  const std::string key = with("here/data.txt", "content");
  EXPECT_EQ(with("there/data.txt", "content"), key);
  EXPECT_NE(with("here/data.txt", "contents"), key);
  EXPECT_NE(with("here/other.txt", "content"), key) << "frames may be named after their files";
  std::ofstream(path("here/data.txt")) << "content";
  const std::string pattern = of(chain({{"sources", "{path: " + path("here/*.txt") + "}"}})).key;
  std::ofstream(path("here/third.txt")) << "more";
  EXPECT_NE(of(chain({{"sources", "{path: " + path("here/*.txt") + "}"}})).key, pattern);
}

TEST_F(Identity, LeavesSinksAndWhatDoesNotDecideResultsOut) {
  const CellIdentity plain = of(chain());
  EXPECT_EQ(of(chain({{"sinks", "{path: other.txt}"}})).key, plain.key);
  EXPECT_EQ(of(chain(), 7).key, plain.key) << "no component is random";
}

TEST_F(Identity, HasWhatDecidesAFailureWhereItIsNotTheDefault) {
  const std::string plain = of(chain()).key;
  EXPECT_EQ(of(chain({}, "on_error: continue\nmax_failed: 0")).key, plain);
  EXPECT_NE(of(chain({}, "max_failed: 3")).key, plain);
  EXPECT_NE(of(chain({}, "on_error: stop")).key, plain);
}

TEST_F(Identity, HasTheRunSeedWhereAComponentIsRandom) {
  std::string text = chain();
  const std::string filter = "use: filters/test.scripted";
  text.replace(text.find(filter), filter.size(), "use: filters/test.random");
  const CellIdentity one = of(text, 1), two = of(text, 2);
  EXPECT_NE(one.key, two.key);
  EXPECT_EQ(one.group, two.group) << "they read the same frames";
  EXPECT_THAT(differences(one, two), ::testing::ElementsAre(kFilter, kWarp, kPass, kSolver));
}

TEST_F(Identity, ChangesTheKeysOfTheStagesThatDependOnAChange) {
  const CellIdentity plain = of(chain());
  // The filter and the solver read previous.shape: what makes the shape is before them all.
  EXPECT_THAT(differences(plain, of(chain({{"solvers", "{distance_m: 0.5}"}}))),
              ::testing::ElementsAre(kFilter, kWarp, kPass, kSolver));
  EXPECT_THAT(differences(plain, of(chain({{"detectors", "{count: 30}"}}))),
              ::testing::ElementsAre(kDetector, kMatcher, kFilter, kWarp, kPass, kSolver));
  EXPECT_THAT(differences(plain, of(chain({}, "lost_after: 3"))),
              ::testing::ElementsAre(kFilter, kWarp, kPass, kSolver));
}

TEST_F(Identity, SeparatesAStageFromLaterStages) {
  const auto line = [&](const std::string& last) {
    return weft::testing::head() +
           "stages:\n  - use: detectors/test.scripted\n  - use: matchers/test.scripted\n"
           "  - use: warps/test.scripted\n  - use: solvers/test.warped\n" +
           last;
  };
  const CellIdentity short_one = of(line("")),
                     long_one = of(line("  - use: solvers/test.warped\n"));
  EXPECT_TRUE(differences(short_one, long_one).empty());
  EXPECT_NE(short_one.key, long_one.key);
}

TEST_F(Identity, ReportsFilesThatAreAbsentAtTheirParameter) {
  const auto [pipeline, report] = check(chain({{"sources", "{path: nowhere/*.png}"}}));
  ASSERT_TRUE(report.ok()) << report.text();
  std::vector<yaml::Problem> problems;
  Identifier().identify(pipeline, 0, {}, problems);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_THAT(problems[0].message, ::testing::HasSubstr("no file matches"));
  EXPECT_EQ(problems[0].at.line, 2);
}

}  // namespace
}  // namespace weft::lab
