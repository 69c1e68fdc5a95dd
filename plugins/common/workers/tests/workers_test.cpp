// SPDX-License-Identifier: Apache-2.0
#include "common/workers/workers.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <stdexcept>
#include <weft/core/index.hpp>

namespace weft {
namespace {

TEST(Workers, CallEachWorkerOnceAndWaitForAll) {
  Workers workers;
  for (const int count : {1, 4, 2, 0, 4, 3}) {
    std::vector<std::atomic<int>> calls(4);
    workers.run(count, [&](int worker) { ++calls[to_index(worker)]; });
    for (int worker = 0; worker < 4; ++worker) {
      EXPECT_EQ(calls[to_index(worker)], worker < std::max(count, 1) ? 1 : 0) << count;
    }
  }
}

TEST(Workers, UseTheSameThreadsAgainAndTheCallersFirst) {
  Workers workers;
  std::vector<std::thread::id> first(3), again(3);
  workers.run(3, [&](int worker) { first[to_index(worker)] = std::this_thread::get_id(); });
  workers.run(3, [&](int worker) { again[to_index(worker)] = std::this_thread::get_id(); });
  EXPECT_EQ(first, again);
  EXPECT_EQ(first[0], std::this_thread::get_id());
  EXPECT_EQ(std::set(first.begin(), first.end()).size(), 3U);
}

TEST(Workers, RethrowWhatAJobThrewAndGoOn) {
  Workers workers;
  const auto fail = [](int worker) {
    if (worker > 0) throw std::runtime_error("worker " + std::to_string(worker));
  };
  try {
    workers.run(3, fail);
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "worker 1");
  }
  std::atomic<int> calls = 0;
  workers.run(3, [&](int) { ++calls; });
  EXPECT_EQ(calls, 3);
}

TEST(Workers, ThatNeverRanEndAtOnce) {
  const Workers workers;
  SUCCEED();
}

}  // namespace
}  // namespace weft
