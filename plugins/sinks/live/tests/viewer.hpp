// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sessions.hpp"

namespace weft::live {

namespace websocket = boost::beast::websocket;

constexpr std::chrono::seconds kPatience(120);

/// Runs one asynchronous operation to its end.
template <class Start>
error_code complete(asio::io_context& context, Start start) {
  std::optional<error_code> result;
  start([&result](const error_code& code, auto&&...) { result = code; });
  context.restart();
  while (!result && context.run_one() > 0) continue;
  return result.value_or(asio::error::operation_aborted);
}

/// A frame message in its parts.
struct Decoded {
  nlohmann::json head;
  std::map<std::string, std::string> parts;
};

inline std::uint32_t u32_at(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  EXPECT_LE(at + 4, bytes.size());
  if (at + 4 <= bytes.size()) std::memcpy(&number, bytes.data() + at, 4);
  return number;
}

inline Decoded decode(const std::string& bytes) {
  Decoded decoded;
  EXPECT_EQ(u32_at(bytes, 0), 0x314C4657U);
  const std::size_t length = u32_at(bytes, 4);
  std::size_t at = 8 + length;
  decoded.head = nlohmann::json::parse(bytes.substr(8, length));
  for (const auto& part : decoded.head["parts"]) {
    const auto count = part["bytes"].get<std::size_t>();
    EXPECT_EQ(at % 4, 0U);
    EXPECT_LE(at + count, bytes.size());
    decoded.parts[part["name"].get<std::string>()] = bytes.substr(at, count);
    at += (count + 3) / 4 * 4;
  }
  EXPECT_EQ(at, bytes.size());
  return decoded;
}

using Headers = std::vector<std::pair<std::string, std::string>>;

/// A client of the WebSocket that gives up after a while.
class Viewer {
 public:
  struct Message {
    bool is_text;
    std::string bytes;
  };

  explicit Viewer(std::uint16_t port, std::string_view subprotocol = kLiveProtocol,
                  const std::string& target = "/ws", const Headers& headers = {})
      : socket_(context_) {
    beast::get_lowest_layer(socket_).socket().connect({asio::ip::address_v4::loopback(), port});
    socket_.set_option(websocket::stream_base::timeout{kPatience, kPatience, false});
    socket_.set_option(websocket::stream_base::decorator(
        [headers, name = std::string(subprotocol)](websocket::request_type& request) {
          if (!name.empty()) request.set(http::field::sec_websocket_protocol, name);
          for (const auto& [field, value] : headers) request.set(field, value);
        }));
    handshake_ = complete(context_, [&](auto done) {
      socket_.async_handshake(response_, "127.0.0.1:" + std::to_string(port), target, done);
    });
  }

  bool is_open() const { return !handshake_; }
  const websocket::response_type& response() const { return response_; }
  /// Error of the last message that was read.
  error_code error() const { return error_; }
  /// Why the server has closed.
  std::string reason() const {
    return {socket_.reason().reason.data(), socket_.reason().reason.size()};
  }
  std::uint16_t close_code() const { return socket_.reason().code; }

  Message read() {
    beast::flat_buffer buffer;
    error_ = complete(context_, [&](auto done) { socket_.async_read(buffer, done); });
    return {socket_.got_text(), beast::buffers_to_string(buffer.data())};
  }
  nlohmann::json text() {
    const Message message = read();
    EXPECT_FALSE(error_) << error_.message();
    EXPECT_TRUE(message.is_text);
    return nlohmann::json::parse(message.bytes, nullptr, false);
  }
  Decoded frame() {
    const Message message = read();
    EXPECT_FALSE(error_) << error_.message();
    EXPECT_FALSE(message.is_text) << message.bytes;
    return decode(message.bytes);
  }
  void say(const std::string& text, bool is_text = true) {
    socket_.text(is_text);
    complete(context_, [&](auto done) { socket_.async_write(asio::buffer(text), done); });
  }
  void ready() { say(R"({"type":"ready"})"); }
  /// The connection below, for what is no WebSocket.
  tcp::socket& connection() { return beast::get_lowest_layer(socket_).socket(); }

 private:
  asio::io_context context_;
  websocket::stream<beast::tcp_stream> socket_;
  websocket::response_type response_;
  error_code handshake_, error_;
};

}  // namespace weft::live
