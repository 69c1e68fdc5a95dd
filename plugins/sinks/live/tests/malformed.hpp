// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/read_until.hpp>

#include "live_fixture.hpp"

namespace weft::live {

/// The bytes that a client sends: at first, and after the first response.
struct Malformed {
  std::string first, then;
};

/// Requests, mostly malformed.
class MalformedRequests {
 public:
  MalformedRequests(std::uint64_t seed, std::uint16_t port) : rng_(seed), port_(port) {}

  Malformed next() {
    if (rng_.below(3) == 0) return {upgrade(), mutated(frames())};
    std::string bytes = any_of({"", "GET ", page(), page(), upgrade(), lines()});
    if (bytes.empty()) return {random_bytes(rng_.below(600)), ""};
    return {mutated(std::move(bytes)), ""};
  }

 private:
  std::string any_of(const std::vector<std::string>& choices) {
    return choices[rng_.below(static_cast<std::uint32_t>(choices.size()))];
  }

  std::string page() {
    const std::string target =
        any_of({"/", "/live.js", "/ws", "/frames.jsonl", "*", "//", "/?token=%00"});
    const std::string more =
        any_of({"", "Origin: null\r\n", "Content-Length: 18446744073709551615\r\n",
                "Transfer-Encoding: chunked, chunked\r\n", "Host:\r\n"});
    return request_for(target, port_, more);
  }
  std::string lines() { return request_for("/frames.jsonl", port_); }
  std::string upgrade() {
    return request_for("/ws", port_,
                       "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                       "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\nSec-WebSocket-Protocol: " +
                           any_of({"weft.live.1", "foxglove.websocket.v1"}) + "\r\n");
  }

  /// Possible messages of a client after the handshake, as frames with a mask of zeros.
  std::string frames() {
    std::string all;
    for (std::uint32_t i = rng_.below(9); i > 0; --i) {
      const std::string text = any_of(
          {R"({"type":"ready"})", R"({"type":"change_request","number":1,"text":"step"})", "[[[[",
           R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})", "", "\xFF"});
      all += any_of({"\x81", "\x82", "\x88", "\x89", "\x01", std::string(1, '\0')});
      all += static_cast<char>(0x80U | static_cast<unsigned>(text.size()));
      all += std::string(4, '\0') + text;
    }
    return all;
  }

  std::string random_bytes(std::uint32_t count) {
    std::string bytes;
    for (; count > 0; --count) bytes += static_cast<char>(rng_.below(256));
    return bytes;
  }

  std::string mutated(std::string bytes) {
    for (std::uint32_t i = rng_.below(4); i > 0; --i) mutate(bytes);
    return bytes;
  }

  void mutate(std::string& bytes) {
    if (bytes.empty()) return;
    const auto size = static_cast<std::uint32_t>(bytes.size());
    const std::size_t at = rng_.below(size);
    switch (rng_.below(6)) {
      case 0:
        bytes[at] = static_cast<char>(rng_.below(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << rng_.below(8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(at, random_bytes(rng_.below(20)));
        break;
      case 4:
        bytes.erase(at, rng_.below(20));
        break;
      default:
        bytes.insert(at, bytes.substr(rng_.below(size), rng_.below(400)));
    }
  }

  Rng rng_;
  std::uint16_t port_;
};

/// Each number has a separate address on this machine, because one address alone runs out of ports.
inline void send_malformed(std::uint16_t port, const Malformed& sent, std::uint64_t number) {
  asio::io_context context;
  tcp::socket socket(context, tcp::v4());
  const auto last = static_cast<std::uint32_t>(2 + number % 250);
  socket.bind({asio::ip::address_v4(0x7F000000U + last), 0});
  socket.connect({asio::ip::address_v4::loopback(), port});
  error_code code;
  std::string answer;
  asio::write(socket, asio::buffer(sent.first), code);
  if (!code && !sent.then.empty()) {
    asio::read_until(socket, asio::dynamic_buffer(answer), "\r\n\r\n", code);
    if (!code) asio::write(socket, asio::buffer(sent.then), code);
  }
  if (!code) socket.shutdown(tcp::socket::shutdown_send, code);
  if (!code) asio::read(socket, asio::dynamic_buffer(answer), code);
}

class LiveMalformed : public LiveServer {
 protected:
  /// The server survives any bytes, and releases all clients that sent them.
  void survive(int count) {
    constexpr std::uint64_t kSeed = 20'251'127;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    RecordProperty("seed", std::to_string(kSeed));
    start();
    MalformedRequests requests(kSeed, port_);
    for (int i = 0; i < count; ++i) {
      const auto number = static_cast<std::uint64_t>(i);
      if (i % 16 == 0) run_channel_.put_frame(frame(number));
      run_channel_.take_change_requests();
      send_malformed(port_, requests.next(), number);
    }
    wait_until([&] { return !run_channel_.is_watched() && !run_channel_.is_read(); });
    EXPECT_EQ(status_of(get("/")), "200");
    Viewer viewer(port_);
    EXPECT_EQ(viewer.text()["type"], "hello");
    server_->finish();
  }
};

}  // namespace weft::live
