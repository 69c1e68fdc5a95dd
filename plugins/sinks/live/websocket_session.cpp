// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <utility>

#include "sessions.hpp"

namespace weft::live {
namespace {

namespace websocket = boost::beast::websocket;

class WebSocketSession final : public Client,
                               public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(beast::tcp_stream stream, Hub& hub, std::unique_ptr<Protocol> protocol,
                   ClientId id)
      : hub_(hub),
        place_(hub, *this),
        id_(id),
        protocol_(std::move(protocol)),
        socket_(std::move(stream)),
        patience_(socket_.get_executor()) {
    hub.run_channel.count_viewers(1);
  }
  ~WebSocketSession() override {
    hub_.run_channel.leave(id_);
    hub_.run_channel.count_viewers(-1);
  }

  void run(const Request& request, std::string_view subprotocol) {
    const Limits& limits = hub_.setup.limits;
    beast::get_lowest_layer(socket_).expires_never();  // it has separate timeouts
    socket_.set_option(websocket::stream_base::timeout{limits.request, limits.silence, true});
    socket_.set_option(websocket::stream_base::decorator(
        [name = std::string(subprotocol)](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, name);
        }));
    socket_.read_message_max(limits.message_bytes);
    socket_.auto_fragment(false);
    socket_.async_accept(request, [self = shared_from_this()](const error_code& code) {
      if (code) return self->drop();
      self->is_open_ = true;
      self->read();
      self->send();
    });
  }

  void look() override { send(); }

  void take_answer(const ClientAnswer& answer) override {
    if (answer.client != id_) return;
    protocol_->take_answer(answer);
    send();
  }

  void end(bool at_once) override {
    is_ending_ = true;
    is_hurried_ = at_once;
    if (!is_open_) return drop();
    send();
  }

 private:
  void read() {
    if (is_reading_ || is_closing_ || is_gone_ || !protocol_->takes_more()) return;
    is_reading_ = true;
    socket_.async_read(buffer_, [self = shared_from_this()](const error_code& code, std::size_t) {
      self->is_reading_ = false;
      if (code) return self->drop();
      self->receive();
    });
  }

  void receive() {
    const auto bytes = buffer_.cdata();
    const std::string reason = protocol_->receive(
        {static_cast<const char*>(bytes.data()), bytes.size()}, socket_.got_text());
    buffer_.consume(buffer_.size());
    if (!reason.empty()) return close(websocket::close_code::policy_error, reason);
    send();
    read();
  }

  void send() {
    if (!socket_.is_open() || is_writing_ || is_closing_ || is_gone_) return;
    if (auto next = protocol_->next()) return write(*std::move(next));
    if (is_ending_ && (is_hurried_ || protocol_->is_served())) {
      close(websocket::close_code::going_away, "the run has ended");
    }
  }

  void write(Outgoing message) {
    sending_ = std::move(message);
    is_writing_ = true;
    patience_.expires_after(hub_.setup.limits.write);
    patience_.async_wait([self = weak_from_this()](const error_code& code) {
      const auto session = self.lock();
      if (code || !session || !session->is_writing_) return;
      if (session->patience_.expiry() <= asio::steady_timer::clock_type::now()) session->drop();
    });
    socket_.text(sending_.is_text);
    const std::array<asio::const_buffer, 2> buffers{asio::buffer(sending_.head),
                                                    asio::buffer(*sending_.body)};
    socket_.async_write(buffers, [self = shared_from_this()](const error_code& code, std::size_t) {
      self->is_writing_ = false;
      self->patience_.cancel();
      self->sending_ = {};
      if (code) return self->drop();
      if (self->is_closing_) return self->say_why();
      self->read();
      self->send();
    });
  }

  void close(websocket::close_code code, std::string_view reason) {
    if (std::exchange(is_closing_, true)) return;
    constexpr std::size_t kMostReason = 120;  // the protocol has room for 123 bytes
    reason_ = {code, beast::string_view(reason.data(), std::min(reason.size(), kMostReason))};
    if (!is_writing_) say_why();
  }

  /// Between messages alone, and where the client does not close just now: Beast wants it so.
  void say_why() {
    if (!socket_.is_open()) return;  // operations in progress end with an error
    socket_.async_close(reason_, [self = shared_from_this()](const error_code&) { self->drop(); });
  }

  void drop() {
    if (std::exchange(is_gone_, true)) return;
    patience_.cancel();
    beast::get_lowest_layer(socket_).close();
  }

  Hub& hub_;
  Place place_;
  ClientId id_;
  std::unique_ptr<Protocol> protocol_;
  websocket::stream<beast::tcp_stream, false> socket_;
  asio::steady_timer patience_;
  beast::flat_buffer buffer_;
  Outgoing sending_;
  websocket::close_reason reason_;
  bool is_open_ = false, is_reading_ = false, is_writing_ = false;
  bool is_ending_ = false, is_hurried_ = false, is_closing_ = false, is_gone_ = false;
};

}  // namespace

void serve_websocket(beast::tcp_stream stream, Hub& hub, const Request& request,
                     std::string_view subprotocol) {
  const ClientId id = ++hub.last_client;
  auto protocol = subprotocol == kLiveProtocol ? speak_live(hub, id) : speak_foxglove(hub);
  std::make_shared<WebSocketSession>(std::move(stream), hub, std::move(protocol), id)
      ->run(request, subprotocol);
}

}  // namespace weft::live
