// SPDX-License-Identifier: Apache-2.0
#include "match_files.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "match_folder.hpp"

namespace weft::matches {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using weft::testing::FrameFolder;
using weft::testing::npy;
using weft::testing::write_archive;

const std::string kHeader = "template_x_px,template_y_px,image_x_px,image_y_px,label\n";

std::string refusal_of(const std::string& content) {
  const FrameFolder folder;
  folder.write("a.csv", content);
  const auto table = read_match_csv(folder.path("a.csv"));
  EXPECT_FALSE(table) << content;
  return table ? "" : table.error().message;
}

TEST(MatchCsv, IsReadWithForeignLineEndsAndSpaces) {
  const FrameFolder folder;
  folder.write("a.csv",
               "\xEF\xBB\xBFimage_x_px, image_y_px,template_x_px,\ttemplate_y_px\r\n\r\n"
               "1 , 2,3,-4e-1\r\n");
  const auto table = read_match_csv(folder.path("a.csv"));
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_EQ(table->rows(), 1U);
  EXPECT_EQ((*table)[Column::image_x_px][0], 1.0);
  EXPECT_EQ((*table)[Column::template_y_px][0], -0.4);
}

TEST(MatchCsv, IsReadAsSpreadsheetsQuoteIt) {
  const FrameFolder folder;
  folder.write("a.csv",
               "\xEF\xBB\xBF\"image_x_px\",\"image_y_px\" ,template_x_px,\"template_y_px\"\r\n"
               "\"+1.5\", \"2\",.5,3.\r\n\r\n  \r\n");
  const auto table = read_match_csv(folder.path("a.csv"));
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_EQ(table->rows(), 1U);
  EXPECT_EQ((*table)[Column::image_x_px][0], 1.5);
  EXPECT_EQ((*table)[Column::image_y_px][0], 2.0);
  EXPECT_EQ((*table)[Column::template_x_px][0], 0.5);
  EXPECT_EQ((*table)[Column::template_y_px][0], 3.0);
}

TEST(MatchCsv, NamesOtherSeparatorsAndQuotesThatDoNotFit) {
  EXPECT_THAT(refusal_of("image_x_px;image_y_px\n1,5;2,5\n"),
              HasSubstr(":1:1: separates its columns by semicolons"));
  EXPECT_THAT(refusal_of("image_x_px\timage_y_px\n1\t2\n"), HasSubstr("by tabs"));
  EXPECT_THAT(refusal_of("\xFF\xFEi\0m\0"), HasSubstr("is UTF-16"));
  EXPECT_THAT(refusal_of(kHeader + "\"1,2,3,4,1\n"), HasSubstr(":2:1: has a quote that is not"));
  EXPECT_THAT(refusal_of(kHeader + "\"1\"0,2,3,4,1\n"), HasSubstr("behind a closing quote"));
  EXPECT_THAT(refusal_of(kHeader + "\"x\"\"y\",2,3,4,1\n"), HasSubstr("not 'x\"y'"));
}

TEST(MatchCsv, RefusesValuesWithLineAndColumn) {
  EXPECT_THAT(refusal_of(kHeader + "1,2,3,4,1\n1,2,nan,4,1\n"),
              AllOf(HasSubstr("a.csv:3:5: 'image_x_px' must be a finite number, not 'nan'")));
  EXPECT_THAT(refusal_of(kHeader + "1,2,3,4,2\n"), HasSubstr(":2:9: 'label' must be 1 (correct)"));
  EXPECT_THAT(refusal_of(kHeader + "1,2,3,4px,1\n"), HasSubstr(":2:7: 'image_y_px' must be"));
  EXPECT_THAT(refusal_of(kHeader + "1,,3,4,1\n"), HasSubstr(":2:3: 'template_y_px' must be"));
  EXPECT_THAT(refusal_of(kHeader + "1,1e999,3,4,1\n"), HasSubstr("'1e999'"));
  EXPECT_THAT(refusal_of(kHeader + "1,2,3,4\n"), HasSubstr(":2:7: has 4 fields where"));
  EXPECT_THAT(refusal_of("frame," + kHeader + "0.5,1,2,3,4,1\n"), HasSubstr("a whole number"));
  EXPECT_THAT(refusal_of("frame," + kHeader + "1e9,1,2,3,4,1\n"), HasSubstr("from 0 to 999999"));
  EXPECT_THAT(refusal_of("kept," + kHeader + "2,1,2,3,4,1\n"), HasSubstr("must be 0 or 1"));
}

TEST(MatchCsv, RefusesHeadersWithTheFix) {
  EXPECT_THAT(refusal_of(""), HasSubstr("a.csv:1:1: is empty"));
  EXPECT_THAT(refusal_of("lable," + kHeader), HasSubstr("did you mean 'label'?"));
  EXPECT_THAT(refusal_of("label," + kHeader), HasSubstr("'label' is given twice"));
  EXPECT_THAT(refusal_of("image_x_px,image_y_px\n"), HasSubstr("add template_x_px"));
  EXPECT_THAT(refusal_of("template_x_px,template_y_px\n"), HasSubstr("add image_x_px"));
  EXPECT_THAT(refusal_of("template_x_px,image_x_px,image_y_px\n"),
              HasSubstr("'template_y_px' is missing beside 'template_x_px'"));
  EXPECT_THAT(refusal_of("template_x_m,template_y_m," + kHeader), HasSubstr("remove one of"));
}

Array<double> places(double first) {
  Array<double> values({3, 2}, 0.0);
  for (std::int64_t i = 0; i < 6; ++i) values.data()[i] = first + 0.1 * static_cast<double>(i);
  return values;
}

TEST(MatchNpz, IsReadAsNumpyWritesIt) {
  const FrameFolder folder;
  Array<std::int64_t> labels({3}, 0);
  labels(0) = 1;
  labels(2) = -1;
  Array<float> scores({3}, 0.0F);
  scores(1) = 0.5F;
  write_archive(folder.path("a.npz"), {{"template_px.npy", npy(places(1.0))},
                                       {"image_px.npy", npy(places(2.0))},
                                       {"label.npy", npy(labels)},
                                       {"score.npy", npy(scores)}});
  const auto table = read_match_npz(folder.path("a.npz"));
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ((*table)[Column::template_y_px][2], 1.0 + 0.1 * 5.0);
  EXPECT_EQ((*table)[Column::image_x_px][1], 2.0 + 0.1 * 2.0);
  EXPECT_EQ((*table)[Column::label], (std::vector<double>{1, 0, -1}));
  EXPECT_EQ((*table)[Column::score][1], 0.5);
}

TEST(MatchNpz, IsReadFromRecordsWithTheirOwnTruth) {
  const FrameFolder folder;
  Array<std::int8_t> labels({3}, 0);
  labels(1) = 1;
  write_archive(folder.path("a.npz"),
                {{"correspondences/record_type.npy", npy(labels)},
                 {"correspondences/template_px.npy", npy(places(1.0))},
                 {"correspondences/image_px.npy", npy(places(2.0))},
                 {"correspondences/face.npy", npy(Array<std::int32_t>({3}, 0))},
                 {"correspondences/kept.npy", npy(Array<std::uint8_t>({3}, 0))},
                 {"ground_truth/points_m.npy", npy(Array<double>({1, 3}, 0.0))},
                 {"ground_truth/match_label.npy", npy(labels)},
                 {"shape/vertices_m.npy", npy(Array<double>({1, 3}, 0.0))}});
  const auto table = read_match_npz(folder.path("a.npz"));
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ((*table)[Column::label], (std::vector<double>{0, 1, 0}));
  EXPECT_EQ((*table)[Column::kept], (std::vector<double>{0, 0, 0}));
  EXPECT_EQ((*table)[Column::image_y_px][0], 2.0 + 0.1);
}

std::string refusal_of(const std::map<std::string, std::string>& members) {
  const FrameFolder folder;
  write_archive(folder.path("a.npz"), members);
  const auto table = read_match_npz(folder.path("a.npz"));
  EXPECT_FALSE(table);
  return table ? "" : table.error().message;
}

TEST(MatchNpz, RefusesArraysWithTheirName) {
  const std::pair<const std::string, std::string> here{"template_px.npy", npy(places(1.0))};
  EXPECT_THAT(refusal_of({here}), AllOf(HasSubstr("a.npz: the places in the image are missing"),
                                        HasSubstr("image_px")));
  EXPECT_THAT(refusal_of({here, {"image_px.npy", npy(Array<double>({2, 2}, 0.0))}}),
              HasSubstr("has 3 entries where the array before has 2"));
  EXPECT_THAT(refusal_of({here, {"image_px.npy", npy(Array<double>({3, 3}, 0.0))}}),
              HasSubstr("image_px.npy must be of shape [N,2]"));
  EXPECT_THAT(refusal_of({here, {"image_px.npy", "no array"}}), HasSubstr("ascontiguousarray"));
  EXPECT_THAT(refusal_of({here, {"lable.npy", npy(Array<double>({3}, 0.0))}}),
              HasSubstr("lable.npy is unknown"));
  Array<double> broken = places(2.0);
  broken(1, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of({here, {"image_px.npy", npy(broken)}}),
              HasSubstr("image_px.npy at 1 must be a finite number"));
}

TEST(MatchNpz, RefusesWhatIsNoArchive) {
  const FrameFolder folder;
  folder.write("a.npz", "PK no");
  const auto table = read_match_npz(folder.path("a.npz"));
  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().message, HasSubstr("a.npz: cannot be read as an npz file"));
}

}  // namespace
}  // namespace weft::matches
