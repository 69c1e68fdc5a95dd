// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <future>
#include <optional>
#include <vector>

#include "outlet.hpp"
#include "stream_fixture.hpp"

namespace weft::stream {
namespace {

using asio::ip::tcp;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A TCP reader that gives up after a while.
class Connection {
 public:
  explicit Connection(const std::string& port) : stream_("127.0.0.1", port) {
    stream_.expires_after(kPatience);
  }

  bool is_open() { return static_cast<bool>(stream_); }
  std::string line() {
    std::string text;
    std::getline(stream_, text);
    return text;
  }
  /// The number of the next frame in the format `packed`; nothing at the end.
  std::optional<std::uint64_t> packed_frame() {
    std::array<char, 56> header{};
    if (!stream_.read(header.data(), header.size())) return std::nullopt;
    std::uint32_t size = 0;
    std::uint64_t frame = 0;
    std::memcpy(&size, header.data() + 8, sizeof size);
    std::memcpy(&frame, header.data() + 16, sizeof frame);
    EXPECT_EQ(std::string(header.data(), 4), "WEFT");
    std::string rest(size - header.size(), ' ');
    if (!stream_.read(rest.data(), static_cast<std::streamsize>(rest.size()))) return std::nullopt;
    return frame;
  }

 private:
  tcp::iostream stream_;
};

/// Calls whose warnings are kept.
class Logged {
 public:
  Logged() {
    host_.cancelled = [](const weft_call*) { return 0; };
    host_.log = [](const weft_call* call, std::int32_t, const char* text) {
      static_cast<std::vector<std::string>*>(call->context)->emplace_back(text);
    };
    raw_.host = &host_;
    raw_.context = &said_;
  }

  Call call() const { return Call(raw_); }
  const std::vector<std::string>& said() const { return said_; }

 private:
  std::vector<std::string> said_;
  weft_host host_{};
  weft_call raw_{};
};

class StreamReaders : public StreamSink {
 protected:
  std::string port_ = free_port();
  std::string to_ = "tcp://127.0.0.1:" + port_;

  /// The output of the documentation's example for three frames that the sink sends to it.
  std::string read_by_the_example(PluginUnderTest& sink, const std::string& source) const {
    const std::string command = std::string("python3 '") + WEFT_POINTS_READER + "' '" + source +
                                "' --frames 3 > '" + path("printed") + "' 2>&1";
    auto reading = std::async(std::launch::async, [&] { return std::system(command.c_str()); });
    const auto end = std::chrono::steady_clock::now() + kPatience;
    std::uint64_t frame = 0;
    while (reading.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
      if (std::chrono::steady_clock::now() > end) break;
      EXPECT_EQ(write(sink, frame++).status, WEFT_OK);
    }
    sink.process(kFinish, {});  // ends a reader that waits for more
    EXPECT_EQ(reading.get(), 0) << read_file(path("printed"));
    return read_file(path("printed"));
  }
};

TEST_F(StreamReaders, FindThePortTakenByOneSinkOnly) {
  const std::string to = "{to: '" + to_ + "'}";
  PluginUnderTest first("sinks/stream", to);
  ASSERT_EQ(open(first).status, WEFT_OK);
  expect_refused(to, "another program has this port, choose another");
  ASSERT_EQ(first.process(kFinish, {}).status, WEFT_OK);
  PluginUnderTest later("sinks/stream", to);
  EXPECT_EQ(open(later).status, WEFT_OK);
}

TEST_F(StreamReaders, AllGetTheFramesInTheirOrder) {
  PluginUnderTest sink("sinks/stream", "{to: '" + to_ + "'}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  ASSERT_EQ(write(sink, 0).status, WEFT_OK);
  Connection first(port_);
  // A new client receives the newest frame at once.
  EXPECT_THAT(first.line(), StartsWith("{\"frame\":0,"));
  Connection second(port_);
  EXPECT_THAT(second.line(), StartsWith("{\"frame\":0,"));
  for (int frame = 1; frame < 20; ++frame) {
    ASSERT_EQ(write(sink, static_cast<std::uint64_t>(frame)).status, WEFT_OK);
    const std::string one = first.line();
    EXPECT_THAT(one, StartsWith("{\"frame\":" + std::to_string(frame) + ","));
    EXPECT_EQ(second.line(), one);
  }
  ASSERT_EQ(sink.process(kFinish, {}).status, WEFT_OK);
  EXPECT_EQ(first.line(), "");
  EXPECT_FALSE(first.is_open());
}

TEST_F(StreamReaders, ThatStallHoldNothingUpAndGoOnWithTheNewestFrame) {
  use({50, 40, 0.2, 0.15, 40, 30});
  PluginUnderTest sink("sinks/stream", "{to: '" + to_ + "', format: packed}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  ASSERT_EQ(write(sink, 0).status, WEFT_OK);
  Connection stalled(port_), quick(port_);
  ASSERT_EQ(quick.packed_frame(), 0U);
  ASSERT_EQ(stalled.packed_frame(), 0U);
  constexpr std::uint64_t kLast = 600;  // 29 MB: more than the system keeps for a connection
  for (std::uint64_t frame = 1; frame <= kLast; ++frame) {
    ASSERT_EQ(write(sink, frame).status, WEFT_OK);
    ASSERT_EQ(quick.packed_frame(), frame);
  }
  std::uint64_t before = 0, count = 0;
  while (before < kLast) {
    const auto frame = stalled.packed_frame();
    ASSERT_TRUE(frame);
    ASSERT_GT(*frame, before);
    before = *frame;
    ++count;
  }
  EXPECT_LT(count, kLast);
  EXPECT_EQ(sink.process(kFinish, {}).status, WEFT_OK);
}

TEST_F(StreamReaders, AreSpokenOfWhenTheyMissFramesAndWhenTheyGo) {
  const auto address = parse_address(to_);
  ASSERT_TRUE(address) << address.error().message;
  auto outlet = listen_at(*address, to_);
  ASSERT_TRUE(outlet) << outlet.error().message;
  const Logged calls;
  const std::string message(100'000, 'x');
  const auto send_until_it_says = [&](const std::string& words) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
      ASSERT_TRUE((*outlet)->send(message, calls.call()));
      if (!calls.said().empty() && calls.said().back() == words) return;
    }
    FAIL() << "it does not say: " << words;
  };
  {
    Connection stalled(port_);
    send_until_it_says("a reader is slower than the frames and misses some; nothing waits for it");
  }
  send_until_it_says("a reader went away");
}

TEST_F(StreamReaders, ThatTakeNothingDoNotKeepTheRunFromEnding) {
  use({50, 40, 0.2, 0.15, 40, 30});
  PluginUnderTest sink("sinks/stream", "{to: '" + to_ + "', format: packed}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  ASSERT_EQ(write(sink, 0).status, WEFT_OK);
  Connection stalled(port_);
  ASSERT_EQ(stalled.packed_frame(), 0U);
  for (std::uint64_t frame = 1; frame <= 600; ++frame) write(sink, frame);
  EXPECT_EQ(sink.process(kFinish, {}).status, WEFT_OK);
}

TEST_F(StreamReaders, MayComeAndGo) {
  PluginUnderTest sink("sinks/stream", "{to: '" + to_ + "'}");
  ASSERT_EQ(open(sink).status, WEFT_OK);
  ASSERT_EQ(write(sink, 0).status, WEFT_OK);
  Connection stays(port_);
  EXPECT_THAT(stays.line(), HasSubstr("\"frame\":0,"));
  for (std::uint64_t frame = 1; frame < 30; ++frame) {
    EXPECT_THAT(Connection(port_).line(), HasSubstr("\"frame\":"));
    ASSERT_EQ(write(sink, frame).status, WEFT_OK);
    EXPECT_THAT(stays.line(), HasSubstr("\"frame\":" + std::to_string(frame) + ","));
  }
}

TEST_F(StreamReaders, OfTheDocumentationUnderstandBothFormatsOverTcpAndUdp) {
  shape_.covariance_m2 = Array<double>({4, 3, 3}, 0.0);
  for (std::int64_t v = 0; v < 4; ++v) {
    for (const int diagonal : {0, 4, 8}) shape_.covariance_m2.row(v)[diagonal] = 3e-6;
  }
  for (const std::string protocol : {"tcp", "udp"}) {
    for (const std::string format : {"json_lines", "packed"}) {
      const std::string to = protocol + "://127.0.0.1:" + free_port();
      PluginUnderTest sink("sinks/stream", "{to: '" + to + "', format: " + format + "}");
      ASSERT_EQ(open(sink).status, WEFT_OK);
      const std::string printed = read_by_the_example(sink, to);
      EXPECT_THAT(printed, ::testing::MatchesRegex(
                               "(frame [0-9]+  [0-9.]+ s  estimated  confidence 1.00  4 points "
                               "around .0.5000, 0.5000, 0.5000. m \\+- 3.00 mm\n)+"))
          << to << " " << format;
      EXPECT_EQ(std::count(printed.begin(), printed.end(), '\n'), 3) << to << " " << format;
    }
  }
}

}  // namespace
}  // namespace weft::stream
