// SPDX-License-Identifier: Apache-2.0
// Files damaged anywhere end in an error or a refusal, never in a crash.
#include <elf.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <iostream>
#include <weft/core/rng.hpp>

#include "host/describe/build_id.hpp"
#include "host/describe/describe.hpp"
#include "misbehaving.hpp"

namespace weft::misbehaving {
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
  const std::string whole = read_file(kFolder + "/filters_test_good.plugin.yaml");
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
  const std::string whole = read_file(library("filters_test_good"));
  const auto right = host::read_build_id(library("filters_test_good"));
  ASSERT_TRUE(right);
  int other = 0;
  for (int round = 0; round < 1000; ++round) {
    write_file(folder / "x.so", damaged(whole, 700, rng));
    const auto id = host::read_build_id(folder / "x.so");
    if (!id || *id != *right) ++other;
  }
  EXPECT_GT(other, 100);
}

/// The wait() status of a process that loads this library and describes its content.
int loaded_in_child(const std::string& file) {
  const pid_t child = fork();
  if (child == 0) {
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) {
      std::signal(signal, SIG_DFL);  // a sanitizer would make an exit code of it
    }
    const auto table = host::load_library(file);
    _exit(table && host::describe_library(**table, "x") ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(DamagedFiles, ATruncatedLibraryIsRefusedBeforeItIsMapped) {
  const TemporaryFolder folder;
  folder.adopt("filters_test_good");
  const std::string whole = read_file(library("filters_test_good"));
  ASSERT_EQ(loaded_in_child(library("filters_test_good")), 0);
  const std::string file = folder / "filters_test_good.so";
  for (std::size_t length = 0; length < whole.size(); length += whole.size() / 97) {
    write_file(file, whole.substr(0, length));
    const auto refused = host::load_library(file);
    ASSERT_FALSE(refused) << length;
    EXPECT_THAT(refused.error().message, ::testing::HasSubstr("ELF file")) << length;
    const host::Registry registry = scan(folder.path());
    EXPECT_EQ(registry.find("filters/test_good"), nullptr) << length;
    const host::Refusal listed = refusal_of(registry, "filters_test_good.so");
    EXPECT_THAT(listed.cause, ::testing::HasSubstr("ELF file")) << length;
    EXPECT_THAT(listed.fix, ::testing::HasSubstr("build or install the plugin again"));
  }
}

TEST(DamagedFiles, NoFlippedByteOfALibrarysHeadersEndsTheProgram) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const TemporaryFolder folder;
  const std::string whole = read_file(library("filters_test_good"));
  Elf64_Ehdr header;
  std::memcpy(&header, whole.data(), sizeof(header));
  const auto reach =
      static_cast<std::uint32_t>(header.e_phoff + std::size_t{header.e_phnum} * header.e_phentsize);
  const std::string file = folder / "x.so";
  int refused = 0;
  for (int round = 0; round < 150; ++round) {
    std::string bytes = whole;
    const std::uint32_t at = rng.below(reach);
    bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1 + rng.below(255)));
    write_file(file, bytes);
    const int status = loaded_in_child(file);
    EXPECT_FALSE(WIFSIGNALED(status)) << "signal " << WTERMSIG(status) << ", byte " << at;
    refused += status != 0 ? 1 : 0;
  }
  EXPECT_GT(refused, 50);
}

TEST(DamagedFiles, APipeThatIsNamedLikeALibraryBlocksNothing) {
  const TemporaryFolder folder;
  folder.adopt("filters_test_good");
  const std::string file = folder / "filters_test_good.so";
  fs::remove(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_THAT(host::load_library(file).error().message, ::testing::HasSubstr("is no regular file"));
  EXPECT_THAT(refusal_of(scan(folder.path()), "filters_test_good.so").cause,
              ::testing::HasSubstr("is no regular file"));
}

}  // namespace
}  // namespace weft::misbehaving
