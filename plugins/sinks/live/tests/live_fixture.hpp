// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>
#include <weft/core/rng.hpp>
#include <weft/testing/synthetic.hpp>

#include "messages.hpp"
#include "server.hpp"
#include "viewer.hpp"

namespace weft::live {

using nlohmann::json;

/// The response of the server to these bytes, until it closes.
inline std::string answer_to(std::uint16_t port, const std::string& bytes) {
  asio::io_context context;
  beast::tcp_stream stream(context);
  stream.expires_after(kPatience);
  stream.socket().connect({asio::ip::address_v4::loopback(), port});
  asio::write(stream.socket(), asio::buffer(bytes));
  std::string answer;
  complete(context,
           [&](auto done) { asio::async_read(stream, asio::dynamic_buffer(answer), done); });
  return answer;
}

inline std::string request_for(const std::string& target, std::uint16_t port,
                               const std::string& more = "") {
  return "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + more +
         "\r\n";
}

inline std::string status_of(const std::string& answer) {
  return answer.size() > 12 ? answer.substr(9, 3) : "none";
}

inline std::string content_of(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == answer.npos ? "" : answer.substr(end + 4);
}

/// Waits until it holds; what it waits for comes without a further step of the test.
template <class Holds>
void wait_until(Holds holds) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!holds()) {
    ASSERT_LT(std::chrono::steady_clock::now(), end) << "it never comes";
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

inline std::ptrdiff_t thread_count() {
  const std::filesystem::directory_iterator threads("/proc/self/task");
  return std::distance(begin(threads), end(threads));
}

/// The server without a run: tests put in what a run would.
class LiveServer : public ::testing::Test {
 protected:
  /// The server does not notify clients of a run without frames, unless the limits require it.
  static Limits patient() {
    Limits limits;
    limits.still = kPatience;
    return limits;
  }

  void start(const std::string& token = "", const std::string& origin = "",
             Limits limits = patient()) {
    LiveSetup setup{AccessPolicy(asio::ip::address_v4::loopback(), token, origin),
                    {},
                    camera_,
                    {},
                    scene_,
                    limits};
    for (std::int64_t f = 0; f < templ_.faces.rows(); ++f) {
      for (std::int64_t i = 0; i < 3; ++i) setup.faces.push_back(templ_.faces(f, i));
    }
    auto started =
        start_server({asio::ip::address_v4::loopback(), 0}, std::move(setup), run_channel_);
    ASSERT_TRUE(started) << started.error().message;
    server_ = *std::move(started);
    port_ = server_->port();
  }

  std::string get(const std::string& target, const std::string& more = "") const {
    return answer_to(port_, request_for(target, port_, more));
  }

  /// Returns when the server has read all messages that the viewer has sent so far.
  void let_server_read(Viewer& viewer) {
    viewer.say(R"({"type":"change_request","number":0,"text":"step"})");
    wait_until([&] { return !run_channel_.take_change_requests().empty(); });
  }

  /// A frame of four vertices, and of pixels that all differ with `noise`.
  static FrameCopy frame(std::uint64_t number, int width_px = 40, int height_px = 30,
                         bool noise = false) {
    FrameCopy made;
    made.frame = number;
    made.time_s = 0.25 * static_cast<double>(number);
    made.taken_ns = 2'500'000'000 + number;
    made.pixels = Array<std::uint8_t>({height_px, width_px}, 100);
    Rng rng(number + 1);
    for (std::int64_t i = 0; noise && i < made.pixels.size(); ++i) {
      made.pixels.data()[i] = static_cast<std::uint8_t>(rng.next_u32() & 0xFFU);
    }
    made.vertices_m = {0.0F, 0.0F, 0.5F, 0.2F, 0.0F, 0.5F, 0.0F, 0.15F, 0.5F, 0.2F, 0.15F, 0.5F};
    made.visible = {1, 1, 0, 1};
    made.state = ShapeState::estimated;
    made.report = "{\"frame\":" + std::to_string(number) + ",\"state\":\"estimated\"}";
    return made;
  }

  Template templ_ = testing::make_template({2, 2, 0.2, 0.15, 40, 30});
  Camera camera_ = testing::make_camera();
  std::string scene_ = scene_members(templ_, camera_);
  RunChannel run_channel_;
  std::unique_ptr<Server> server_;
  std::uint16_t port_ = 0;
};

}  // namespace weft::live
