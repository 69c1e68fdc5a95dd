// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "live_fixture.hpp"

namespace weft::live {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kSecret = "0123456789abcdef";

std::string page_part(const std::string& name) {
  std::ifstream stream(std::string(WEFT_LIVE_PAGE) + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

using LiveHttp = LiveServer;

TEST_F(LiveHttp, ServesThePageWithItsScriptAndStyle) {
  start();
  for (const auto& [target, name, type] : {std::tuple("/", "live.html", "text/html"),
                                           std::tuple("/live.js", "live.js", "text/javascript"),
                                           std::tuple("/live.css", "live.css", "text/css")}) {
    const std::string answer = get(target);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n")) << target;
    EXPECT_THAT(answer, HasSubstr(std::string("Content-Type: ") + type)) << target;
    EXPECT_THAT(answer, HasSubstr("Content-Security-Policy: default-src 'none'")) << target;
    EXPECT_EQ(content_of(answer), page_part(name)) << target;
  }
  EXPECT_THAT(content_of(get("/")), HasSubstr("Weft"));
}

TEST_F(LiveHttp, ThePageHasNoScriptOrStyleThatItsPolicyForbids) {
  const std::string page = page_part("live.html");
  EXPECT_THAT(page, Not(HasSubstr(" style=\"")));
  EXPECT_THAT(page, Not(HasSubstr("<style")));
  EXPECT_THAT(page, Not(HasSubstr("<script>")));
}

TEST_F(LiveHttp, SaysWhatThereIsWhereSomethingElseIsAskedFor) {
  start();
  EXPECT_EQ(status_of(get("/favicon.ico")), "404");
  EXPECT_THAT(content_of(get("/../etc/passwd")),
              HasSubstr("There are /, /ws, /frames.jsonl and /cameras.json."));
  EXPECT_EQ(status_of(get("/ws")), "426");
  EXPECT_EQ(status_of(answer_to(port_, "POST / HTTP/1.1\r\nHost: localhost\r\n\r\n")), "405");
  EXPECT_EQ(status_of(answer_to(port_, "DELETE / HTTP/1.1\r\nHost: localhost\r\n\r\n")), "405");
}

TEST_F(LiveHttp, TakesNoBodyAndNoLongHeader) {
  start();
  const std::string start_of_post = "POST / HTTP/1.1\r\nHost: localhost\r\n";
  EXPECT_EQ(status_of(answer_to(port_, start_of_post + "Content-Length: 5\r\n\r\nhello")), "413");
  EXPECT_EQ(
      status_of(answer_to(
          port_, start_of_post + "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n")),
      "413");
  EXPECT_EQ(status_of(get("/", "X: " + std::string(9'000, 'x') + "\r\n")), "431");
  EXPECT_EQ(status_of(get("/" + std::string(40'000, 'x'))), "431");
}

TEST_F(LiveHttp, AnswersToWhatIsNoHttpWithASentence) {
  start();
  for (const std::string text :
       {"hello\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "\x16\x03\x01\x02\r\n\r\n",
        "GET / HTTP/1.1\r\nHost 127.0.0.1\r\n\r\n"}) {
    const std::string answer = answer_to(port_, text);
    EXPECT_EQ(status_of(answer), "400") << text;
    EXPECT_THAT(content_of(answer), StartsWith("This is no request of HTTP 1.1: ")) << text;
  }
  EXPECT_EQ(status_of(get("/")), "200") << "others are served as before";
}

TEST_F(LiveHttp, RefusesOtherNamesAndOtherOrigins) {
  start();
  const auto with_host = [&](const std::string& host) {
    return status_of(answer_to(port_, "GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n"));
  };
  EXPECT_EQ(with_host("localhost:" + std::to_string(port_)), "200");
  EXPECT_EQ(with_host("evil.example"), "403");
  EXPECT_EQ(with_host("localhost\r\nHost: evil.example"), "403");
  EXPECT_EQ(status_of(answer_to(port_, "GET / HTTP/1.0\r\n\r\n")), "403");
  const std::string own = "http://127.0.0.1:" + std::to_string(port_);
  EXPECT_EQ(status_of(get("/frames.jsonl", "Origin: http://evil.example\r\n")), "403");
  EXPECT_EQ(status_of(get("/", "Origin: " + own + "\r\n")), "200");
  EXPECT_EQ(status_of(get("/", "Origin: " + own + "\r\nOrigin: http://evil.example\r\n")), "403");
  const std::string upgrade =
      "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\nSec-WebSocket-Protocol: weft.live.1\r\n";
  EXPECT_EQ(status_of(get("/ws", upgrade + "Origin: http://evil.example\r\n")), "403");
  const Viewer same_origin(port_, kLiveProtocol, "/ws", {{"Origin", own}});
  EXPECT_TRUE(same_origin.is_open());
}

TEST_F(LiveHttp, AsksForTheTokenButForCodeThatHoldsNoSecret) {
  start(kSecret);
  EXPECT_EQ(status_of(get("/")), "401");
  EXPECT_THAT(get("/"), HasSubstr("WWW-Authenticate: Bearer"));
  EXPECT_THAT(content_of(get("/frames.jsonl")), HasSubstr("Send the token of this server"));
  EXPECT_EQ(status_of(get("/nothing")), "401");
  EXPECT_EQ(status_of(get("/?token=wrong")), "401");
  EXPECT_EQ(status_of(get("/?token=" + std::string(kSecret))), "200");
  EXPECT_EQ(status_of(get("/", "Authorization: Bearer " + std::string(kSecret) + "\r\n")), "200");
  EXPECT_EQ(status_of(get("/live.js")), "200");
  EXPECT_EQ(status_of(get("/live.css")), "200");
  EXPECT_FALSE(Viewer(port_).is_open());
  EXPECT_TRUE(Viewer(port_, kLiveProtocol, "/ws?token=" + std::string(kSecret)).is_open());
}

TEST_F(LiveHttp, SendsALineForEachFrameFromNowOn) {
  start();
  run_channel_.put_line("{\"frame\":0}");  // before anybody reads
  asio::io_context context;
  beast::tcp_stream stream(context);
  stream.expires_after(kPatience);
  stream.socket().connect({asio::ip::address_v4::loopback(), port_});
  asio::write(stream.socket(), asio::buffer(request_for("/frames.jsonl", port_)));
  wait_until([&] { return run_channel_.is_read(); });
  for (int frame = 1; frame <= 20; ++frame) {
    run_channel_.put_line("{\"frame\":\n" + std::to_string(frame) + "}");
  }
  server_->finish();
  std::string answer;
  complete(context,
           [&](auto done) { asio::async_read(stream, asio::dynamic_buffer(answer), done); });
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("Transfer-Encoding: chunked"));
  std::string expected;
  for (int frame = 1; frame <= 20; ++frame) {
    const std::string line = "{\"frame\": " + std::to_string(frame) + "}\n";
    expected += (frame < 10 ? "d" : "e") + std::string("\r\n") + line + "\r\n";
  }
  EXPECT_EQ(content_of(answer), expected + "0\r\n\r\n");
}

TEST_F(LiveHttp, LetsGoOfReadersThatSayMoreOrGoAway) {
  start();
  {
    asio::io_context context;
    tcp::socket socket(context);
    socket.connect({asio::ip::address_v4::loopback(), port_});
    asio::write(socket, asio::buffer(request_for("/frames.jsonl", port_)));
    wait_until([&] { return run_channel_.is_read(); });
  }
  wait_until([&] { return !run_channel_.is_read(); });
  EXPECT_THAT(answer_to(port_, request_for("/frames.jsonl", port_) + std::string(5'000, 'x')),
              StartsWith("HTTP/1.1 "));
  wait_until([&] { return !run_channel_.is_read(); });
}

TEST_F(LiveHttp, EndsRequestsThatAreNeverFinished) {
  Limits limits = patient();
  limits.head = std::chrono::milliseconds(50);
  start("", "", limits);
  EXPECT_EQ(answer_to(port_, ""), "");
  EXPECT_EQ(answer_to(port_, "GET / HTTP/1.1\r\nHost: local"), "");
}

TEST_F(LiveHttp, EndsRequestsThatComeByteByByte) {
  Limits limits = patient();
  limits.head = std::chrono::milliseconds(50);
  start("", "", limits);
  asio::io_context context;
  tcp::socket socket(context);
  socket.connect({asio::ip::address_v4::loopback(), port_});
  wait_until([&] {
    error_code code;
    asio::write(socket, asio::buffer("x", 1), code);
    return code.failed();
  });
}

}  // namespace
}  // namespace weft::live
