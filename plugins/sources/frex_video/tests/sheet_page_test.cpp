// SPDX-License-Identifier: Apache-2.0
// The PDF of `weft data make frex --sheet`, read back, against the image beside it.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <weft/core/index.hpp>

#include "filmed_sheet.hpp"
#include "support/child.hpp"

namespace weft::testing {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;

/// The text between the first `before` at or behind `from` and the next `after`.
std::string between(const std::string& text, const std::string& before, const std::string& after,
                    std::size_t from = 0) {
  const std::size_t start = text.find(before, from);
  if (start == text.npos) return {};
  const std::size_t begin = start + before.size();
  return text.substr(begin, text.find(after, begin) - begin);
}

std::vector<double> numbers(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<double>(words), {}};
}

class SheetPage : public ::testing::Test {
 protected:
  /// The PDF of the markers of this seed, as text.
  std::string printed(const std::string& name, int seed) const {
    const Ended ended =
        Child({WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS, "data", "make", "frex", "--sheet",
               folder_.path(name + ".pdf"), "--seed", std::to_string(seed)},
              folder_.path("said"))
            .wait();
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    std::ifstream stream(folder_.path(name + ".pdf"), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  FrameFolder folder_;
};

TEST_F(SheetPage, HasTheMarkersOfThePictureAtExactSize) {
  const std::string pdf = printed("sheet", 5);
  EXPECT_THAT(numbers(between(pdf, "/MediaBox [", "]")),
              ::testing::Pointwise(::testing::DoubleNear(1e-4),
                                   {0.0, 0.0, 297.0 * kPointsPerMm, 210.0 * kPointsPerMm}));
  std::istringstream lines(between(pdf, "stream\n", "endstream"));
  std::string line;
  std::getline(lines, line);
  EXPECT_TRUE(line.ends_with(" cm"));
  EXPECT_THAT(numbers(line), ::testing::Pointwise(::testing::DoubleNear(1e-4),
                                                  {kPointsPerMm, 0.0, 0.0, -kPointsPerMm, 0.0,
                                                   210.0 * kPointsPerMm}))
      << "millimetres from the top left corner, downwards";
  const cv::Mat picture = cv::imread(folder_.path("sheet.png"), cv::IMREAD_GRAYSCALE);
  const double px_per_mm = picture.cols / 297.0;
  cv::Mat page(picture.size(), CV_8U, cv::Scalar(255));
  int bars = 0;
  while (std::getline(lines, line)) {
    const std::vector<double> n = numbers(line);
    if (line.ends_with(" re f")) {
      const auto px = [&](int k) {
        return static_cast<int>(std::lround(n.at(to_index(k)) * px_per_mm));
      };
      page(cv::Rect(px(0), px(1), px(2), px(3))) = 0;
    }
    const std::size_t way = line.find(" w ");
    if (way == line.npos) continue;
    const auto from = numbers(line.substr(way + 3));
    const auto to = numbers(between(line, " m ", " l S"));
    if (from.at(1) == to.at(1)) bars += std::abs(to.at(0) - from.at(0) - 100.0) < 1e-6;
  }
  EXPECT_EQ(cv::norm(page, picture, cv::NORM_INF), 0.0);
  EXPECT_EQ(bars, 1) << "the bar of 100 mm";
}

TEST_F(SheetPage, IsAWholePdfAndTheSameBytesForTheSameSeed) {
  const std::string pdf = printed("sheet", 5);
  EXPECT_TRUE(pdf.starts_with("%PDF-1.4\n") && pdf.ends_with("%%EOF\n"));
  const auto place = to_index(numbers(between(pdf, "startxref\n", "\n")).at(0));
  ASSERT_EQ(pdf.compare(place, 11, "xref\n0 5\n00"), 0);
  for (std::size_t object = 1; object < 5; ++object) {
    const auto offset = numbers(pdf.substr(place + 9 + 20 * object, 10)).at(0);
    const std::string head = std::to_string(object) + " 0 obj\n";
    EXPECT_EQ(pdf.compare(to_index(offset), head.size(), head), 0) << object;
  }
  EXPECT_EQ(static_cast<double>(between(pdf, "stream\n", "endstream").size()),
            numbers(between(pdf, "/Length ", " >>")).at(0));
  EXPECT_EQ(between(pdf, "Tm (", ") Tj"),
            "Print at 100 %, without scaling: the bar is 100 mm.   Weft FREX page, 100 markers "
            "5x5_250, seed 5");
  EXPECT_EQ(printed("again", 5), pdf);
  EXPECT_NE(printed("other", 6), pdf);
}

}  // namespace
}  // namespace weft::testing
