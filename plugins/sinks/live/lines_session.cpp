// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/chunk_encode.hpp>
#include <deque>
#include <utility>

#include "sessions.hpp"

namespace weft::live {
namespace {

class LinesSession final : public Client, public std::enable_shared_from_this<LinesSession> {
 public:
  LinesSession(tcp::socket socket, Hub& hub, std::string head)
      : hub_(hub),
        place_(hub, *this),
        socket_(std::move(socket)),
        patience_(socket_.get_executor()),
        head_(std::move(head)) {
    hub.run_channel.count_readers(1);
  }
  ~LinesSession() override { hub_.run_channel.count_readers(-1); }

  void run() {
    watch();
    write(asio::buffer(head_));
  }

  void take_line(const Text& line) override {
    if (is_ending_) return;
    if (lines_.size() == kMostLines) lines_.pop_front();
    lines_.push_back(line);
    send();
  }

  void end(bool at_once) override {
    is_ending_ = true;
    if (at_once) return drop();
    send();
  }

 private:
  static constexpr std::size_t kMostLines = 256;

  /// A client of this kind sends nothing more: the only event is its end.
  void watch() {
    socket_.async_read_some(
        asio::buffer(unread_),
        [self = shared_from_this()](const error_code&, std::size_t) { self->drop(); });
  }

  void send() {
    if (is_writing_ || is_gone_) return;
    if (!lines_.empty()) {
      sending_ = lines_.front();
      lines_.pop_front();
      write(http::make_chunk(asio::buffer(*sending_)));
    } else if (is_ending_ && !is_closed_) {
      is_closed_ = true;
      write(http::make_chunk_last());
    } else if (is_closed_) {
      drop();
    }
  }

  template <class Buffers>
  void write(const Buffers& buffers) {
    is_writing_ = true;
    patience_.expires_after(hub_.setup.limits.write);
    patience_.async_wait([self = weak_from_this()](const error_code& code) {
      const auto session = self.lock();
      if (code || !session || !session->is_writing_) return;
      if (session->patience_.expiry() <= asio::steady_timer::clock_type::now()) session->drop();
    });
    asio::async_write(socket_, buffers,
                      [self = shared_from_this()](const error_code& code, std::size_t) {
                        self->is_writing_ = false;
                        self->patience_.cancel();
                        if (code) return self->drop();
                        self->send();
                      });
  }

  void drop() {
    if (std::exchange(is_gone_, true)) return;
    patience_.cancel();
    error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_both, ignored);
    socket_.close(ignored);
  }

  Hub& hub_;
  Place place_;
  tcp::socket socket_;
  asio::steady_timer patience_;
  std::string head_;
  std::array<char, 256> unread_{};
  std::deque<Text> lines_;
  Text sending_;
  bool is_writing_ = false, is_ending_ = false, is_closed_ = false, is_gone_ = false;
};

}  // namespace

void serve_lines(tcp::socket socket, Hub& hub, std::string head) {
  std::make_shared<LinesSession>(std::move(socket), hub, std::move(head))->run();
}

}  // namespace weft::live
