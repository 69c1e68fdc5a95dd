// SPDX-License-Identifier: Apache-2.0
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "common/network_address.hpp"
#include "outlet.hpp"

namespace weft::stream {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;

class UdpOutlet final : public Outlet {
 public:
  UdpOutlet(const Address& address, std::string name)
      : socket_(context_), reader_(address.host, address.port), name_(std::move(name)) {}

  boost::system::error_code open() {
    boost::system::error_code code;
    socket_.open(reader_.protocol(), code);
    if (!code) socket_.non_blocking(true, code);
    return code;
  }

  Result<void> send(std::string message, const Call&) override {
    boost::system::error_code code;
    socket_.send_to(asio::buffer(message), reader_, 0, code);
    // A network that has no room for it now loses it, as it may lose any other datagram.
    if (!code || code == asio::error::would_block) return {};
    if (code != asio::error::message_size) return network::address_error(name_, code);
    return Error{Errc::unsupported,
                 "a frame of " + std::to_string(message.size()) +
                     " bytes does not fit a datagram, which holds 65507: take format: packed, "
                     "covariance: false, fewer vertices, or tcp://"};
  }

  void finish() override {}

 private:
  asio::io_context context_;
  udp::socket socket_;
  udp::endpoint reader_;
  std::string name_;
};

}  // namespace

MadeOutlet send_to(const Address& address, const std::string& name) {
  auto outlet = std::make_unique<UdpOutlet>(address, name);
  if (const auto code = outlet->open()) return network::address_error(name, code);
  return std::unique_ptr<Outlet>(std::move(outlet));
}

}  // namespace weft::stream
