// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <set>

#include "host/calling/execution_context.hpp"
#include "host/calling/hashing.hpp"

namespace weft::host {
namespace {

TEST(ComponentSeed, GivesTheGoldenValues) {
  // XXH3_64bits of the bytes that the documentation lays down, computed apart from this code.
  EXPECT_EQ(component_seed(1, 0, "filters", ""), 0xfdc23718e4e43a18U);
  EXPECT_EQ(component_seed(1, 1, "filters", ""), 0x0398cc53c49706a4U);
  EXPECT_EQ(component_seed(2, 0, "filters", ""), 0x06ac30e6463360f3U);
  EXPECT_EQ(component_seed(1, 0, "filters", "warp"), 0x42b7e2d86c862e31U);
  EXPECT_EQ(component_seed(1, kOfflineFrame, "templates", ""), 0xd5287d7454f7ad54U);
  EXPECT_EQ(component_seed(7, 1234567890123, "filters#2", "start/warp"), 0xbd7975f8b9f03bfcU);
  EXPECT_EQ(component_seed(0, 0, "", ""), 0xc2915ca0df7ad4c1U);
  EXPECT_EQ(component_seed(1, 2, "filters", std::string(300, 'a'), 5), 0x5f98a7d98a2657f8U);
}

TEST(ComponentSeed, DiffersForEveryRunFrameStageAndNestedComponent) {
  std::set<std::uint64_t> seeds;
  for (const std::uint64_t run : {0, 1, 256}) {
    for (const std::uint64_t frame : {0, 1, 256}) {
      for (const char* stage : {"filters", "filters#2", "warp"}) {
        for (const char* path : {"", "warp", "warp/start"}) {
          seeds.insert(component_seed(run, frame, stage, path));
        }
      }
    }
  }
  EXPECT_EQ(seeds.size(), 81U);
  EXPECT_NE(component_seed(1, 0, "ab", "c"), component_seed(1, 0, "a", "bc"));
}

TEST(ContentRevision, DependsOnTheContentAlone) {
  Camera camera{800, 800, 320, 240, 640, 480};
  const std::uint64_t first = content_revision(*Record::copy_of(camera));
  EXPECT_NE(first, 0U);
  EXPECT_EQ(content_revision(*Record::copy_of(camera)), first);
  camera.cx += 1e-9;
  EXPECT_NE(content_revision(*Record::copy_of(camera)), first);
}

TEST(ContentRevision, DependsOnTheShape) {
  Region wide, high;
  wide.mask = Array<std::uint8_t>({2, 8}, 0);
  high.mask = Array<std::uint8_t>({8, 2}, 0);
  EXPECT_NE(content_revision(*Record::copy_of(wide)), content_revision(*Record::copy_of(high)));
}

}  // namespace
}  // namespace weft::host
