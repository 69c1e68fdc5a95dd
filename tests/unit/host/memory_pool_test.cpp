// SPDX-License-Identifier: Apache-2.0
#include "host/records/memory_pool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <thread>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/core/unwritten.hpp>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

/// Frames without an allocation.
void pass(MemoryPool& pool, int frames) {
  for (int i = 0; i < frames; ++i) pool.frame_done(to_index(i));
}

TEST(MemoryPool, HandsOutAgainWhatWasGivenBack) {
  MemoryPool pool;
  void* block = pool.take(1000);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % MemoryPool::kAlignment, 0U);
  void* other = pool.take(1000);
  EXPECT_NE(other, block);
  pool.give_back(block, 1000);
  void* larger = pool.take(2000);
  EXPECT_NE(larger, block) << "it is of another size";
  EXPECT_EQ(pool.take(600), block);
  pool.give_back(block, 600);
  pool.give_back(larger, 2000);
  pool.give_back(other, 1000);
  EXPECT_EQ(pool.holding().in_use, 0U);
  EXPECT_EQ(pool.holding().free, 2U * 1024 + 2048);
}

TEST(MemoryPool, KeepsWhatFramesNeededInThisPeriodOrTheLastOne) {
  MemoryPool pool;
  std::uint64_t frame = 0;
  const auto use = [&](std::size_t count) {
    std::vector<void*> blocks;
    for (std::size_t i = 0; i < count; ++i) blocks.push_back(pool.take(64));
    for (void* block : blocks) pool.give_back(block, 64);
    for (int pipeline = 0; pipeline < 3; ++pipeline) pool.frame_done(frame);
    ++frame;
  };
  use(10);
  while (frame < 2 * MemoryPool::kPeriod) {
    EXPECT_EQ(pool.holding().free, 10U * 64) << "frame " << frame;
    use(3);
  }
  while (frame < 3 * MemoryPool::kPeriod) use(3);
  EXPECT_EQ(pool.holding().free, 3U * 64);
  pass(pool, 3 * MemoryPool::kPeriod);
  EXPECT_EQ(pool.holding().free, 0U) << "nobody needs any";
}

TEST(MemoryPool, NeverDropsWhatIsInUse) {
  MemoryPool pool;
  auto* block = static_cast<char*>(pool.take(100));
  std::memset(block, 7, 100);
  pass(pool, 5 * MemoryPool::kPeriod);
  EXPECT_EQ(pool.holding().in_use, 128U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(block[i], 7);
  pool.give_back(block, 100);
}

TEST(MemoryPool, KeepsNothingOnceItIsClosed) {
  MemoryPool pool;
  void *one = pool.take(100), *two = pool.take(100);
  pool.give_back(one, 100);
  pool.close();
  EXPECT_EQ(pool.holding().free, 0U);
  EXPECT_EQ(pool.holding().in_use, 128U) << "somebody still reads it";
  pool.give_back(two, 100);
  EXPECT_EQ(pool.holding().free, 0U);
  EXPECT_EQ(pool.holding().in_use, 0U);
}

TEST(MemoryPool, RefusesWhatNoMachineHas) {
  MemoryPool pool;
  EXPECT_EQ(pool.take(std::size_t{1} << 60U), nullptr);
  EXPECT_EQ(pool.take(~std::size_t{0}), nullptr);
  EXPECT_EQ(pool.holding().in_use, 0U);
  const auto shared = std::make_shared<MemoryPool>();
  EXPECT_EQ(own_memory(~std::size_t{0}, shared), nullptr);
  EXPECT_EQ(own_memory(~std::size_t{0}, nullptr), nullptr);
}

TEST(MemoryPool, GivesNoBlockToTwoThreads) {
  constexpr std::uint64_t kSeed = 57;
  std::cout << "seed " << kSeed << "\n";
  MemoryPool pool;
  const auto work = [&](std::uint64_t seed) {
    struct Mine {
      unsigned char* block;
      std::size_t bytes;
      unsigned char mark;
    };
    Rng rng(seed);
    std::vector<Mine> mine;
    for (int round = 0; round < 4000; ++round) {
      if (mine.size() > 20 || (!mine.empty() && rng.below(2) == 0)) {
        const auto index = rng.below(static_cast<std::uint32_t>(mine.size()));
        const Mine one = mine[index];
        for (std::size_t i = 0; i < one.bytes; ++i) ASSERT_EQ(one.block[i], one.mark);
        pool.give_back(one.block, one.bytes);
        mine.erase(mine.begin() + index);
      } else {
        const std::size_t bytes = 1 + rng.below(500);
        const auto mark = static_cast<unsigned char>(rng.below(256));
        auto* block = static_cast<unsigned char*>(pool.take(bytes));
        std::memset(block, mark, bytes);
        mine.push_back({block, bytes, mark});
      }
      if (round % 50 == 0) pool.frame_done(to_index(round));
    }
    for (const Mine& one : mine) pool.give_back(one.block, one.bytes);
  };
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t i = 0; i < 4; ++i) threads.emplace_back(work, kSeed + i);
  }
  EXPECT_EQ(pool.holding().in_use, 0U);
}

TEST(PooledVector, LivesLongerThanTheOwnerOfItsPool) {
  PooledVector<int> numbers;
  {
    const auto pool = std::make_shared<MemoryPool>();
    numbers = PooledVector<int>({1, 2, 3}, pool);
    pool->close();
  }
  numbers.push_back(4);
  EXPECT_THAT(numbers, ::testing::ElementsAre(1, 2, 3, 4));
}

class PooledRecord : public ::testing::Test {
 protected:
  std::shared_ptr<Record> make(std::int64_t count) const {
    auto record = Record::make(InlierMask::kType, pool_);
    record->allocate("kept", WEFT_U8, 1, &count);
    record->allocate("score", WEFT_F64, 1, &count);
    return record;
  }
  static const void* place_of(const Record& record, const char* array) {
    return find_array(record.view(""), array)->data;
  }

  std::shared_ptr<MemoryPool> pool_ = std::make_shared<MemoryPool>();
};

TEST_F(PooledRecord, ReusesTheMemoryOfThePreviousRecord) {
  auto record = make(3000);
  const void* before = place_of(*record, "score");
  const std::size_t in_use = pool_->holding().in_use;
  record.reset();
  EXPECT_EQ(pool_->holding().in_use, 0U);
  record = make(2900);
  EXPECT_EQ(place_of(*record, "score"), before);
  EXPECT_EQ(pool_->holding().in_use, in_use);
  EXPECT_EQ(pool_->holding().free, 0U);
}

TEST_F(PooledRecord, KeepsAnArrayThatItSharesUntilItsLastReferenceEnds) {
  auto record = make(300);
  const void* kept = place_of(*record, "kept");
  Record heir(InlierMask::kType);
  heir.share(*record, "kept");
  record.reset();
  record = make(300);
  EXPECT_NE(place_of(*record, "kept"), kept);
  EXPECT_EQ(place_of(heir, "kept"), kept);
}

TEST_F(PooledRecord, OutlivesItsPool) {
  const auto record = make(300);
  pool_->close();
  pool_.reset();
  ASSERT_EQ(record->view("").count, 2U);
  EXPECT_STREQ(record->view("").arrays[1].name, "score");
}

TEST_F(PooledRecord, IsMarkedAgainAsUnwrittenWhereThatIsDone) {
  const std::int64_t count = 5;
  for (int turn = 0; turn < 2; ++turn) {
    const auto record = make(count);
    auto* score = static_cast<double*>(record->allocate("score", WEFT_F64, 1, &count));
    if (kMarksUnwritten) {
      for (int i = 0; i < count; ++i) EXPECT_TRUE(std::isnan(score[i])) << "turn " << turn;
    }
    std::fill_n(score, count, 1.0);
    EXPECT_TRUE(is_finite(record->view("").arrays[1]));
  }
}

/// Minor page faults of this process so far.
long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

/// The page faults of a large block that is made, written and freed again and again.
long faults_of_blocks() {
  constexpr std::size_t kBlock_bytes = 8 << 20;
  constexpr int kTimes = 20;
  const long before = page_faults();
  for (int i = 0; i < kTimes; ++i) {
    const std::vector<char> block(kBlock_bytes, static_cast<char>(i));
    EXPECT_EQ(block.back(), static_cast<char>(i));
  }
  return page_faults() - before;
}

TEST(FreedMemory, IsUsedAgainWithoutAPageFault) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer has its own allocator";
#endif
  keep_freed_memory();
  constexpr long kPagesOfTwoBlocks = 2 * ((8 << 20) >> 12);
  EXPECT_LT(faults_of_blocks(), kPagesOfTwoBlocks);
}

}  // namespace
}  // namespace weft::host
