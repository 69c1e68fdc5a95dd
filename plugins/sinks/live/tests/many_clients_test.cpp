// SPDX-License-Identifier: Apache-2.0
#include <malloc.h>
#include <sys/resource.h>

#include <deque>

#include "live_fixture.hpp"

namespace weft::live {
namespace {

using ::testing::HasSubstr;

using LiveClients = LiveServer;
using Crowd = std::vector<std::unique_ptr<Viewer>>;

[[maybe_unused]] std::size_t bytes_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

Crowd viewers_at(std::uint16_t port, int count) {
  Crowd crowd;
  for (int i = 0; i < count; ++i) {
    crowd.push_back(std::make_unique<Viewer>(port));
    EXPECT_TRUE(crowd.back()->is_open());
    EXPECT_EQ(crowd.back()->text()["type"], "hello");
  }
  return crowd;
}

TEST_F(LiveClients, ThatStallHoldNothingUpAndKeepNoFrames) {
  Limits limits = patient();
  limits.write = limits.silence = kPatience;  // however slow the machine: none is let go
  start("", "", limits);
  Crowd stalled = viewers_at(port_, 49);
  Viewer quick(port_);
  quick.text();
  [[maybe_unused]] std::size_t before = 0;
  constexpr std::uint64_t kLast = 1'000;
  for (std::uint64_t number = 1; number <= kLast; ++number) {
    run_channel_.put_frame(frame(number, 160, 120, true));
    quick.ready();
    ASSERT_EQ(quick.frame().head["frame"], number);
    if (number % 20 == 0) {
      for (const auto& viewer : stalled) viewer->ready();
    }
#if !defined(WEFT_SANITIZED)
    // From the first tenth on all clients have what they may keep.
    if (number == kLast / 10) before = bytes_in_use();
#endif
  }
#if !defined(WEFT_SANITIZED)
  // Each of 900 frames has 19 kB of pixels and as many of JPEG.
  EXPECT_LT(bytes_in_use(), before + 4'000'000);
#endif
  // They get what was sent to them, in order, and then the newest.
  for (const auto& viewer : stalled) {
    std::uint64_t last = 0;
    while (last < kLast) {
      const auto number = viewer->frame().head["frame"].get<std::uint64_t>();
      ASSERT_GT(number, last);
      last = number;
      if (last < kLast) viewer->ready();
    }
  }
}

TEST_F(LiveClients, MayComeStallAndGo) {
  start();
  for (int round = 0; round < 4; ++round) {
    Crowd crowd = viewers_at(port_, 50);
    run_channel_.put_frame(frame(static_cast<std::uint64_t>(round), 320, 240, true));
    for (std::size_t i = 0; i < crowd.size(); i += 2) crowd[i]->ready();
    crowd.erase(crowd.begin() + 10, crowd.end());
    for (const auto& viewer : crowd) viewer->ready();
    EXPECT_EQ(crowd[1]->frame().head["frame"], round);
  }
  wait_until([&] { return !run_channel_.is_watched(); });
  EXPECT_TRUE(Viewer(port_).is_open());
}

TEST_F(LiveClients, BeyondTheMostAreTurnedAwayUntilOneGoes) {
  Limits limits = patient();
  limits.clients = 3;
  start("", "", limits);
  Crowd crowd = viewers_at(port_, 3);
  const std::string answer = get("/");
  EXPECT_EQ(status_of(answer), "503");
  EXPECT_THAT(content_of(answer), HasSubstr("as many clients as it takes"));
  crowd.pop_back();
  wait_until([&] { return status_of(get("/")) == "200"; });
}

/// Connections whose requests are never complete.
class HalfOpen {
 public:
  HalfOpen(std::uint16_t port, int count, const std::string& begin) {
    rlimit files{};
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_NOFILE, &files);
    for (int i = 0; i < count; ++i) {
      tcp::socket& socket = sockets_.emplace_back(context_);
      socket.connect({asio::ip::address_v4::loopback(), port});
      error_code ignored;  // it may be closed already, in favour of a later one
      asio::write(socket, asio::buffer(begin), ignored);
    }
  }
  /// Until the server closes it.
  std::string answer_to_first() {
    std::string answer;
    complete(context_, [&](auto done) {
      asio::async_read(sockets_.front(), asio::dynamic_buffer(answer), done);
    });
    return answer;
  }

 private:
  asio::io_context context_;
  std::deque<tcp::socket> sockets_;
};

TEST_F(LiveClients, WithTheTokenGetInThroughHalfOpenConnections) {
  const std::string token = "0123456789abcdef", target = "/ws?token=" + token;
  for (const int count : {140, 1'000}) {
    for (const std::string begin :
         {"", "GET /ws?token=0123", "GET /live.js HTTP/1.1\r\nHost: 127"}) {
      Limits limits = patient();
      limits.head = limits.request = kPatience;  // time alone does not make room
      start(token, "", limits);
      HalfOpen crowd(port_, count, begin);
      Viewer viewer(port_, kLiveProtocol, target);
      ASSERT_TRUE(viewer.is_open()) << count << " of '" << begin << "'";
      EXPECT_EQ(viewer.text()["type"], "hello");
      EXPECT_EQ(status_of(get("/?token=" + token)), "200");
      // The oldest one made room.
      EXPECT_EQ(crowd.answer_to_first(), "");
    }
  }
}

TEST_F(LiveClients, WithTheTokenGetInThroughClientsWithAWrongOne) {
  Limits limits = patient();
  limits.request = kPatience;
  start("0123456789abcdef", "", limits);
  // Each is refused, and keeps its connection.
  const HalfOpen crowd(port_, 200, request_for("/?token=wrong", port_));
  const HalfOpen others(port_, 200, request_for("/live.js", port_));
  Viewer viewer(port_, kLiveProtocol, "/ws?token=0123456789abcdef");
  ASSERT_TRUE(viewer.is_open());
  EXPECT_EQ(viewer.text()["type"], "hello");
}

TEST_F(LiveClients, ThatTakeNothingAreLetGo) {
  Limits limits = patient();
  limits.write = std::chrono::milliseconds(100);
  start("", "", limits);
  Viewer viewer(port_);
  viewer.text();
  // More than the system keeps for a connection.
  for (std::uint64_t number = 0; run_channel_.is_watched() && number < 2'000; ++number) {
    FrameCopy large = frame(number);
    large.vertices_m.assign(3'000'000, 0.5F);
    run_channel_.put_frame(large);
    error_code ignored;
    asio::write(viewer.connection(), asio::buffer("\x81\x90\0\0\0\0{\"type\":\"ready\"}", 22),
                ignored);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_FALSE(run_channel_.is_watched());
}

TEST_F(LiveClients, ThatAnswerNothingAreLetGo) {
  Limits limits = patient();
  limits.silence = std::chrono::milliseconds(100);
  start("", "", limits);
  Viewer dead(port_);  // it answers only while it reads
  ASSERT_TRUE(dead.is_open());
  wait_until([&] { return !run_channel_.is_watched(); });
}

TEST_F(LiveClients, DoNotKeepTheRunFromEnding) {
  start();
  Crowd stalled = viewers_at(port_, 20);
  asio::io_context context;
  tcp::socket mute(context);
  mute.connect({asio::ip::address_v4::loopback(), port_});
  const auto begin = std::chrono::steady_clock::now();
  server_->finish();
  const auto took = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(took, std::chrono::seconds(5)) << "nothing else ends them before 10 s";
}

TEST_F(LiveClients, LeaveNoThreadBehind) {
  const auto before = thread_count();
  for (int round = 0; round < 3; ++round) {
    start();
    Viewer viewer(port_);
    viewer.text();
    if (round > 0) server_->finish();
    server_.reset();
    wait_until([&] { return thread_count() <= before; });
  }
}

}  // namespace
}  // namespace weft::live
