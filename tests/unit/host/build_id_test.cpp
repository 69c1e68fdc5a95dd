// SPDX-License-Identifier: Apache-2.0
#include "host/describe/build_id.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>

#include "misbehaving/misbehaving.hpp"

namespace weft::host {
namespace {

TEST(BuildId, IsTheSha1ThatTheManifestNames) {
  const auto id = read_build_id(misbehaving::library("filters_test_good"));
  ASSERT_TRUE(id) << id.error().message;
  EXPECT_EQ(id->size(), 40U);
  for (const char c : *id) EXPECT_TRUE(std::isxdigit(static_cast<unsigned char>(c)));
  const auto manifest = read_manifest(misbehaving::kFolder + "/filters_test_good.plugin.yaml");
  ASSERT_TRUE(manifest);
  EXPECT_EQ(manifest->build_id, *id);
}

TEST(BuildId, DiffersBetweenLibraries) {
  EXPECT_NE(*read_build_id(misbehaving::library("filters_test_good")),
            *read_build_id(misbehaving::library("filters_test_throws")));
}

TEST(BuildId, SurvivesStrip) {
  const misbehaving::TemporaryFolder folder;
  folder.adopt("filters_test_good");
  const std::string copy = folder / "filters_test_good.so";
  const auto size = std::filesystem::file_size(copy);
  if (std::system(("strip " + copy).c_str()) != 0) GTEST_SKIP() << "there is no strip";
  EXPECT_LT(std::filesystem::file_size(copy), size);
  EXPECT_EQ(*read_build_id(copy), *read_build_id(misbehaving::library("filters_test_good")));
  EXPECT_NE(misbehaving::scan(folder.path()).find("filters/test_good"), nullptr);
}

TEST(BuildId, SaysWhyThereIsNone) {
  const misbehaving::TemporaryFolder folder;
  EXPECT_EQ(read_build_id(folder / "absent.so").error().code, Errc::io);
  misbehaving::write_file(folder / "text.so", std::string(200, 'x'));
  EXPECT_EQ(read_build_id(folder / "text.so").error().message, "is no 64-bit ELF file");
  EXPECT_FALSE(read_build_id(folder.path()));
  const std::string image = misbehaving::read_file(misbehaving::library("filters_test_good"));
  misbehaving::write_file(folder / "short.so", image.substr(0, 100));
  EXPECT_EQ(read_build_id(folder / "short.so").error().message,
            "is a truncated ELF file: its program headers reach beyond its end at 100 bytes");
}

}  // namespace
}  // namespace weft::host
