// SPDX-License-Identifier: Apache-2.0
#include "access_policy.hpp"

#include <gmock/gmock.h>

namespace weft::live {
namespace {

using ::testing::HasSubstr;

constexpr const char* kToken = "0123456789abcdef";

AccessPolicy policy_at(const std::string& address, const std::string& token = "",
                       const std::string& origin = "") {
  return AccessPolicy(boost::asio::ip::make_address(address), token, origin);
}

int status_for(const AccessPolicy& policy, const Visit& visit, bool needs_token = true) {
  const auto refusal = policy.refuse(visit, needs_token);
  return refusal ? refusal->status : 200;
}

TEST(LiveAccessPolicy, LetsInWhoNamesTheAddressOrLocalhost) {
  const AccessPolicy policy = policy_at("127.0.0.1");
  for (const char* host : {"127.0.0.1:8090", "localhost:8090", "LocalHost", "localhost:9000"}) {
    EXPECT_EQ(status_for(policy, {"/", host, std::nullopt, ""}), 200) << host;
  }
  for (const char* host : {"", "evil.example:8090", "127.0.0.1.evil.example", "192.168.0.9:8090",
                           "localhost.evil.example", "[::1]:8090", "[", "127.0.0.1@evil",
                           "127.0.0.1:8090.evil.example", "localhost:evil", "::1"}) {
    EXPECT_EQ(status_for(policy, {"/", host, std::nullopt, ""}), 403) << host;
  }
  EXPECT_EQ(status_for(policy_at("::1"), {"/", "[::1]:8090", std::nullopt, ""}), 200);
  EXPECT_EQ(status_for(policy_at("::1"), {"/", "[::1]", std::nullopt, ""}), 200);
  EXPECT_EQ(status_for(policy_at("::1"), {"/", "[::1]evil:8090", std::nullopt, ""}), 403);
}

TEST(LiveAccessPolicy, AtAllAddressesLetsInAnyAddressInNumbersButNoName) {
  const AccessPolicy policy = policy_at("0.0.0.0", kToken);
  const std::string bearer = std::string("Bearer ") + kToken;
  EXPECT_EQ(status_for(policy, {"/", "192.168.0.9:8090", std::nullopt, bearer}), 200);
  EXPECT_EQ(status_for(policy, {"/", "evil.example:8090", std::nullopt, bearer}), 403);
}

TEST(LiveAccessPolicy, KeepsOutPagesOfOtherOrigins) {
  const AccessPolicy policy = policy_at("127.0.0.1");
  const auto with_origin = [](std::string_view origin) {
    return Visit{"/ws", "127.0.0.1:8090", origin, ""};
  };
  EXPECT_EQ(status_for(policy, with_origin("http://127.0.0.1:8090")), 200);
  for (const char* origin : {"http://evil.example", "http://127.0.0.1:3000", "null", "",
                             "https://127.0.0.1:8090", "http://localhost:8090", "file://"}) {
    EXPECT_EQ(status_for(policy, with_origin(origin)), 403) << origin;
  }
  const AccessPolicy opened = policy_at("127.0.0.1", "", "https://app.foxglove.dev");
  EXPECT_EQ(status_for(opened, with_origin("https://app.foxglove.dev")), 200);
  EXPECT_EQ(status_for(opened, with_origin("https://app.foxglove.dev.evil.example")), 403);
  EXPECT_EQ(status_for(opened, with_origin("")), 403);
}

TEST(LiveAccessPolicy, AsksForTheTokenInTheAddressOrTheHeader) {
  const AccessPolicy policy = policy_at("127.0.0.1", kToken);
  const auto visit = [](std::string_view target, std::string_view header) {
    return Visit{target, "127.0.0.1:8090", std::nullopt, header};
  };
  EXPECT_EQ(status_for(policy, visit("/ws?token=0123456789abcdef", "")), 200);
  EXPECT_EQ(status_for(policy, visit("/ws?a=b&token=0123456789abcdef&c", "")), 200);
  EXPECT_EQ(status_for(policy, visit("/ws", "Bearer 0123456789abcdef")), 200);
  EXPECT_EQ(status_for(policy, visit("/ws", "bearer 0123456789abcdef")), 200);
  EXPECT_EQ(status_for(policy, visit("/live.js", ""), false), 200);
  for (const char* target :
       {"/ws", "/ws?", "/ws?token=", "/ws?token=0123456789abcdeF", "/ws?token=0123456789abcde",
        "/ws?token=0123456789abcdef0", "/ws?&&token", "/ws?xtoken=0123456789abcdef"}) {
    EXPECT_EQ(status_for(policy, visit(target, "")), 401) << target;
  }
  EXPECT_EQ(status_for(policy, visit("/ws", "Basic 0123456789abcdef")), 401);
  EXPECT_EQ(status_for(policy, visit("/ws", "Bearer")), 401);
  // The header counts where there are both.
  EXPECT_EQ(status_for(policy, visit("/ws?token=0123456789abcdef", "Bearer wrong")), 401);
}

TEST(LiveAccessPolicy, WantsATokenWhereOthersReachTheAddress) {
  EXPECT_TRUE(policy_at("127.0.0.1").check_token());
  EXPECT_TRUE(policy_at("127.8.8.8").check_token());
  EXPECT_TRUE(policy_at("::1").check_token());
  for (const char* address : {"0.0.0.0", "::", "192.168.0.9"}) {
    EXPECT_TRUE(policy_at(address, kToken).check_token());
    const auto without = policy_at(address).check_token();
    ASSERT_FALSE(without) << address;
    EXPECT_THAT(without.error().message, HasSubstr("a token is needed"));
  }
  for (const char* token : {"short", "0123456789abcde", "0123456789abcde&", "0123456789abcde f"}) {
    const auto wrong = policy_at("127.0.0.1", token).check_token();
    ASSERT_FALSE(wrong) << token;
    EXPECT_THAT(wrong.error().message, HasSubstr("at least 16 characters"));
  }
}

TEST(LiveAccessPolicy, KnowsAnOriginFromAnAddress) {
  for (const char* origin : {"", "https://app.foxglove.dev", "http://10.0.0.1:80", "file://"}) {
    EXPECT_TRUE(policy_at("127.0.0.1", "", origin).check_origin()) << origin;
  }
  for (const char* origin : {"app.foxglove.dev", "https://app.foxglove.dev/", "*", "null", "://x",
                             "https://a, https://b"}) {
    EXPECT_FALSE(policy_at("127.0.0.1", "", origin).check_origin()) << origin;
  }
}

}  // namespace
}  // namespace weft::live
