// SPDX-License-Identifier: Apache-2.0
#include "messages.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <limits>
#include <vector>

#include "address.hpp"
#include "sheet_points.hpp"

namespace weft::stream {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();

std::string hexadecimal(const std::string& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const char byte : bytes) {
    const auto value = static_cast<unsigned char>(byte);
    text += kDigits[value / 16];
    text += kDigits[value % 16];
  }
  return text;
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(StreamMessages, PackedHaveTheBytesOfTheReadme) {
  const Shape shape = two_vertices();
  const std::string header =
      "57454654"          // WEFT
      "01000000"          // version 1
      "f8000000"          // 248 = 56 + 2 * 96 bytes
      "02000000"          // 2 vertices
      "0201000000000000"  // frame 258
      "000000000000e03f"  // 0.5 s
      "000000000000e83f"  // confidence 0.75
      "02000000"          // weak
      "01000000"          // covariance follows
      "0300000000000000"  // 3 frames old
      ;
  const std::string vertices =
      "000000000000f03f"
      "000000000000e03f"
      "0000000000000040"  // 1, 0.5, 2
      "000000000000d0bf"
      "0000000000000000"
      "0000000000000840"  // -0.25, 0, 3
      ;
  const std::string covariance = repeated("000000000000e03f", 9) + repeated("0000000000000040", 9);
  EXPECT_EQ(hexadecimal(packed({258, 0.5, shape, true})), header + vertices + covariance);
}

TEST(StreamMessages, PackedSayThatThereIsNoCovarianceAndNoTime) {
  Shape shape = two_vertices();
  const std::string without = packed({0, kNoTime, shape, false});
  EXPECT_EQ(without.size(), 56U + 2 * 24U);
  EXPECT_EQ(hexadecimal(without.substr(8, 4)), "68000000");           // 104 bytes
  EXPECT_EQ(hexadecimal(without.substr(24, 8)), "000000000000f87f");  // NaN
  EXPECT_EQ(hexadecimal(without.substr(44, 4)), "00000000");
  shape.covariance_m2 = {};
  EXPECT_EQ(hexadecimal(packed({0, kNoTime, shape, true})), hexadecimal(without));
}

TEST(StreamMessages, AreOneLineOfJson) {
  const Shape shape = two_vertices();
  EXPECT_EQ(json_line({258, 0.5, shape, true}),
            "{\"frame\":258,\"time_s\":0.5,\"state\":\"weak\",\"age_frames\":3,\"confidence\":0.75,"
            "\"vertices_m\":[[1,0.5,2],[-0.25,0,3]],\"covariance_m2\":["
            "[[0.5,0.5,0.5],[0.5,0.5,0.5],[0.5,0.5,0.5]],[[2,2,2],[2,2,2],[2,2,2]]]}\n");
  EXPECT_EQ(json_line({0, kNoTime, shape, false}),
            "{\"frame\":0,\"time_s\":null,\"state\":\"weak\",\"age_frames\":3,\"confidence\":0.75,"
            "\"vertices_m\":[[1,0.5,2],[-0.25,0,3]],\"covariance_m2\":null}\n");
}

TEST(StreamMessages, OfJsonSayWhyTheHostDoubtsTheShape) {
  Shape shape = two_vertices();
  const std::string reason = "fx seems to be \"0.8\"";
  Array<std::uint8_t> text({static_cast<std::int64_t>(reason.size())}, 0);
  for (std::size_t i = 0; i < reason.size(); ++i) {
    text(static_cast<std::int64_t>(i)) = static_cast<std::uint8_t>(reason[i]);
  }
  shape.others.set("x.weft.reason", std::move(text));
  EXPECT_NE(json_line({0, 0.0, shape, false})
                .find("\"confidence\":0.75,\"reason\":\"fx seems to be \\\"0.8\\\"\",\"vertices_m"),
            std::string::npos);
}

TEST(StreamMessages, OfJsonReadBackAsTheSameNumbers) {
  Shape shape = two_vertices();
  shape.vertices_m(1, 2) = 1.0 / 3.0;
  shape.covariance_m2 = {};
  const std::string line = json_line({0, 0.1, shape, true});
  const std::size_t at = line.find("[-0.25,0,") + 9;
  EXPECT_EQ(std::strtod(line.c_str() + at, nullptr), 1.0 / 3.0);
}

TEST(StreamMessages, FollowRowsWithAStride) {
  Shape shape = two_vertices();
  const std::string whole = packed({0, 0.0, shape, true});
  const std::string line = json_line({0, 0.0, shape, true});
  // The same vertices in rows of five numbers.
  std::vector<double> wide(10, 99.0);
  for (std::int64_t v = 0; v < 2; ++v) {
    std::copy_n(shape.vertices_m.row(v), 3, wide.begin() + 5 * v);
  }
  shape.vertices_m = Array<double>::borrow(wide.data(), 2, {2, 3, 1, 1}, 5);
  EXPECT_EQ(packed({0, 0.0, shape, true}), whole);
  EXPECT_EQ(json_line({0, 0.0, shape, true}), line);
}

TEST(StreamAddress, IsReadWithItsParts) {
  const auto v4 = parse_address("tcp://127.0.0.1:5005");
  ASSERT_TRUE(v4) << v4.error().message;
  EXPECT_EQ(v4->protocol, Protocol::tcp);
  EXPECT_EQ(v4->host.to_string(), "127.0.0.1");
  EXPECT_EQ(v4->port, 5005);
  const auto v6 = parse_address("udp://[::1]:65535");
  ASSERT_TRUE(v6) << v6.error().message;
  EXPECT_EQ(v6->protocol, Protocol::udp);
  EXPECT_EQ(v6->host.to_string(), "::1");
  EXPECT_EQ(v6->port, 65535);
  const auto local = parse_address("tcp://localhost:80");
  ASSERT_TRUE(local) << local.error().message;
  EXPECT_EQ(local->host.to_string(), "127.0.0.1");
}

TEST(StreamAddress, ThatIsNoneIsRefusedWithAnExample) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"stdout", "begins neither with tcp:// nor with udp://"},
      {"/tmp/points", "begins neither with tcp:// nor with udp://"},
      {"http://127.0.0.1:80", "begins neither with tcp:// nor with udp://"},
      {"tcp://", "has no port from 1 to 65535"},
      {"tcp://127.0.0.1", "has no port from 1 to 65535"},
      {"tcp://127.0.0.1:", "has no port from 1 to 65535"},
      {"tcp://127.0.0.1:0", "has no port from 1 to 65535"},
      {"tcp://127.0.0.1:65536", "has no port from 1 to 65535"},
      {"tcp://127.0.0.1:50x", "has no port from 1 to 65535"},
      {"tcp://:5005", "has no address in numbers"},
      {"udp://robot.local:5005", "has no address in numbers"},
      {"udp://fe80::1:5005", "has no address in numbers"},
      {"udp://[127.0.0.1]:5005", "has no address in numbers"},
      {"udp://::1:5005x", "has no port from 1 to 65535"}};
  for (const auto& [text, why] : wrong) {
    const auto address = parse_address(text);
    ASSERT_FALSE(address) << text;
    EXPECT_THAT(address.error().message, HasSubstr(why)) << text;
    EXPECT_THAT(address.error().message,
                EndsWith("'path' for a file, a named pipe or /dev/stdout"));
  }
}

}  // namespace
}  // namespace weft::stream
