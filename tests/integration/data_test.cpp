// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <weft/data/ground_truth.hpp>
#include <weft/data/matrix.hpp>

#include "host/records/npz.hpp"
#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// `weft data make frex`, and what can be done with the sequence.
class Data : public PipelineTest {
 protected:
  Ended weft(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS});
    return Child(std::move(words), path("said")).wait();
  }

  Ended make(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"data",
                                   "make",
                                   "frex",
                                   "--out",
                                   path(out),
                                   "--texture",
                                   WEFT_TEXTURE,
                                   "--frames",
                                   "4",
                                   "--set",
                                   "source.image_width_px=320",
                                   "--set",
                                   "source.image_height_px=240",
                                   "--set",
                                   "source.focal_px=400",
                                   "--set",
                                   "source.columns=32",
                                   "--set",
                                   "source.rows=23"};
    words.insert(words.end(), more.begin(), more.end());
    return weft(std::move(words));
  }

  /// The bytes of each file of a folder.
  std::map<std::string, std::string> contents(const std::string& folder) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(path(folder))) {
      if (!entry.is_regular_file()) continue;
      files[fs::relative(entry.path(), path(folder)).string()] = read_text(entry.path().string());
    }
    return files;
  }
};

TEST_F(Data, IsMadeTwiceWithTheSameBytes) {
  const Ended first = make("a", {"--seed", "7", "--background", "clutter", "--occluder"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("4 frames, 0 failed"));
  EXPECT_EQ(first.err, "") << "progress is for terminals";
  ASSERT_EQ(make("b", {"--seed", "7", "--background", "clutter", "--occluder"}).exit_code, 0);
  const auto a = contents("a"), b = contents("b");
  EXPECT_EQ(a.size(), 4U + 4U + 2U + 4U) << "frames, truth, template, descriptions";
  for (const auto& [name, bytes] : a) {
    ASSERT_EQ(b.count(name), 1U) << name;
    EXPECT_TRUE(b.at(name) == bytes) << name << " differs";
  }
  ASSERT_EQ(make("c", {"--seed", "8"}).exit_code, 0);
  EXPECT_NE(read_text(path("c/gt/000003.npz")), a.at("gt/000003.npz"));
}

TEST_F(Data, IsReadBackAsItWasWritten) {
  ASSERT_EQ(make("a").exit_code, 0);
  write("weft: 1\nextends: a/sequence.yaml\n", "again.yaml");
  const Ended again = weft({"run", path("again.yaml"), "--out", path("run"), "--quiet"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const auto made = host::read_npz(path("a/gt/000002.npz"));
  const auto read = host::read_npz(path("run/frames/000002.npz"));
  ASSERT_TRUE(made && read);
  const auto before = host::view_as<GroundTruth>(*made->front().second);
  const auto after = host::view_as<GroundTruth>(*read->front().second);
  EXPECT_EQ(after->kind, "frex");
  EXPECT_EQ(after->points_m.matrix<3>(), before->points_m.matrix<3>());
  EXPECT_EQ(after->faces.matrix<3>(), before->faces.matrix<3>());
}

TEST_F(Data, SaysWhatIsWrongAndLeavesNothing) {
  const Ended typo = make("a", {"--pattern", "rol"});
  EXPECT_EQ(typo.exit_code, 2);
  EXPECT_THAT(typo.err, HasSubstr("roll"));
  EXPECT_FALSE(fs::exists(path("a")));
  const Ended missing = weft({"data", "make", "frex", "--out", path("a"), "--texture", "none.png"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("none.png"));
  EXPECT_FALSE(fs::exists(path("a")));
  fs::create_directories(path("full"));
  std::ofstream(path("full/file")) << "in the way";
  const Ended full = make("full");
  EXPECT_EQ(full.exit_code, 3);
  EXPECT_THAT(full.err, HasSubstr("not an empty folder"));
}

/// For training: 160 x 120 px are both the frame and the small image.
TEST_F(Data, IsMadeForLearningTwiceWithTheSameBytes) {
  const auto make_shards = [&](const std::string& out) {
    return weft({"data", "make", "frex", "--for", "learning", "--out", path(out), "--texture",
                 WEFT_TEXTURE, "--frames", "6", "--seed", "3"});
  };
  const Ended first = make_shards("a");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("6 frames, 0 failed"));
  ASSERT_EQ(make_shards("b").exit_code, 0);
  const auto a = contents("a"), b = contents("b");
  EXPECT_EQ(a.size(), 2U + 6U) << "two descriptions, and six arrays";
  EXPECT_TRUE(a == b);
  EXPECT_THAT(a.at("shards.json"), HasSubstr("\"frames\": 6"));
  write("weft: 1\nextends: a/make.yaml\n", "again.yaml");
  const Ended again = weft({"run", path("again.yaml"), "--out", path("run"), "--quiet"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(read_text(path("run/000000/uv.npy")) == a.at("000000/uv.npy"));
}

TEST_F(Data, RefusesOptionsOfSequencesForLearning) {
  const Ended patterned = make("a", {"--for", "learning", "--pattern", "roll"});
  EXPECT_NE(patterned.exit_code, 0);
  EXPECT_THAT(patterned.err, HasSubstr("--pattern"));
  EXPECT_FALSE(fs::exists(path("a")));
  EXPECT_THAT(make("a", {"--for", "teaching"}).err, HasSubstr("learning"));
}

}  // namespace
}  // namespace weft::testing
