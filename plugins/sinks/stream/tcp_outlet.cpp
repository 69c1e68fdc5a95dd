// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <future>
#include <list>
#include <thread>

#include "common/network_address.hpp"
#include "outlet.hpp"

namespace weft::stream {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Message = std::shared_ptr<const std::string>;

/// One program that reads.
struct Reader {
  explicit Reader(tcp::socket connected) : socket(std::move(connected)) {}

  tcp::socket socket;
  Message sending, next;  ///< the second one waits for the first; null for none
};

/// A separate thread serves the readers: it alone uses all members but the two flags.
class TcpOutlet final : public Outlet {
 public:
  TcpOutlet() : acceptor_(context_), work_(asio::make_work_guard(context_)) {}
  ~TcpOutlet() override { stop(); }
  TcpOutlet(const TcpOutlet&) = delete;
  TcpOutlet& operator=(const TcpOutlet&) = delete;

  error_code listen(const tcp::endpoint& endpoint) {
    error_code code;
    acceptor_.open(endpoint.protocol(), code);
    // Else the port of a run that has just ended is taken for a minute.
    if (!code) acceptor_.set_option(tcp::acceptor::reuse_address(true), code);
    if (!code) acceptor_.bind(endpoint, code);
    if (!code) acceptor_.listen(tcp::acceptor::max_listen_connections, code);
    if (code) return code;
    accept();
    std::promise<void> ended;
    ended_ = ended.get_future();
    thread_ = std::thread([this, promise = std::move(ended)]() mutable {
      context_.run();
      promise.set_value();
    });
    return code;
  }

  Result<void> send(std::string text, const Call& call) override {
    auto message = std::make_shared<const std::string>(std::move(text));
    asio::post(context_, [this, message] { hand_out(message); });
    if (missed_.exchange(false)) {
      call.log_warning("a reader is slower than the frames and misses some; nothing waits for it");
    }
    if (gone_.exchange(false)) call.log_warning("a reader went away");
    return {};
  }

  void finish() override {
    constexpr std::chrono::milliseconds kMost(500);
    if (!thread_.joinable()) return;
    asio::post(context_, [this] { acceptor_.close(); });
    work_.reset();  // the thread ends when the last message is through
    ended_.wait_for(kMost);
    stop();
  }

 private:
  void stop() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
    readers_.clear();
  }

  void accept() {
    is_accepting_ = true;
    acceptor_.async_accept([this](const error_code& code, tcp::socket socket) {
      is_accepting_ = false;
      if (code) return;  // too many open files, or closed: the next message tries again
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      readers_.emplace_back(std::move(socket));
      if (newest_) offer(std::prev(readers_.end()), newest_);
      accept();
    });
  }

  void hand_out(const Message& message) {
    newest_ = message;
    if (!is_accepting_ && acceptor_.is_open()) accept();
    for (auto reader = readers_.begin(); reader != readers_.end(); ++reader) {
      offer(reader, message);
    }
  }

  void offer(std::list<Reader>::iterator reader, const Message& message) {
    if (!reader->sending) return write(reader, message);
    if (reader->next) missed_ = true;
    reader->next = message;
  }

  void write(std::list<Reader>::iterator reader, const Message& message) {
    reader->sending = message;
    asio::async_write(reader->socket, asio::buffer(*message),
                      [this, reader](const error_code& code, std::size_t) {
                        if (code) {
                          gone_ = true;
                          readers_.erase(reader);
                          return;
                        }
                        reader->sending.reset();
                        if (reader->next) write(reader, std::exchange(reader->next, nullptr));
                      });
  }

  asio::io_context context_{1};
  tcp::acceptor acceptor_;
  asio::executor_work_guard<asio::io_context::executor_type> work_;
  bool is_accepting_ = false;
  std::list<Reader> readers_;
  Message newest_;
  std::atomic<bool> missed_ = false, gone_ = false;
  std::future<void> ended_;
  std::thread thread_;
};

}  // namespace

MadeOutlet listen_at(const Address& address, const std::string& name) {
  auto outlet = std::make_unique<TcpOutlet>();
  if (const auto code = outlet->listen({address.host, address.port})) {
    return network::address_error(name, code);
  }
  return std::unique_ptr<Outlet>(std::move(outlet));
}

}  // namespace weft::stream
