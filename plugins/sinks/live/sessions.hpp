// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <memory>
#include <string>

#include "protocol.hpp"

namespace weft::live {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using Request = http::request<http::empty_body>;

/// Each keeps itself and its connection alive until it is through.

/// Reads one request and answers it, or becomes one of the others.
void serve_request(tcp::socket socket, Hub& hub);
/// A line for each frame, in chunks; `head` is that of the answer.
void serve_lines(tcp::socket socket, Hub& hub, std::string head);
void serve_websocket(beast::tcp_stream stream, Hub& hub, const Request& request,
                     std::string_view subprotocol);

}  // namespace weft::live
