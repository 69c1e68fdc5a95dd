// SPDX-License-Identifier: Apache-2.0
#include "common/inference/same_template.hpp"

#include <gmock/gmock.h>

#include <weft/data/matrix.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/inference/hash.hpp"

namespace weft::inference {
namespace {

using ::testing::HasSubstr;

NetworkFile file_of(const Template& templ) {
  NetworkFile file;
  file.path = "net.yaml";
  file.templ = {0.297, 0.178, texture_hash(templ.texture)};
  return file;
}

std::string why_other(const NetworkFile& file, const Template& templ) {
  const auto sheet = flat_sheet(templ);
  if (!sheet) return sheet.error().message;
  const auto same = check_same_template(file, templ, *sheet);
  return same ? "" : same.error().message;
}

TEST(TextureHash, IsThatOfXxh3) {
  // Values of the Python package xxhash.
  Array<std::uint8_t> texture({2, 2});
  std::copy_n("weft", 4, texture.data());
  EXPECT_EQ(texture_hash(texture), "15d05235f1304082");
  EXPECT_EQ(hash_of("weft"), "15d05235f1304082");
  EXPECT_EQ(hash_of(""), "2d06800538d394c2");
}

TEST(TextureHash, LeavesOutThePaddingOfRows) {
  const std::uint8_t padded[] = {'w', 'e', 9, 'f', 't', 9};
  const auto texture = Array<std::uint8_t>::borrow(padded, 2, {2, 2}, 3);
  EXPECT_EQ(texture_hash(texture), hash_of("weft"));
}

TEST(SameTemplate, IsOneOfTheSameSizeAndTexture) {
  const Template templ = weft::testing::make_template();
  EXPECT_EQ(why_other(file_of(templ), templ), "");
  const auto sheet = flat_sheet(templ);
  ASSERT_TRUE(sheet);
  EXPECT_NEAR(sheet->size_m.x(), 0.297, 1e-12);
  EXPECT_NEAR(sheet->texel({0.0, 1.0}).x(), -0.5, 1e-9);
  EXPECT_NEAR(sheet->texel({0.0, 1.0}).y(), 574.5, 1e-9);
}

TEST(SameTemplate, IsRefusedByNameOtherwise) {
  Template templ = weft::testing::make_template();
  NetworkFile file = file_of(templ);
  file.templ.width_m *= 1.0 + 3e-6;
  EXPECT_THAT(why_other(file, templ), HasSubstr("trained for another template: 0.297"));
  file = file_of(templ);
  file.templ.width_m *= 1.0 + 3e-7;
  EXPECT_EQ(why_other(file, templ), "");
  templ.texture(3, 4) ^= 1U;
  EXPECT_THAT(why_other(file, templ), HasSubstr("its texture has the hash"));
}

TEST(SameTemplate, MustBeFlatAndUpright) {
  Template templ = weft::testing::make_template();
  const NetworkFile file = file_of(templ);
  templ.vertices_m(7, 2) = 0.001;
  EXPECT_THAT(why_other(file, templ), HasSubstr("is not flat at rest"));
  templ.vertices_m(7, 2) = 0.0;
  templ.flat_px.matrix<2>().col(0).reverseInPlace();
  EXPECT_THAT(why_other(file, templ), HasSubstr("turned or distorted"));
  templ.texture = {};
  EXPECT_THAT(why_other(file, templ), HasSubstr("no texture"));
}

}  // namespace
}  // namespace weft::inference
