// SPDX-License-Identifier: Apache-2.0
#include "common/images/decoder.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <weft/core/rng.hpp>

namespace weft::image_files {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint64_t kSeed = 49;

/// Smooth, so that JPEG keeps it, and unlike itself in each orientation.
cv::Mat picture(int channels) {
  cv::Mat image(40, 64, CV_8UC(channels));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      for (int c = 0; c < channels; ++c) {
        image.ptr<std::uint8_t>(y)[x * channels + c] =
            static_cast<std::uint8_t>(3 * x + y + 20 * c);
      }
    }
  }
  return image;
}

ImageFile encoded(const std::string& extension, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes);
  ImageFile file{{bytes.begin(), bytes.end()}, {}};
  file.header = *read_image_header(file.bytes);
  return file;
}

cv::Mat by_opencv(const ImageFile& file, int flags) {
  return cv::imdecode(std::vector<std::uint8_t>(file.bytes.begin(), file.bytes.end()), flags);
}

void expect_equal(const cv::Mat& a, const cv::Mat& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(a.type(), b.type());
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0);
}

/// Where OpenCV's reader places pixels: the standard's own figure of the eight orientations.
cv::Mat upright_by_words(const cv::Mat& stored, int orientation) {
  cv::Mat result;
  switch (orientation) {
    case 2:
      cv::flip(stored, result, 1);
      break;
    case 3:
      cv::rotate(stored, result, cv::ROTATE_180);
      break;
    case 4:
      cv::flip(stored, result, 0);
      break;
    case 5:
      cv::rotate(stored, result, cv::ROTATE_90_CLOCKWISE);
      cv::flip(result, result, 1);
      break;
    case 6:
      cv::rotate(stored, result, cv::ROTATE_90_CLOCKWISE);
      break;
    case 7:
      cv::rotate(stored, result, cv::ROTATE_90_COUNTERCLOCKWISE);
      cv::flip(result, result, 1);
      break;
    case 8:
      cv::rotate(stored, result, cv::ROTATE_90_COUNTERCLOCKWISE);
      break;
    default:
      return stored;
  }
  return result;
}

TEST(Decoder, MakesAllEightOrientationsUpright) {
  for (int k = 1; k <= 8; ++k) {
    for (const int channels : {1, 3, 4}) {
      expect_equal(upright(picture(channels), k), upright_by_words(picture(channels), k));
    }
  }
}

TEST(Decoder, DecodesEachFormatToTheBitAsOpenCvDoes) {
  for (const char* extension : {".jpg", ".png", ".bmp", ".tiff", ".webp", ".pgm"}) {
    for (const int channels : {1, 3}) {
      if (channels == 3 && std::string(extension) == ".pgm") continue;
      SCOPED_TRACE(extension);
      const ImageFile file = encoded(extension, picture(channels));
      const Decoded stored = decode_stored(file), grey = decode_stored(file, Channels::grey);
      expect_equal(stored.pixels, by_opencv(file, cv::IMREAD_UNCHANGED));
      expect_equal(grey.pixels, by_opencv(file, cv::IMREAD_GRAYSCALE));
      EXPECT_THAT(stored.damage, IsEmpty());
      EXPECT_TRUE(whole_pixels(stored, "file"));
    }
  }
  const ImageFile with_alpha = encoded(".png", picture(4));
  expect_equal(decode_stored(with_alpha).pixels, picture(4));
}

/// An uncompressed grey TIFF of one strip, in either order of bytes.
ImageFile tiff(const cv::Mat& grey, int orientation, bool big) {
  std::string bytes = big ? std::string("MM\0*", 4) : std::string("II*\0", 4);
  const auto put = [&](std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) {
      bytes += static_cast<char>(value >> (8 * (big ? size - 1 - i : i)) & 0xFFU);
    }
  };
  put(8 + static_cast<std::uint32_t>(grey.total()), 4);
  bytes.append(grey.ptr<char>(), grey.total());
  const std::vector<std::pair<int, int>> entries{
      {256, grey.cols}, {257, grey.rows},   {258, 8}, {259, 1},         {262, 1},
      {273, 8},         {274, orientation}, {277, 1}, {278, grey.rows}, {279, 40 * 64}};
  put(static_cast<std::uint32_t>(entries.size()), 2);
  for (const auto& [tag, value] : entries) {
    put(static_cast<std::uint32_t>(tag), 2);
    put(3, 2);  // SHORT
    put(1, 4);
    put(static_cast<std::uint32_t>(value), 2);
    put(0, 2);
  }
  put(0, 4);
  ImageFile file{bytes, {}};
  file.header = *read_image_header(bytes);
  return file;
}

TEST(Decoder, ReadsTiffWhateverOrientationItSays) {
  for (int k = 1; k <= 8; ++k) {
    for (const bool big : {false, true}) {
      const ImageFile file = tiff(picture(1), k, big);
      EXPECT_EQ(file.header.orientation, k);
      EXPECT_EQ(file.header.bits, 8);
      expect_equal(decode_stored(file).pixels, picture(1));
      expect_equal(decode_upright(file).pixels, upright_by_words(picture(1), k));
    }
  }
}

TEST(Decoder, ReportsDamagedJpegWithItsReasonAndPrintsNothing) {
  SCOPED_TRACE(kSeed);
  Rng rng(kSeed);
  cv::Mat noise(96, 128, CV_8UC3);
  for (std::size_t i = 0; i < noise.total() * 3; ++i) {
    noise.data[i] = static_cast<std::uint8_t>(rng.below(256));
  }
  const ImageFile whole = encoded(".jpg", noise);
  const std::size_t scan = whole.bytes.find("\xFF\xDA") + 14;
  int found = 0, cut = 0;
  ::testing::internal::CaptureStderr();
  for (int trial = 0; trial < 40; ++trial) {
    ImageFile damaged = whole;
    for (int flip = 0; flip < 20; ++flip) {
      const std::size_t at = scan + rng.below(whole.bytes.size() - scan - 2);
      damaged.bytes[at] = static_cast<char>(damaged.bytes[at] ^ 1 << rng.below(8));
    }
    const Decoded decoded = decode_stored(damaged);
    found += decoded.damage.empty() ? 0 : 1;
    if (!decoded.damage.empty()) {
      const auto pixels = whole_pixels(decoded, "photo.jpg");
      ASSERT_FALSE(pixels);
      EXPECT_THAT(pixels.error().message, HasSubstr("photo.jpg: is damaged"));
    }
    ImageFile short_one = whole;
    short_one.bytes.resize(scan + rng.below(whole.bytes.size() - scan - 200));
    short_one.bytes += "\xFF\xD9";
    cut += decode_stored(short_one).damage.empty() ? 0 : 1;
  }
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), IsEmpty());
  EXPECT_GT(found, 35);  // flipped bits may make another legal image
  EXPECT_EQ(cut, 40);
}

TEST(Decoder, PrintsNothingOfOddChunksInPng) {
  ImageFile file = encoded(".png", picture(3));
  const std::string data("\0\0\0\x03iCCPabc\0\0\0\0", 15);  // its checksum is wrong
  file.bytes.insert(33, data);
  ::testing::internal::CaptureStderr();
  expect_equal(decode_stored(file).pixels, picture(3));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), IsEmpty());
}

std::string chunk(const std::string& type, const std::string& data) {
  const auto big32 = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFFU);
    return bytes;
  };
  const auto length = static_cast<std::uint32_t>(data.size());
  return big32(length) + type + data + big32(detail::crc32(type + data));
}

/// One byte of the coded pixels is another, and the checksum of the chunk is right again.
ImageFile with_other_code(const ImageFile& png, Rng& rng) {
  ImageFile file = png;
  const std::size_t at = file.bytes.find("IDAT");
  const std::uint32_t length = detail::Bytes(file.bytes).big32(at - 4);
  std::string data = file.bytes.substr(at + 4, length);
  data[rng.below(length)] ^= static_cast<char>(1 << rng.below(8));
  file.bytes.replace(at - 4, length + 12, chunk("IDAT", data));
  return file;
}

TEST(Decoder, PrintsNothingOfDamagedPng) {
  SCOPED_TRACE(kSeed);
  Rng rng(kSeed);
  int undecoded = 0;
  ::testing::internal::CaptureStderr();
  for (const int channels : {1, 3}) {
    const ImageFile whole = encoded(".png", picture(channels));
    for (int trial = 0; trial < 150; ++trial) {
      ImageFile damaged = whole;
      for (std::uint64_t flip = 0; flip < 1 + rng.below(20); ++flip) {
        char& byte = damaged.bytes[rng.below(whole.bytes.size())];
        byte = static_cast<char>(byte ^ 1 << rng.below(8));
      }
      if (rng.below(3) == 0) damaged.bytes.resize(rng.below(whole.bytes.size()));
      // A file that the header check refuses is never decoded.
      if (const auto header = read_image_header(damaged.bytes)) {
        damaged.header = *header;
        undecoded += decode_stored(damaged).pixels.empty() ? 1 : 0;
      }
      undecoded += decode_stored(with_other_code(whole, rng)).pixels.empty() ? 1 : 0;
    }
  }
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), IsEmpty());
  EXPECT_GT(undecoded, 100) << "the damage must reach the decoders";
}

TEST(Decoder, DecodesPngOfSixteenBitsAndWithAColourForTransparentAsOpenCvDoes) {
  for (const int channels : {1, 3, 4}) {
    cv::Mat deep;
    picture(channels).convertTo(deep, CV_16U, 255.0, 7.0);
    const ImageFile file = encoded(".png", deep);
    expect_equal(decode_stored(file).pixels, deep);
    expect_equal(decode_stored(file, Channels::grey).pixels, by_opencv(file, cv::IMREAD_GRAYSCALE));
  }
  for (const int channels : {1, 3}) {
    ImageFile file = encoded(".png", picture(channels));
    const std::string colour(channels == 1 ? std::string("\0\x09", 2)
                                           : std::string("\0\x31\0\x1D\0\x09", 6));
    file.bytes.insert(33, chunk("tRNS", colour));
    expect_equal(decode_stored(file).pixels, by_opencv(file, cv::IMREAD_UNCHANGED));
    expect_equal(decode_stored(file, Channels::grey).pixels, by_opencv(file, cv::IMREAD_GRAYSCALE));
  }
}

TEST(Decoder, TurnsWhatBelongsToAnImageWithIt) {
  const Main main{"frame.jpg", {64, 40}, 6};
  const cv::Mat stored = picture(1), turned = upright(stored, 6);
  expect_equal(*upright_beside(main, stored, 6, "mask.png"), turned);  // its own orientation
  expect_equal(*upright_beside(main, stored, 1, "mask.png"), turned);  // mask of the stored grid
  expect_equal(*upright_beside(main, turned, 1, "mask.png"), turned);  // mask of the upright image
  const auto other = upright_beside(main, stored, 8, "mask.png");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("mask.png"));
  const Main upside_down{"frame.jpg", {64, 40}, 3};
  EXPECT_FALSE(upright_beside(upside_down, stored, 1, "mask.png"));  // nothing shows which it is
}

}  // namespace
}  // namespace weft::image_files
