// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/address.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <weft/core/result.hpp>

namespace weft::live {

/// The origin of a request; each text as in the request.
struct Visit {
  std::string_view target;                 ///< `/ws?token=...`
  std::string_view host;                   ///< empty where there is none, or more than one
  std::optional<std::string_view> origin;  ///< origin of pages in browsers; absent elsewhere
  std::string_view authorization;          ///< empty where there is none
};

/// Why a request is not let in.
struct Refusal {
  int status;            ///< status code of HTTP
  std::string sentence;  ///< the suggested change
};

/// `/ws` of `/ws?token=...`.
std::string_view path_of(std::string_view target);

/// The access policy of the server. Pages of other origins could read all that a browser on this
/// machine may read, so it compares the origin. A page whose name resolves to this machine has the
/// right origin, so it compares the name too.
class AccessPolicy {
 public:
  AccessPolicy(boost::asio::ip::address listening, std::string token, std::string origin)
      : listening_(std::move(listening)), token_(std::move(token)), origin_(std::move(origin)) {}

  /// Check that a token is given where other machines can reach the address, its length and
  /// characters, and the form of the origin.
  Result<void> check_token() const;
  Result<void> check_origin() const;

  /// Nothing where the request may come in. Some files hold no secret and need no token.
  std::optional<Refusal> refuse(const Visit& visit, bool needs_token) const;

 private:
  bool is_ours(std::string_view host) const;
  bool has_token(const Visit& visit) const;

  boost::asio::ip::address listening_;
  std::string token_, origin_;
};

}  // namespace weft::live
