// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/images/image_file.hpp>

namespace weft {
namespace {

using ::testing::HasSubstr;

std::string big32(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFFU);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  return big32(static_cast<std::uint32_t>(data.size())) + type + data +
         big32(detail::crc32(type + data));
}

/// A PNG without its pixels, which the test does not decode.
std::string png(std::uint32_t width, std::uint32_t height, char bits = 8, char colour = 2) {
  const std::string kind{bits, colour, 0, 0, 0};
  return "\x89PNG\r\n\x1A\n" + chunk("IHDR", big32(width) + big32(height) + kind) +
         chunk("IDAT", "pixels") + chunk("IEND", "");
}

void expect_size(const std::string& bytes, std::int64_t width, std::int64_t height) {
  const auto header = read_image_header(bytes);
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->width_px, width);
  EXPECT_EQ(header->height_px, height);
}

std::string letter(std::size_t value) { return std::string(1, static_cast<char>(value)); }

/// EXIF data with an orientation in either order of bytes.
std::string exif(int orientation, bool big) {
  using namespace std::string_literals;
  const std::string value = letter(static_cast<std::size_t>(orientation));
  if (big) return "MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"s + value + "\0\0\0\0\0\0"s;
  return "II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"s + value + "\0\0\0\0\0\0\0"s;
}

void expect_orientation(const std::string& bytes, int orientation) {
  const auto header = read_image_header(bytes);
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->orientation, orientation);
  EXPECT_EQ(header->upright_width_px(), orientation > 4 ? header->height_px : header->width_px);
}

void expect_refusal(const std::string& bytes, const std::string& reason) {
  const auto header = read_image_header(bytes);
  ASSERT_FALSE(header);
  EXPECT_THAT(header.error().message, HasSubstr(reason));
}

TEST(ImageHeader, ComputesTheChecksumOfItsStandard) {
  EXPECT_EQ(detail::crc32("123456789"), 0xCBF43926U);
}

TEST(ImageHeader, ReadsTheOrientationOfEachFormat) {
  using namespace std::string_literals;
  for (int k = 1; k <= 8; ++k) {
    for (const bool big : {false, true}) {
      const std::string data = exif(k, big);
      expect_orientation("\xFF\xD8\xFF\xE1\0"s + letter(data.size() + 8) + "Exif\0\0"s + data +
                             "\xFF\xC0\0\x11\x08\x01\xE0\x02\x80\x03zzzzzzzzz\xFF\xDA\0\x02"
                             "data\xFF\xD9"s,
                         k);
      std::string image = png(640, 480);
      image.insert(8 + 25, chunk("eXIf", data));
      expect_orientation(image, k);
      const std::string vp8x = "RIFF\0\0\0\0WEBPVP8X\x0A\0\0\0\0\0\0\0\x7F\x02\0\xDF\x01\0"s;
      expect_orientation(vp8x + "EXIF" + letter(data.size()) + "\0\0\0"s + data, k);
    }
    expect_orientation(
        "II*\0\x08\0\0\0\x03\0\0\x01\x03\0\x01\0\0\0\x80\x02\0\0\x01\x01\x04\0\x01\0\0\0\xE0"
        "\x01\0\0\x12\x01\x03\0\x01\0\0\0"s +
            letter(static_cast<std::size_t>(k)) + "\0\0\0"s,
        k);
  }
}

TEST(ImageHeader, TakesAnOrientationThatIsNoneOfTheEightForNone) {
  using namespace std::string_literals;
  for (const int k : {0, 9, 100}) {
    std::string image = png(640, 480);
    image.insert(8 + 25, chunk("eXIf", exif(k, false)));
    expect_orientation(image, 1);
  }
  std::string damaged = png(640, 480);
  std::string part = chunk("eXIf", exif(6, true));
  part.back() = static_cast<char>(part.back() + 1);
  damaged.insert(8 + 25, part);
  expect_orientation(damaged, 1);  // its checksum is wrong
}

TEST(ImageHeader, TellsSizesOfEachFormat) {
  using namespace std::string_literals;
  expect_size(png(640, 480), 640, 480);
  expect_size(
      "\xFF\xD8\xFF\xE0\0\x04zz\xFF\xC0\0\x11\x08\x01\xE0\x02\x80\x03zzzzzzzzz\xFF\xDA\0\x02"
      "data\xFF\xD9"s,
      640, 480);
  expect_size("BM\0\0\0\0\0\0\0\0\0\0\0\0\x28\0\0\0\x80\x02\0\0\x20\xFE\xFF\xFF"s, 640, 480);
  expect_size(
      "II*\0\x08\0\0\0\x02\0\0\x01\x03\0\x01\0\0\0\x80\x02\0\0\x01\x01\x04\0\x01\0\0\0\xE0"
      "\x01\0\0"s,
      640, 480);
  expect_size("P5\n# a comment 1 2\n640 480\n255\n"s, 640, 480);
  expect_size("RIFF\0\0\0\0WEBPVP8X\0\0\0\0\0\0\0\0\x7F\x02\0\xDF\x01\0"s, 640, 480);
}

TEST(ImageHeader, LeavesOtherFormatsToTheirDecoder) {
  expect_size(std::string("\0\0\0\x0CjP  ", 8), 0, 0);
}

TEST(ImageHeader, TellsAlphaAndBitsOfPng) {
  EXPECT_TRUE(read_image_header(png(4, 4, 8, 6))->has_alpha);
  EXPECT_FALSE(read_image_header(png(4, 4))->has_alpha);
  EXPECT_EQ(read_image_header(png(4, 4, 16))->bits, 16);
}

TEST(ImageHeader, RefusesWhatWouldNeedTooMuchMemory) {
  expect_refusal(png(60000, 60000), "60000 x 60000 px, which is more than 2^28");
  expect_refusal(png(0xFFFFFFFF, 0xFFFFFFFF), "more than 2^28");
  expect_refusal("P5 99999999999999999999 99999999999999999999 255\n", "more than 2^28");
  expect_refusal(png(0, 4), "no pixels");
  expect_refusal("", "empty");
}

TEST(ImageHeader, RefusesEveryPrefixAndEveryFlippedBitOfCriticalParts) {
  const std::string whole = png(640, 480);
  for (std::size_t length = 9; length < whole.size(); ++length) {
    EXPECT_FALSE(read_image_header(whole.substr(0, length))) << length;
  }
  for (std::size_t byte = 16; byte < 29; ++byte) {
    std::string flipped = whole;
    flipped[byte] = static_cast<char>(flipped[byte] ^ 4);
    EXPECT_FALSE(read_image_header(flipped)) << byte;
  }
}

TEST(ImageHeader, SurvivesAnythingBehindEachSignature) {
  using namespace std::string_literals;
  for (const std::string& start : {"\x89PNG\r\n\x1A\n"s, "\xFF\xD8\xFF"s, "BM"s, "II*\0"s, "MM\0*"s,
                                   "RIFF\0\0\0\0WEBP"s, "P6"s}) {
    for (const char fill : {'\0', '\xFF', '1', '\x7F'}) {
      for (const std::size_t length : {0U, 1U, 7U, 40U, 300U}) {
        static_cast<void>(read_image_header(start + std::string(length, fill)));
      }
    }
  }
}

TEST(ImageFile, NamesTheFileAndTheReason) {
  const auto folder = read_image_bytes("/tmp");
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().message, "/tmp: cannot be read: it is a folder");
  const auto device = read_image_bytes("/dev/zero");
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().message, "/dev/zero: cannot be read: it is no regular file");
}

}  // namespace
}  // namespace weft
