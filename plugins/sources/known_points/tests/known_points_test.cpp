// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>

#include "film_of_a_sheet.hpp"

namespace weft::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kByFrame =
    "frame,vertex,X_mm,Y_mm,Z_mm,radius_mm\n"
    "2,7,10,-20,600,5\n"
    "2,9,30,-20,610,\n"
    "4,7,12,-20,600,5\n";

const std::string kByTime =
    "{\"time_s\": 0.20, \"vertex\": 7, \"X_mm\": 10, \"Y_mm\": 0, \"Z_mm\": 600}\n"
    "{\"time_s\": 0.34, \"vertex\": 7, \"X_mm\": 24, \"Y_mm\": 0, \"Z_mm\": 600}\n";

std::string row_at(double time_s, double x_mm) {
  return "{\"time_s\": " + std::to_string(time_s) +
         ", \"vertex\": 7, \"X_mm\": " + std::to_string(x_mm) + ", \"Y_mm\": 0, \"Z_mm\": 600}\n";
}

void expect_open(Film& film) {
  const PluginAnswer opened = film.open();
  ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
}

/// X of the only known point, mm; NaN without one.
double only_x_mm(const PluginAnswer& frame) {
  const auto known = frame.get<KnownPoints>();
  if (!known) return std::nan("");
  EXPECT_EQ(known->count(), 1);
  return 1e3 * known->points_m(0, 0);
}

TEST(KnownPointSource, GivesEachFrameItsRowsAndWhatTheOtherSourceKnows) {
  const Folder folder;
  Film film(folder.with("rows.csv", kByFrame));
  expect_open(film);
  EXPECT_EQ(film.count(), 10);
  const PluginAnswer second = film.read(2);
  ASSERT_EQ(second.status, WEFT_OK) << second.message;
  EXPECT_TRUE(second.get<Image>() && second.get<Time>() && second.get<GroundTruth>());
  const auto known = second.get<KnownPoints>();
  ASSERT_TRUE(known);
  ASSERT_EQ(known->count(), 2);
  EXPECT_EQ(known->vertex(0), 7);
  EXPECT_EQ(known->vertex(1), 9);
  EXPECT_NEAR(known->points_m(1, 0), 0.03, 1e-12);
  EXPECT_NEAR(known->points_m(1, 1), -0.02, 1e-12);
  EXPECT_NEAR(known->points_m(1, 2), 0.61, 1e-12);
  EXPECT_NEAR(known->radius_m(0), 0.005, 1e-12);
  EXPECT_LT(known->radius_m(1), 0.0);
  EXPECT_FALSE(film.read(3).get<KnownPoints>());
  EXPECT_NEAR(only_x_mm(film.read(4)), 12.0, 1e-9);
  EXPECT_EQ(film.read(2).get<KnownPoints>()->count(), 2);
}

TEST(KnownPointSource, RowsByTimeAreInterpolatedWithinTheTolerance) {
  const Folder folder;
  Film film(folder.with("rows.jsonl", kByTime), ", tolerance_s: 0.11");
  expect_open(film);
  EXPECT_FALSE(film.read(0).get<KnownPoints>());
  EXPECT_NEAR(only_x_mm(film.read(1)), 10.0, 1e-9);  // 0.1 s before the first row
  EXPECT_NEAR(only_x_mm(film.read(2)), 10.0, 1e-9);
  EXPECT_NEAR(only_x_mm(film.read(3)), 20.0, 1e-9);
  EXPECT_NEAR(only_x_mm(film.read(4)), 24.0, 1e-9);
  EXPECT_FALSE(film.read(5).get<KnownPoints>());

  Film strict(folder.path("rows.jsonl"), ", tolerance_s: 0.05, clock_offset_s: 0.04");
  expect_open(strict);
  EXPECT_NEAR(only_x_mm(strict.read(2)), 10.0, 1e-9);
  EXPECT_NEAR(only_x_mm(strict.read(3)), 24.0, 1e-9);
  EXPECT_FALSE(strict.read(1).get<KnownPoints>());
}

TEST(KnownPointSource, PointsOfTheTemplateAndStandardDeviationsAreRead) {
  const Folder folder;
  Film film(folder.with("rows.csv",
                        "Z_mm, X_mm, Y_mm, sigma_mm, template_y_mm, template_x_mm, frame\r\n"
                        "600, 1, 2, 2, 105, 0.5, 0\r\n\r\n"));
  expect_open(film);
  const auto known = film.read(0).get<KnownPoints>();
  ASSERT_TRUE(known);
  EXPECT_EQ(known->vertex(0), -1);
  EXPECT_NEAR(known->template_xy_m(0, 0), 0.0005, 1e-12);
  EXPECT_NEAR(known->template_xy_m(0, 1), 0.105, 1e-12);
  EXPECT_NEAR(known->radius_m(0), 2.795 * 0.002, 1e-12);
}

TEST(KnownPointSource, RowsOfARobotAreTakenToTheCamera) {
  const Folder folder;
  const std::string rows =
      folder.with("rows.csv", "frame,vertex,X_mm,Y_mm,Z_mm\n0,3,100,200,-300\n");
  // The robot's x is the camera's z, its y the camera's x, its z the camera's y.
  Film film(rows, ", camera_from_robot: [0, 1, 0, 0.01, 0, 0, 1, 0.02, 1, 0, 0, 0.5]");
  expect_open(film);
  const auto known = film.read(0).get<KnownPoints>();
  ASSERT_TRUE(known);
  EXPECT_NEAR(known->points_m(0, 0), 0.21, 1e-12);
  EXPECT_NEAR(known->points_m(0, 1), -0.28, 1e-12);
  EXPECT_NEAR(known->points_m(0, 2), 0.60, 1e-12);
  for (const char* wrong : {"[1, 2, 3]", "[2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]",
                            "[-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]"}) {
    EXPECT_THAT(Film(rows, std::string(", camera_from_robot: ") + wrong).open().message,
                HasSubstr("camera_from_robot"));
  }
  EXPECT_THAT(Film(rows).open().message, HasSubstr("rows.csv:2:1: the point is not before"));
}

TEST(KnownPointSource, MistakesInFilesAreNamedWithLineAndColumn) {
  const std::string head = "frame,vertex,X_mm,Y_mm,Z_mm\n";
  const std::vector<std::pair<std::string, std::string>> csv{
      {"", "rows.csv: has no rows"},
      {head, "rows.csv: has no rows"},
      {"frame,vertx,X_mm,Y_mm,Z_mm\n",
       ":1:7: the column 'vertx' is unknown; did you mean 'vertex'?"},
      {"frame,frame\n", ":1:7: the column 'frame' is given twice"},
      {"frame;vertex\n0;1,5\n", ":1:1: separates its columns by semicolons"},
      {head + "0,1,\"2,3,600\n", ":2:1: has a quote that is not closed"},
      {head + "\"0\",\"1\", \"x\",3,600\n", ":2:10: 'X_mm' must be a finite number, not 'x'"},
      {"frame,vertex,X_mm,Y_mm\n", ":1:1: the header needs 'Z_mm'"},
      {"vertex,X_mm,Y_mm,Z_mm\n", "needs one of 'time_s' and 'frame'"},
      {"frame,time_s,vertex,X_mm,Y_mm,Z_mm\n", "needs one of 'time_s' and 'frame'"},
      {"frame,template_x_mm,X_mm,Y_mm,Z_mm\n", "needs either 'vertex' or both"},
      {"frame,vertex,X_mm,Y_mm,Z_mm,sigma_mm,radius_mm\n", ":1:29: the header has both"},
      {head + "0,1,2,3\n", ":2:7: has 4 fields where the header has 5"},
      {head + "0,1,2,3,-4\n\n0,2, x,3,600\n", ":2:1: the point is not"},
      {head + "0,1,2,3,400\n\n0,2, x,3,600\n", ":4:6: 'X_mm' must be a finite number, not 'x'"},
      {head + "0,1.5,2,3,600\n", ":2:3: 'vertex' must be a whole number from 0"},
      {head + "0,-1,2,3,600\n", ":2:3: 'vertex' must be a whole number from 0"},
      {head + "0,1,nan,3,600\n", ":2:5: 'X_mm' must be a finite number"},
      {head + "3,1,2,3,600\n2,1,2,3,600\n", ":3:1: goes back"},
      {head + "3,1,2,3,600\n3,1,2,3,600\n", ":3:1: gives the same point twice"}};
  const Folder folder;
  for (const auto& [content, message] : csv) {
    const PluginAnswer opened = Film(folder.with("rows.csv", content)).open();
    EXPECT_EQ(opened.status, WEFT_ERROR) << content;
    EXPECT_THAT(opened.message, HasSubstr(message)) << content;
    EXPECT_THAT(opened.message, StartsWith(folder.path("rows.csv")));
  }
  const std::vector<std::pair<std::string, std::string>> json{
      {"{\"time_s\": 1, }\n", ":1:15: is not JSON"},
      {kByTime + "[1, 2]\n", ":3:1: must be an object"},
      {"{\"time_s\": 1, \"time_s\": 2}\n", ":1:2: 'time_s' is given twice"},
      {"{\"time_s\": 1e999}\n", ":1:1: has a number that is too large"},
      {"{\"time_s\": 1, \"X\": 2}\n", ":1:15: 'X' is unknown"},
      {"{\"time_s\": \"1\"}\n", ":1:2: 'time_s' must be a finite number"},
      {"{\"time_s\": 1, \"vertex\": 2, \"X_mm\": 1, \"Y_mm\": 1}\n", ":1:1: needs 'Z_mm'"},
      {kByTime + "{\"frame\": 1, \"vertex\": 2, \"X_mm\": 1, \"Y_mm\": 1, \"Z_mm\": 1}\n",
       ":3:1: mixes"}};
  for (const auto& [content, message] : json) {
    const PluginAnswer opened = Film(folder.with("rows.jsonl", content)).open();
    EXPECT_EQ(opened.status, WEFT_ERROR) << content;
    EXPECT_THAT(opened.message, HasSubstr(message)) << content;
  }
}

TEST(KnownPointSource, APipeIsReadAsFramesNeedIt) {
  const Folder folder;
  const std::string path = folder.with_pipe("robot");
  Film film(path, ", wait_ms: 60000");
  expect_open(film);
  const Writer writer(path);
  writer.say(row_at(0.0, 10.0) + row_at(0.05, 15.0) + row_at(0.12, 22.0));
  EXPECT_NEAR(only_x_mm(film.read(0)), 10.0, 1e-9);
  const PluginAnswer first = film.read(1);
  EXPECT_EQ(first.status, WEFT_OK) << first.message;
  EXPECT_NEAR(only_x_mm(first), 20.0, 1e-6);
  writer.say(row_at(0.25, 35.0));
  EXPECT_NEAR(only_x_mm(film.read(2)), 30.0, 1e-6);
}

TEST(KnownPointSource, APipeThatIsSilentOrHasEndedIsSaidSo) {
  const Folder folder;
  const std::string path = folder.with_pipe("robot");
  Film film(path, ", wait_ms: 20");
  expect_open(film);
  const PluginAnswer none = film.read(0);
  EXPECT_EQ(none.status, WEFT_DEGENERATE);
  EXPECT_THAT(none.message, HasSubstr("silent for 20 ms: no row has come"));
  EXPECT_TRUE(none.get<Image>());
  {
    const Writer writer(path);
    writer.say(row_at(0.1, 10.0));
    const PluginAnswer late = film.read(1);
    EXPECT_EQ(late.status, WEFT_DEGENERATE);  // a later row would have shown that this is all
    EXPECT_NEAR(only_x_mm(late), 10.0, 1e-9);
    writer.say(row_at(0.2, 20.0));
  }
  const PluginAnswer last = film.read(2);
  EXPECT_EQ(last.status, WEFT_OK) << last.message;
  EXPECT_NEAR(only_x_mm(last), 20.0, 1e-9);
  const PluginAnswer after = film.read(4);
  EXPECT_EQ(after.status, WEFT_DEGENERATE);
  EXPECT_THAT(after.message, HasSubstr("the pipe has ended: the last row has time 0.200000"));
  EXPECT_FALSE(after.get<KnownPoints>());
}

TEST(KnownPointSource, AMistakeInAPipeCostsOneFrame) {
  const Folder folder;
  const std::string path = folder.with_pipe("robot");
  Film film(path, ", wait_ms: 60000");
  expect_open(film);
  const Writer writer(path);
  writer.say(row_at(0.0, 10.0) + "\n{\"time_s\": 0.1, \"vertex\": }\n" + row_at(0.11, 11.0) +
             row_at(0.3, 30.0));
  const PluginAnswer broken = film.read(0);
  EXPECT_EQ(broken.status, WEFT_ERROR);
  EXPECT_THAT(broken.message, HasSubstr("robot:3:27: is not JSON"));
  const PluginAnswer next = film.read(1);
  EXPECT_EQ(next.status, WEFT_OK) << next.message;
  EXPECT_NEAR(only_x_mm(next), 11.0 - 0.1, 1.0);
  EXPECT_NEAR(only_x_mm(film.read(2)), 20.0, 1.0);
}

TEST(KnownPointSource, WhatIsMissingIsSaidAtTheStart) {
  const Folder folder;
  EXPECT_THROW(Film(folder.path("none.csv")), std::runtime_error);
  const PluginAnswer broken =
      Film(folder.with("rows.csv", kByFrame), "", "frames: 10, cut_frames: [10]").open();
  EXPECT_EQ(broken.status, WEFT_ERROR);
  EXPECT_THAT(broken.message, HasSubstr("cut_frames"));
}

}  // namespace
}  // namespace weft::testing
