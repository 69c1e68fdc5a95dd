// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <thread>
#include <weft/core/stop_check.hpp>

namespace weft {
namespace {

struct Host {
  int asked = 0, patience = 1'000'000;

  static bool cancelled(const void* whom) {
    auto& host = *static_cast<Host*>(const_cast<void*>(whom));
    return ++host.asked > host.patience;
  }
};

TEST(StopCheck, AsksOnceForSoManyPasses) {
  Host host;
  const StopCheck check(Host::cancelled, &host);
  worked(StopCheck::kPassesPerAsk - 1);
  EXPECT_EQ(host.asked, 0);
  worked();
  EXPECT_EQ(host.asked, 1);
  for (int i = 0; i < 10 * 1024; ++i) worked_in_loop(i, 100);
  EXPECT_EQ(host.asked, 11);
  ask_to_go_on();
  EXPECT_EQ(host.asked, 12);
}

TEST(StopCheck, ThrowsWhereTheCallIsCancelled) {
  Host host{0, 3};
  const StopCheck check(Host::cancelled, &host);
  int passes = 0;
  EXPECT_THROW(
      {
        for (;; ++passes) ask_to_go_on();
      },
      Stopped);
  EXPECT_EQ(passes, 3);
}

TEST(StopCheck, AsksTheHostOfTheInnermostCallOfItsThread) {
  worked(10 * StopCheck::kPassesPerAsk);  // no host is called outside of calls
  Host outer, inner;
  const StopCheck check(Host::cancelled, &outer);
  {
    const StopCheck nested(Host::cancelled, &inner);
    ask_to_go_on();
  }
  std::thread([] { ask_to_go_on(); }).join();
  EXPECT_EQ(inner.asked, 1);
  EXPECT_EQ(outer.asked, 0);
  ask_to_go_on();
  EXPECT_EQ(outer.asked, 1);
}

}  // namespace
}  // namespace weft
