// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>
#include <random>
#include <thread>

#include "ablation_fixture.hpp"
#include "support/child.hpp"

namespace weft::lab {
namespace {

class Survival : public AblationTest {
 protected:
  Survival() : plan_(write_plan(std::string(kGrid) + "metrics: {frames: true}\n")) {}

  std::vector<std::string> command(const std::string& out, int jobs) const {
    return {WEFT_PROGRAM,
            "--plugin-path",
            WEFT_TEST_PLUGINS,
            "ablate",
            plan_,
            "--out",
            path(out),
            "--jobs",
            std::to_string(jobs),
            "--set",
            "source.sleep_ms=3"};
  }

  weft::testing::Ended finish(const std::string& out) const {
    return weft::testing::Child(command(out, 2), path("printed")).wait();
  }

  /// Keys of whole lines.
  std::set<std::string> finished(const std::string& out) const {
    std::set<std::string> keys;
    if (!fs::exists(path(out + "/manifest.json"))) return keys;
    const auto locked = ResultsFolder::open(path(out), "plan");  // without a writer
    EXPECT_TRUE(locked);
    const auto stored = read_cell_records(path(out), {});
    EXPECT_TRUE(stored);
    for (const auto& [key, cell] : stored->cells) keys.insert(key);
    return keys;
  }

  std::string plan_;
};

std::vector<pid_t> children_of(pid_t process) {
  const std::string id = std::to_string(process);
  std::ifstream stream("/proc/" + id + "/task/" + id + "/children");
  return {std::istream_iterator<pid_t>(stream), {}};
}

/// At any moment, the host's own writes included; tests/hostile kills inside of cells.
TEST_F(Survival, LosesNoCellAndCountsNoneTwiceWhateverIsKilled) {
  constexpr int kKills = 200;
  const unsigned seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  ASSERT_EQ(finish("whole").exit_code, 1) << "some cells of this plan fail";
  const std::string expected = results("whole");
  const std::size_t keys = finished("whole").size();
  int kills = 0, rounds = 0;
  std::set<std::string> known;
  std::string out = "round0";
  auto program = std::make_unique<weft::testing::Child>(command(out, 2), path("printed"));
  while (kills < kKills) {
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 120));
    std::vector<pid_t> targets = children_of(program->id());
    targets.push_back(program->id());
    const pid_t target = targets[random() % targets.size()];
    kills += kill(target, SIGKILL) == 0 ? 1 : 0;
    if (target != program->id()) continue;
    program->wait();
    const std::set<std::string> now = finished(out);
    EXPECT_TRUE(std::includes(now.begin(), now.end(), known.begin(), known.end()));
    known = now;
    if (known.size() == keys) {
      ASSERT_EQ(finish(out).exit_code, 1);
      EXPECT_EQ(results(out), expected);
      out = "round" + std::to_string(++rounds);
      known.clear();
    }
    program = std::make_unique<weft::testing::Child>(command(out, 2), path("printed"));
  }
  program.reset();
  ASSERT_EQ(finish(out).exit_code, 1);
  EXPECT_EQ(results(out), expected);
  std::printf("%d kills, %d ablations killed to their end\n", kills, rounds);
}

}  // namespace
}  // namespace weft::lab
