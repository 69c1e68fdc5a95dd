// SPDX-License-Identifier: Apache-2.0
#include <sys/mount.h>

#include <chrono>
#include <memory>
#include <random>
#include <thread>

#include "ablation_fixture.hpp"
#include "support/child.hpp"

namespace weft::evaluation {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

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
    const auto stored = ResultsFolder::open(path(out), "plan")->read();
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

/// A small disk, or nothing where this user may not mount one.
class SmallDisk {
 public:
  explicit SmallDisk(std::string folder) : folder_(std::move(folder)) {
    fs::create_directories(folder_);
    mounted_ = mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=96k") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool is_there() const { return mounted_; }
  void grow() const { mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, "size=64m"); }

 private:
  std::string folder_;
  bool mounted_;
};

TEST_F(Survival, GoesOnWhereAFullDiskStoppedIt) {
  const SmallDisk disk(path("disk"));
  if (!disk.is_there()) GTEST_SKIP() << "this user may not mount a file system";
  finish("whole");
  const auto stopped = finish("disk/out");
  EXPECT_EQ(stopped.exit_code, 3) << stopped.out;
  // Which file is the one that finds no room depends on their sizes.
  EXPECT_THAT(stopped.err, AnyOf(HasSubstr("the disk not full?"), HasSubstr("the disk full?")));
  const std::set<std::string> before = finished("disk/out");
  disk.grow();
  EXPECT_EQ(finish("disk/out").exit_code, 1);
  const std::set<std::string> after = finished("disk/out");
  EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end()));
  EXPECT_EQ(results("disk/out"), results("whole"));
}

TEST_F(Survival, GoesOnWhereFilesGrewTooLarge) {
  finish("whole");
  std::string line = "ulimit -f 8; exec";
  for (const std::string& word : command("out", 1)) line += " '" + word + "'";
  const auto stopped = weft::testing::Child({"/bin/bash", "-c", line}, path("printed")).wait();
  EXPECT_EQ(stopped.exit_code, 3) << stopped.out;
  EXPECT_EQ(finish("out").exit_code, 1);
  EXPECT_EQ(results("out"), results("whole"));
}

}  // namespace
}  // namespace weft::evaluation
