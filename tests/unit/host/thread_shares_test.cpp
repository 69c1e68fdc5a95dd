// SPDX-License-Identifier: Apache-2.0
#include "host/calling/thread_shares.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace weft::host {
namespace {

TEST(ThreadShares, ACallAloneGetsAllThreads) {
  ThreadShares shares;
  shares.divide(6, 2);
  for (int call = 0; call < 3; ++call) EXPECT_EQ(ThreadShares::Loan(shares).threads(), 6);
}

TEST(ThreadShares, ACallBesideOthersGetsWhatTheyLeave) {
  ThreadShares shares;
  shares.divide(6, 2);
  std::optional<ThreadShares::Loan> first(std::in_place, shares);
  const ThreadShares::Loan second(shares);
  EXPECT_EQ(second.threads(), 3);  // all have a caller: an equal share
  first.reset();
  EXPECT_EQ(ThreadShares::Loan(shares).threads(), 3);
}

TEST(ThreadShares, EveryCallGetsAThread) {
  ThreadShares shares;
  shares.divide(2, 4);
  const ThreadShares::Loan first(shares), second(shares), third(shares);
  EXPECT_EQ(first.threads(), 2);
  EXPECT_EQ(second.threads(), 1);
  EXPECT_EQ(third.threads(), 1);
  EXPECT_EQ(shares.equal(), 1);
}

}  // namespace
}  // namespace weft::host
