// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <iostream>
#include <weft/core/rng.hpp>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

constexpr std::size_t kReserve = 1U << 20U;

TEST(SharedMemory, HasOneWriterAndAnyNumberOfReaders) {
  const auto writer = SharedMemory::create(SharedMemory::Access::write, kReserve);
  ASSERT_TRUE(writer) << writer.error().message;
  ASSERT_TRUE((*writer)->grow_to(100));
  std::strcpy(static_cast<char*>((*writer)->at(10, 90)), "hello");
  const int file = (*writer)->file();
  const auto reader = SharedMemory::attach(dup(file), SharedMemory::Access::read, kReserve);
  ASSERT_TRUE(reader);
  EXPECT_STREQ(static_cast<char*>((*reader)->at(10, 90)), "hello");
  EXPECT_FALSE(SharedMemory::attach(dup(file), SharedMemory::Access::write, kReserve));
}

TEST(SharedMemory, NeverShrinksUnderItsReaders) {
  const auto memory = SharedMemory::create(SharedMemory::Access::read, kReserve);
  ASSERT_TRUE(memory);
  const auto writer =
      SharedMemory::attach(dup((*memory)->file()), SharedMemory::Access::write, kReserve);
  ASSERT_TRUE(writer);
  ASSERT_TRUE((*writer)->grow_to(5000));
  EXPECT_NE(ftruncate((*writer)->file(), 10), 0);
  EXPECT_EQ((*memory)->size(), 5000U);
}

TEST(SharedMemory, GivesNothingOutsideTheFile) {
  const auto memory = SharedMemory::create(SharedMemory::Access::write, kReserve);
  ASSERT_TRUE(memory);
  EXPECT_EQ((*memory)->at(0, 1), nullptr);
  ASSERT_TRUE((*memory)->grow_to(1000));
  EXPECT_NE((*memory)->at(0, 1000), nullptr);
  EXPECT_NE((*memory)->at(1000, 0), nullptr);
  EXPECT_EQ((*memory)->at(1, 1000), nullptr);
  EXPECT_EQ((*memory)->at(1001, 0), nullptr);
  EXPECT_EQ((*memory)->at(8, ~std::uint64_t{0}), nullptr);
  EXPECT_EQ((*memory)->at(~std::uint64_t{0}, 2), nullptr);
  EXPECT_FALSE((*memory)->grow_to(kReserve + 1));
}

TEST(SharedArena, ReusesWhatWasGivenBack) {
  const auto arena = *SharedArena::create(kReserve);
  std::vector<std::shared_ptr<void>> blocks;
  for (int i = 0; i < 10; ++i) blocks.push_back(arena->allocate(100'000));
  EXPECT_EQ(arena->allocate(100'000), nullptr);
  blocks.erase(blocks.begin() + 3, blocks.begin() + 5);
  const auto joined = arena->allocate(200'000);
  ASSERT_NE(joined, nullptr) << "neighbours that were given back are one";
  EXPECT_EQ(arena->allocate(100'000), nullptr);
  blocks.clear();
  EXPECT_NE(arena->allocate(390'000), nullptr);
}

TEST(SharedArena, RandomUseNeverOverlapsAndEndsWhereItBegan) {
  constexpr std::uint64_t kArenaSeed = 31;
  std::cout << "seed " << kArenaSeed << "\n";
  Rng rng(kArenaSeed);
  const auto arena = *SharedArena::create(kReserve);
  struct Block {
    std::shared_ptr<void> memory;
    std::size_t size;
    int mark;
  };
  std::vector<Block> blocks;
  for (int round = 0; round < 3000; ++round) {
    if (!blocks.empty() && rng.below(2) == 0) {
      const auto index = rng.below(static_cast<std::uint32_t>(blocks.size()));
      const Block& block = blocks[index];
      const auto* bytes = static_cast<const unsigned char*>(block.memory.get());
      for (std::size_t i = 0; i < block.size; ++i) ASSERT_EQ(bytes[i], block.mark);
      blocks.erase(blocks.begin() + index);
      continue;
    }
    const std::size_t size = rng.below(30'000);
    const auto memory = arena->allocate(size);
    if (memory == nullptr) continue;
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(memory.get()) % 64, 0U);
    std::memset(memory.get(), round % 251, size);
    blocks.push_back({memory, size, round % 251});
  }
  blocks.clear();
  EXPECT_NE(arena->allocate(kReserve), nullptr);
}

TEST(SharedArena, RecordsThatDoNotFitAreRefused) {
  const auto arena = *SharedArena::create(kReserve);
  Record record("shape/1", arena);
  const std::int64_t fits[] = {1000}, too_long[] = {1'000'000};
  EXPECT_EQ(record.allocate("a", WEFT_F64, 1, too_long), nullptr);
  EXPECT_NE(record.allocate("a", WEFT_F64, 1, fits), nullptr);
  EXPECT_EQ(record.view("").arrays[0].memory, WEFT_SHARED);
}

}  // namespace
}  // namespace weft::host
