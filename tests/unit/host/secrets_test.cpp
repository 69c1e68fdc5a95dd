// SPDX-License-Identifier: Apache-2.0
#include "host/loading/secrets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace weft::host {
namespace {

TEST(Secrets, AreKnownByTheNamesOfTheirParameters) {
  for (const char* name :
       {"token", "password", "secret", "passphrase", "api_key", "camera_password", "my_api_key"}) {
    EXPECT_TRUE(is_secret(name)) << name;
  }
  for (const char* name : {"", "tokens", "detoken", "key", "_", "token_file", "address"}) {
    EXPECT_FALSE(is_secret(name)) << name;
  }
}

TEST(Secrets, AreHiddenByAVariableThatIsToBeSet) {
  EXPECT_EQ(hidden_text("token", "0123456789abcdef", "0123456789abcdef"), "${WEFT_TOKEN}");
  EXPECT_EQ(hidden_text("camera_password", "x", "x"), "${WEFT_CAMERA_PASSWORD}");
  EXPECT_EQ(hidden_text("token", "${MINE}", "0123456789abcdef"), "${MINE}");
  EXPECT_EQ(hidden_text("token", "", ""), std::nullopt);
  EXPECT_EQ(hidden_text("address", "127.0.0.1:8090", "127.0.0.1:8090"), std::nullopt);
}

TEST(Secrets, ArePasswordsInAddressesToo) {
  const auto hidden = [](const std::string& address) {
    return hidden_text("address", address, address);
  };
  EXPECT_EQ(hidden("rtsp://me:s3cret@10.0.0.2:554/stream"),
            "rtsp://me:${WEFT_PASSWORD}@10.0.0.2:554/stream");
  EXPECT_EQ(hidden("rtspsrc location=rtsp://me:s3c:r@et@camera ! appsink"),
            "rtspsrc location=rtsp://me:${WEFT_PASSWORD}@camera ! appsink");
  EXPECT_EQ(hidden_text("address", "rtsp://me:${PW}@camera/", "rtsp://me:s3cret@camera/"),
            "rtsp://me:${PW}@camera/");
  for (const char* address : {"rtsp://camera:554/x@y", "rtsp://me@camera/", "me:x@camera",
                              "tcp://127.0.0.1:5005", "http://[::1]:80/a:b@c"}) {
    EXPECT_EQ(hidden(address), std::nullopt) << address;
  }
}

TEST(Secrets, AreNotInTheConfigurationThatFilesHave) {
  const auto text = [](const char* name, const char* value) {
    return yaml::Entry{name, {}, yaml::text_node(value)};
  };
  yaml::Node params;
  params.kind = yaml::Kind::map;
  params.entries = {text("address", "a:1"), text("token", "0123456789abcdef")};
  ComponentSpec spec;
  spec.effective.kind = yaml::Kind::map;
  spec.effective.entries = {text("use", "sinks/live"), {"params", {}, params}};
  spec.hidden["token"] = "${WEFT_TOKEN}";
  const std::string shown = yaml::emit(without_secrets(spec));
  EXPECT_THAT(shown, ::testing::HasSubstr("${WEFT_TOKEN}"));
  EXPECT_THAT(shown, ::testing::HasSubstr("a:1"));
  EXPECT_THAT(shown, ::testing::Not(::testing::HasSubstr("0123456789abcdef")));
}

TEST(Secrets, AreNotShownOfSettings) {
  EXPECT_EQ(shown_setting("live.token=0123"), "live.token=...");
  EXPECT_EQ(shown_setting("live.params={address: x, token: 0123}"), "live.params=...");
  EXPECT_EQ(shown_setting("sinks=[{use: sinks/live, params: {'token' : 0123}}]"), "sinks=...");
  EXPECT_EQ(shown_setting("source.address=rtsp://me:s3cret@camera/"),
            "source.address=rtsp://me:${WEFT_PASSWORD}@camera/");
  for (const char* setting :
       {"filters.alpha_s=0.2", "live.token_file=a/token", "seed=3", "token", "a.b={c: token}"}) {
    EXPECT_EQ(shown_setting(setting), setting);
  }
}

}  // namespace
}  // namespace weft::host
