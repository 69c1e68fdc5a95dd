// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "common/tests/filter_bench.hpp"
#include "reference.hpp"

namespace weft::testing {
namespace {

using ::testing::HasSubstr;

std::string shipped() {
  std::ifstream stream(WEFT_LEARNED_WEIGHTS, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The error of an archive; empty where there is none.
std::string refusal(const std::string& bytes) {
  const auto parsed = learned::parse_weights(bytes, "some.npz");
  return parsed ? "" : parsed.error().message;
}

/// Replaces text that has the same length, and the checksums are then wrong.
std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
  const std::size_t at = bytes.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return bytes.replace(at, from.size(), to);
}

std::uint32_t number_at(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data() + at, size);
  return number;
}

std::uint32_t checksum(const std::string& bytes) {
  std::uint32_t sum = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    sum ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1U) ^ ((sum & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~sum;
}

/// Changes the array of an archive without compression by `change`, which keeps its size, and
/// corrects both checksums.
template <class Change>
std::string with_array(std::string bytes, const std::string& array, Change&& change) {
  const std::string name = array + ".npy";
  const std::size_t local = bytes.find(name) - 30, entry = bytes.rfind(name) - 46;
  const std::size_t begin =
      local + 30 + number_at(bytes, local + 26, 2) + number_at(bytes, local + 28, 2);
  const std::size_t size = number_at(bytes, entry + 24, 4);
  std::string data = bytes.substr(begin, size);
  change(data);
  const std::uint32_t sum = checksum(data);
  bytes.replace(begin, size, data);
  std::memcpy(bytes.data() + local + 14, &sum, sizeof(sum));
  std::memcpy(bytes.data() + entry + 16, &sum, sizeof(sum));
  return bytes;
}

TEST(LearnedWeights, AreThoseOfTheFileInTheFolder) {
  const auto file = learned::read_weights(WEFT_LEARNED_WEIGHTS);
  const auto built_in = learned::built_in_weights();
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_TRUE(built_in) << built_in.error().message;
  EXPECT_EQ(file->input, built_in->input);
  EXPECT_EQ(file->fit_biases[1], built_in->fit_biases[1]);
  EXPECT_GT(file->blocks[5].weight.norm(), 0.0F);
}

TEST(LearnedWeights, RefuseAShortFile) {
  const std::string whole = shipped();
  ASSERT_EQ(refusal(whole), "");
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{10}, whole.size() / 2, whole.size() - 30}) {
    const std::string why = refusal(whole.substr(0, size));
    EXPECT_THAT(why, HasSubstr("some.npz")) << size;
    EXPECT_THAT(why, HasSubstr("train.py")) << size;
  }
}

TEST(LearnedWeights, RefuseDamagedBytesAndNameTheArray) {
  std::string bytes = shipped();
  const std::size_t at = bytes.find("blocks.2.linear.weight.npy");
  ASSERT_NE(at, std::string::npos);
  bytes[at + 1000] = static_cast<char>(bytes[at + 1000] ^ 0x40);
  EXPECT_THAT(refusal(bytes), HasSubstr("damaged at blocks.2.linear.weight"));
}

TEST(LearnedWeights, RefuseAnotherNetwork) {
  for (const char* array : {"blocks.5.gain", "heads.0.weight", "input.bias"}) {
    std::string bytes = shipped(), other = array;
    other.back() = '_';
    // The name is in the header of the member and in the directory at the end.
    bytes = replaced(replaced(bytes, array, other), array, other);
    EXPECT_THAT(refusal(bytes), HasSubstr(std::string(array) + " is missing")) << array;
  }
}

TEST(LearnedWeights, RefuseValuesThatAreNotFinite) {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const std::string bytes = with_array(shipped(), "blocks.1.shift", [&](std::string& data) {
      std::memcpy(data.data() + data.size() - 8, &value, sizeof(value));
    });
    EXPECT_THAT(refusal(bytes), HasSubstr("blocks.1.shift has a value that is not finite"));
  }
  const std::string legal = with_array(shipped(), "blocks.1.shift", [](std::string& data) {
    data[data.size() - 8] = static_cast<char>(data[data.size() - 8] ^ 1);
  });
  EXPECT_EQ(refusal(legal), "");
}

TEST(LearnedWeights, RefuseOtherShapesAndFormats) {
  const std::string shape = with_array(shipped(), "blocks.3.linear.weight", [](std::string& data) {
    data = replaced(data, "(64, 64), } ", "(32, 128), }");
  });
  EXPECT_THAT(refusal(shape), HasSubstr("blocks.3.linear.weight is f32 [32,128], not f32 [64,64]"));
  const std::string format =
      with_array(shipped(), "format", [](std::string& data) { data[data.size() - 4] = 9; });
  EXPECT_THAT(refusal(format), HasSubstr("format is 9, not 1"));
}

TEST(LearnedWeights, AreReadFromTheParameterWeights) {
  const std::string path = ::testing::TempDir() + "weights_short.npz";
  const std::string whole = shipped();
  std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() / 3);
  const auto missing = learned::read_weights("/nowhere/weights.npz");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("/nowhere/weights.npz"));
  const auto damaged = learned::read_weights(path);
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message, HasSubstr("weights_short.npz"));
  const std::string legal = std::string("{weights: '") + WEFT_LEARNED_WEIGHTS + "'}";
  const LabelledMatches drawn = bent_matches({100, 0.5, 0.5, 2.0}, 0.2, 81);
  FilterBench built_in("filters/learned"), given("filters/learned", legal);
  const InlierMask first = built_in.mask(drawn.matches), other = given.mask(drawn.matches);
  for (std::int64_t i = 0; i < 100; ++i) ASSERT_EQ(other.score(i), first.score(i)) << i;
}

}  // namespace
}  // namespace weft::testing
