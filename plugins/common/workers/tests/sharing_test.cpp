// SPDX-License-Identifier: Apache-2.0
#include "common/workers/sharing.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft {
namespace {

TEST(Sharing, DoesEachPieceOnceOnAnyNumberOfThreads) {
  Workers workers;
  for (const int count : {0, 1, 7, 100}) {
    for (const int at_a_time : {1, 3, 200}) {
      for (const int threads : {0, 1, 2, 4}) {
        const Shares shares{count, at_a_time, threads};
        std::vector<std::atomic<int>> done(to_index(count));
        EXPECT_TRUE(share_out(workers, shares, [&](int worker, int begin, int end) {
          EXPECT_LT(worker, shares.workers());
          EXPECT_LE(end - begin, at_a_time);
          for (int i = begin; i < end; ++i) ++done[to_index(i)];
          return true;
        }));
        for (const auto& each : done) EXPECT_EQ(each, 1);
      }
    }
  }
}

TEST(Sharing, HasNoMoreWorkersThanBlocks) {
  EXPECT_EQ((Shares{10, 4, 8}.workers()), 3);
  EXPECT_EQ((Shares{0, 4, 8}.workers()), 1);
  EXPECT_EQ((Shares{10, 4, -1}.workers()), 1);
}

TEST(Sharing, BeginsNoBlockAfterACallThatSaidStop) {
  Workers workers;
  int calls = 0;
  EXPECT_FALSE(share_out(workers, {100, 1, 1}, [&](int, int begin, int) {
    ++calls;
    return begin < 4;
  }));
  EXPECT_EQ(calls, 5);
}

TEST(Sharing, EndsOnAllThreadsWhereOneThrowsAndGoesOnNextTime) {
  Workers workers;
  for (const int threads : {1, 2, 4}) {
    std::atomic<int> calls = 0;
    const auto fail_at_once = [&](int, int, int) -> bool {
      ++calls;
      throw std::runtime_error("the piece is bad");
    };
    EXPECT_THROW(share_out(workers, {1000, 1, threads}, fail_at_once), std::runtime_error);
    EXPECT_LE(calls, threads) << "each thread ends with the block it has";
    EXPECT_TRUE(share_out(workers, {1000, 1, threads}, [](int, int, int) { return true; }));
  }
}

TEST(Sharing, NoticesACancelledCallOnAnyThread) {
  Workers workers;
  for (const int threads : {1, 2, 4}) {
    const StopCheck check([](const void*) { return true; }, nullptr);
    EXPECT_THROW(share_out(workers, {1000, 1, threads}, [](int, int, int) { return true; }),
                 Stopped);
  }
}

}  // namespace
}  // namespace weft
