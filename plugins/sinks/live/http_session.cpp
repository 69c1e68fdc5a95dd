// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <boost/asio/write.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <sstream>
#include <utility>

#include "camera/device_list.hpp"
#include "page.hpp"
#include "sessions.hpp"

namespace weft::live {
namespace {

constexpr std::uint32_t kMostHeader = 8 * 1024;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

/// The value of a field that may stand once at most; empty where it stands more often.
std::string_view only(const Request& request, http::field field) {
  return request.count(field) == 1 ? view(request[field]) : std::string_view();
}

Visit visit_of(const Request& request) {
  Visit visit{view(request.target()), only(request, http::field::host), std::nullopt,
              only(request, http::field::authorization)};
  if (request.count(http::field::origin) > 0) visit.origin = only(request, http::field::origin);
  return visit;
}

/// The first subprotocol that both sides know; empty where there is none. A client may list them in
/// one field or in several.
std::string_view subprotocol_of(const Request& request) {
  const auto [first, last] = request.equal_range(http::field::sec_websocket_protocol);
  for (auto field = first; field != last; ++field) {
    for (const auto& name : http::token_list(field->value())) {
      for (const std::string_view known :
           {kLiveProtocol, kFoxgloveSdkProtocol, kFoxgloveProtocol}) {
        if (view(name) == known) return known;
      }
    }
  }
  return {};
}

struct Head {
  http::status status = http::status::ok;
  std::string_view type = "text/plain; charset=utf-8";
  std::optional<std::size_t> length;  ///< [] bytes; absent where the content comes in chunks
};

std::string text_of(const Head& head) {
  http::response<http::empty_body> response(head.status, 11);
  const auto set = [&](auto field, std::string_view value) {
    response.set(field, beast::string_view(value.data(), value.size()));
  };
  set(http::field::content_type, head.type);
  if (head.length) {
    set(http::field::content_length, std::to_string(*head.length));
  } else {
    set(http::field::transfer_encoding, "chunked");
  }
  set(http::field::connection, "close");
  set(http::field::cache_control, "no-store");
  set("X-Content-Type-Options", "nosniff");
  set("Referrer-Policy", "no-referrer");  // the address may hold the token
  set("Cross-Origin-Resource-Policy", "same-origin");
  set("Content-Security-Policy",
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
      "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  if (head.status == http::status::unauthorized) set(http::field::www_authenticate, "Bearer");
  if (head.status == http::status::method_not_allowed) set(http::field::allow, "GET");
  if (head.status == http::status::upgrade_required) set(http::field::upgrade, "websocket");
  std::ostringstream text;
  text << response.base();
  return text.str();
}

class HttpSession final : public Client, public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(tcp::socket socket, Hub& hub)
      : hub_(hub), place_(hub, *this), stream_(std::move(socket)), buffer_(2 * kMostHeader) {
    parser_.header_limit(kMostHeader);
    parser_.body_limit(std::uint64_t{0});
    hub_.guests.push_back(this);
  }
  ~HttpSession() override { hub_.guests.remove(this); }

  void run() {
    stream_.expires_after(hub_.setup.limits.head);
    http::async_read_header(
        stream_, buffer_, parser_,
        [self = shared_from_this()](const error_code& code, std::size_t) { self->judge(code); });
  }

  void end(bool at_once) override {
    if (!at_once && is_answering_) return;
    hub_.guests.remove(this);
    stream_.close();
  }
  bool has_access() const override { return has_access_; }

 private:
  void refuse(http::status status, std::string sentence) {
    sentence_ = std::move(sentence) + "\n";
    answer({status, "text/plain; charset=utf-8", sentence_.size()}, sentence_);
  }

  void judge(const error_code& code) {
    if (!code) return route(parser_.get());
    if (code == http::error::header_limit || code == http::error::buffer_overflow) {
      return refuse(http::status::request_header_fields_too_large,
                    "The header of a request may have 8 kB.");
    }
    if (code == http::error::body_limit) return refuse_body();
    const bool is_gone = code == http::error::end_of_stream || code == http::error::partial_message;
    if (is_gone || code.category() != http::make_error_code(http::error::bad_method).category()) {
      return stream_.close();
    }
    refuse(http::status::bad_request, "This is no request of HTTP 1.1: " + code.message() + ".");
  }

  void refuse_body() {
    refuse(http::status::payload_too_large, "A request to this server has no body.");
  }

  void route(const Request& request) {
    if (parser_.chunked() || parser_.content_length().value_or(0) > 0) return refuse_body();
    if (buffer_.size() > 0) {
      return refuse(http::status::bad_request, "One request a connection, and nothing behind it.");
    }
    const Visit visit = visit_of(request);
    const std::string_view path = path_of(visit.target);
    const PageFile* file = page_file(path);
    const bool needs_token = file == nullptr || !file->is_public;
    if (const auto refusal = hub_.setup.policy.refuse(visit, needs_token)) {
      return refuse(static_cast<http::status>(refusal->status), refusal->sentence);
    }
    if (request.method() != http::verb::get) {
      return refuse(http::status::method_not_allowed, "This server answers to GET only.");
    }
    if (needs_token && !enter()) {
      return refuse(http::status::service_unavailable,
                    "This server has as many clients as it takes: close one of them.");
    }
    const bool is_upgrade = beast::websocket::is_upgrade(request);
    if (is_upgrade && (path == "/ws" || path == "/")) return upgrade(request);
    if (path == "/ws") {
      return refuse(http::status::upgrade_required, "Here is a WebSocket: connect to it as one.");
    }
    if (path == "/frames.jsonl") {
      return serve_lines(stream_.release_socket(), hub_,
                         text_of({http::status::ok, "application/jsonl", std::nullopt}));
    }
    if (path == "/cameras.json") {
      sentence_ = device_list(capture_devices::list_devices());
      return answer({http::status::ok, "application/json", sentence_.size()}, sentence_);
    }
    if (file == nullptr) {
      return refuse(http::status::not_found, "There are /, /ws, /frames.jsonl and /cameras.json.");
    }
    answer({http::status::ok, file->type, file->content.size()}, file->content);
  }

  /// A guest becomes a client, unless there are enough of these.
  bool enter() {
    if (hub_.is_full()) return false;
    has_access_ = true;
    hub_.guests.remove(this);
    return true;
  }

  void upgrade(const Request& request) {
    const std::string_view subprotocol = subprotocol_of(request);
    if (subprotocol.empty()) {
      return refuse(http::status::bad_request,
                    "Name a subprotocol: weft.live.1, foxglove.sdk.v1 or foxglove.websocket.v1.");
    }
    serve_websocket(std::move(stream_), hub_, request, subprotocol);
  }

  /// `content` stays where it is until the session is gone.
  void answer(const Head& head, std::string_view content) {
    head_ = text_of(head);
    is_answering_ = true;
    stream_.expires_after(hub_.setup.limits.request);
    const std::array<asio::const_buffer, 2> buffers{asio::buffer(head_),
                                                    asio::buffer(content.data(), content.size())};
    asio::async_write(stream_, buffers,
                      [self = shared_from_this()](const error_code& code, std::size_t) {
                        self->is_answering_ = false;
                        if (code) return self->stream_.close();
                        error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                        self->drain();
                      });
  }

  /// Reads on until the client closes: closing first would take back an answer that is on its way
  /// to a client which still sends.
  void drain() {
    if (drained_ > kMostDrained) return stream_.close();
    stream_.async_read_some(asio::buffer(unread_),
                            [self = shared_from_this()](const error_code& code, std::size_t bytes) {
                              if (code) return self->stream_.close();
                              self->drained_ += bytes;
                              self->drain();
                            });
  }

  static constexpr std::size_t kMostDrained = 64 * 1024;

  Hub& hub_;
  Place place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  std::string head_, sentence_;
  std::array<char, 4096> unread_{};
  std::size_t drained_ = 0;
  bool is_answering_ = false, has_access_ = false;
};

}  // namespace

void serve_request(tcp::socket socket, Hub& hub) {
  std::make_shared<HttpSession>(std::move(socket), hub)->run();
}

}  // namespace weft::live
