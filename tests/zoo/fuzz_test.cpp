// SPDX-License-Identifier: Apache-2.0
// Files damaged anywhere end in an error or a refusal, never in a crash.
#include <iostream>
#include <weft/core/rng.hpp>
#include <weft/host/build_id.hpp>

#include "zoo.hpp"

namespace weft::zoo {
namespace {

constexpr std::uint64_t kSeed = 20240611;

/// `text` with a few bytes changed, and now and then cut short.
std::string damaged(std::string text, std::size_t reach, Rng& rng) {
  const auto size = static_cast<std::uint32_t>(std::min(text.size(), reach));
  for (std::uint32_t i = 0; i < 1 + rng.below(4); ++i) {
    text[rng.below(size)] = static_cast<char>(rng.below(256));
  }
  if (rng.below(5) == 0) text.resize(rng.below(size));
  return text;
}

TEST(DamagedFiles, ManifestsAreReadOrRefused) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const TemporaryFolder folder;
  const std::string whole = read_file(kFolder + "/filters_zoo_good.plugin.yaml");
  int refused = 0;
  for (int round = 0; round < 400; ++round) {
    write_file(folder / "x.plugin.yaml", damaged(whole, whole.size(), rng));
    const auto manifest = host::read_manifest(folder / "x.plugin.yaml");
    if (manifest) continue;
    ++refused;
    EXPECT_FALSE(manifest.error().message.empty());
    EXPECT_NE(manifest.error().where.find("x.plugin.yaml"), std::string::npos);
  }
  EXPECT_GT(refused, 100);
}

TEST(DamagedFiles, BuildIdsAreReadOrTheFileIsRefused) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const TemporaryFolder folder;
  const std::string whole = read_file(library("filters_zoo_good")).substr(0, 4096);
  const auto right = host::read_build_id(library("filters_zoo_good"));
  ASSERT_TRUE(right);
  int other = 0;
  for (int round = 0; round < 1000; ++round) {
    write_file(folder / "x.so", damaged(whole, 700, rng));
    const auto id = host::read_build_id(folder / "x.so");
    if (!id || *id != *right) ++other;
  }
  EXPECT_GT(other, 100);
}

}  // namespace
}  // namespace weft::zoo
