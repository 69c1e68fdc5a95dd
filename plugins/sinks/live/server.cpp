// SPDX-License-Identifier: Apache-2.0
#include "server.hpp"

#include <fcntl.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <future>
#include <sstream>
#include <thread>
#include <utility>

#include "sessions.hpp"

namespace weft::live {
namespace {

/// A program that is started beside the run must not keep the port.
void keep_from_children(int descriptor) { fcntl(descriptor, F_SETFD, FD_CLOEXEC); }

/// All that it holds belongs to its thread, once that runs.
class TcpServer final : public Server {
 public:
  TcpServer(LiveSetup setup, RunChannel& run_channel)
      : hub_(std::move(setup), run_channel),
        acceptor_(context_),
        retry_(context_),
        last_moment_(context_),
        stillness_(context_),
        work_(asio::make_work_guard(context_)) {}
  ~TcpServer() override {
    hub_.run_channel.detach();
    stop();
  }
  TcpServer(const TcpServer&) = delete;
  TcpServer& operator=(const TcpServer&) = delete;

  error_code listen(const tcp::endpoint& endpoint) {
    error_code code;
    acceptor_.open(endpoint.protocol(), code);
    if (!code) keep_from_children(acceptor_.native_handle());
    // Else the port of a run that has just ended is taken for a minute.
    if (!code) acceptor_.set_option(tcp::acceptor::reuse_address(true), code);
    if (!code) acceptor_.bind(endpoint, code);
    if (!code) acceptor_.listen(tcp::acceptor::max_listen_connections, code);
    if (code) return code;
    port_ = acceptor_.local_endpoint(code).port();
    accept();
    watch_frames();
    std::promise<void> ended;
    ended_ = ended.get_future();
    thread_ = std::thread([this, promise = std::move(ended)]() mutable {
      serve();
      promise.set_value();
    });
    hub_.run_channel.attach([this] { asio::post(context_, [this] { receive(); }); });
    return code;
  }

  std::uint16_t port() const override { return port_; }

  void finish() override {
    if (!thread_.joinable()) return;
    hub_.run_channel.detach();
    asio::post(context_, [this] { end(); });
    ended_.wait_for(hub_.setup.limits.end);
    stop();
  }

 private:
  void serve() {
    for (;;) {
      try {
        context_.run();
        return;
      } catch (const std::exception&) {
        // Memory was short for one client, whose handler is gone and with it the client.
      }
    }
  }

  void stop() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
    hub_.when_empty = nullptr;
  }

  void accept() {
    acceptor_.async_accept([this](const error_code& code, tcp::socket socket) {
      if (!acceptor_.is_open()) return;
      if (code) return accept_later();
      keep_from_children(socket.native_handle());
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      accept();  // first: memory that is short for this client must not end it for all
      admit(std::move(socket));
    });
  }

  /// There are too many open files, which may pass.
  void accept_later() {
    hub_.drop_oldest_guest();
    constexpr std::chrono::milliseconds kPause(100);
    retry_.expires_after(kPause);
    retry_.async_wait([this](const error_code& code) {
      if (!code && acceptor_.is_open()) accept();
    });
  }

  void admit(tcp::socket socket) {
    // Half-open connections keep no client out.
    if (hub_.guests.size() >= hub_.setup.limits.guests) hub_.drop_oldest_guest();
    serve_request(std::move(socket), hub_);
  }

  void receive() {
    Arrivals arrivals = hub_.run_channel.take();
    if (arrivals.settings) {
      hub_.settings = *std::move(arrivals.settings);
      if (hub_.settings_count == 0) hub_.started_with = hub_.settings;
      ++hub_.settings_count;
    }
    if (arrivals.calibration) {
      hub_.calibration = *std::move(arrivals.calibration);
      ++hub_.calibration_count;
    }
    if (arrivals.is_passed) hub_.newest.reset();
    if (arrivals.frame) {
      hub_.newest = std::make_shared<ShownFrame>(*std::move(arrivals.frame), hub_.setup.style);
      ++hub_.frame_count;
    }
    bool has_news = arrivals.calibration.has_value();
    if (arrivals.is_passed || arrivals.frame) has_news = frames_come() || has_news;
    for (const ClientAnswer& answer : arrivals.answers) {
      if (!answer.pauses) continue;
      hub_.is_paused = *answer.pauses;
      hub_.pause_frame = answer.frame;
      hub_.has_left = answer.client == kServer;
      ++hub_.pause_count;
      has_news = true;
    }
    std::vector<Text> lines;
    for (std::string& line : arrivals.lines) {
      lines.push_back(std::make_shared<const std::string>(std::move(line)));
    }
    for (Client* client : hub_.clients) {
      for (const ClientAnswer& answer : arrivals.answers) client->take_answer(answer);
      for (const Text& line : lines) client->take_line(line);
      if (has_news || arrivals.settings || arrivals.frame) client->look();
    }
  }

  /// Notifies clients when no frame comes, because they cannot distinguish a run that waits from a
  /// slow connection.
  void watch_frames() {
    stillness_.expires_after(hub_.setup.limits.still);
    stillness_.async_wait([this](const error_code& code) {
      const bool is_early = stillness_.expiry() > asio::steady_timer::clock_type::now();
      if (code || is_early || !acceptor_.is_open()) return;
      hub_.is_still = true;
      ++hub_.still_count;
      for (Client* client : hub_.clients) client->look();
    });
  }

  /// True if clients must be notified that frames come again.
  bool frames_come() {
    const bool was_still = std::exchange(hub_.is_still, false);
    if (was_still) ++hub_.still_count;
    watch_frames();
    return was_still;
  }

  /// Clients that are not finished in half of the time are notified at once; the thread ends when
  /// all have gone.
  void end() {
    receive();
    error_code ignored;
    acceptor_.close(ignored);
    retry_.cancel();
    stillness_.cancel();
    work_.reset();
    for (Client* client : hub_.clients) client->end(false);
    if (hub_.clients.empty()) return;
    hub_.when_empty = [this] { last_moment_.cancel(); };
    last_moment_.expires_after(hub_.setup.limits.end / 2);
    last_moment_.async_wait([this](const error_code& code) {
      if (code) return;
      for (Client* client : hub_.clients) client->end(true);
    });
  }

  Hub hub_;  // the clients in the context look into it to their end
  asio::io_context context_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer retry_, last_moment_, stillness_;
  asio::executor_work_guard<asio::io_context::executor_type> work_;
  std::uint16_t port_ = 0;
  std::future<void> ended_;
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<Server>> start_server(const network::Address& address, LiveSetup setup,
                                             RunChannel& run_channel) {
  auto server = std::make_unique<TcpServer>(std::move(setup), run_channel);
  const tcp::endpoint endpoint(address.host, address.port);
  if (const auto code = server->listen(endpoint)) {
    std::ostringstream name;
    name << endpoint;
    return network::address_error(name.str(), code);
  }
  return std::unique_ptr<Server>(std::move(server));
}

}  // namespace weft::live
