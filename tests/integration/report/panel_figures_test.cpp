// SPDX-License-Identifier: Apache-2.0
#include "lab/report/panel_figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <stdexcept>

#include "fake_results.hpp"
#include "lab/report/drawing/colours.hpp"
#include "lab/report/sheets.hpp"

namespace weft::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Results results_of(const FakeResults& fake) {
  auto results = read_results(fake.folder());
  if (!results) throw std::runtime_error(results.error().message);
  return *std::move(results);
}

ReportTables made(const Results& results) {
  auto tables = make_tables(results);
  if (!tables) throw std::runtime_error(tables.error().message);
  return *std::move(tables);
}

template <class T>
std::vector<T> marks_of(const Drawing& drawing) {
  std::vector<T> marks;
  for (const Mark& mark : drawing.marks) {
    if (const T* one = std::get_if<T>(&mark)) marks.push_back(*one);
  }
  return marks;
}

std::vector<std::string> texts_of(const Drawing& drawing) {
  std::vector<std::string> texts;
  for (const TextMark& text : marks_of<TextMark>(drawing)) texts.push_back(text.text);
  return texts;
}

TEST(PanelFigures, RankTheValuesOfAnAxisBestFirst) {
  const Results results = results_of(FakeResults({}));
  const PanelFigure figure = ranking_figure(made(results).comparisons.at(0));
  ASSERT_THAT(figure.panels, SizeIs(1));
  EXPECT_EQ(figure.name(), "ranking-filter-steady");
  const std::vector<std::string> texts = texts_of(figure.drawing());
  const auto place = [&](const char* name) {
    return std::find(texts.begin(), texts.end(), name) - texts.begin();
  };
  EXPECT_LT(place("steady"), place("shaky"));
  EXPECT_LT(place("shaky"), place("broken"));
  EXPECT_THAT(texts, ::testing::Contains("no value in 640 results"));
  EXPECT_THAT(texts, ::testing::Contains(HasSubstr(", n 8")));
  const auto dots = marks_of<DotMark>(figure.drawing());
  ASSERT_THAT(dots, SizeIs(2)) << "broken has no value";
  EXPECT_FALSE(dots[0].hollow);
  EXPECT_LT(dots[0].centre.x, dots[1].centre.x);
}

TEST(PanelFigures, HaveAPanelForEachConditionOverOneScale) {
  FakeResults fake({});
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["axes"][1].erase("swept");
  fake.write("plan.json", plan);
  const Results results = results_of(fake);
  const ComparisonResult comparison = made(results).comparisons.at(0);
  ASSERT_THAT(comparison.separate, SizeIs(1));
  const PanelFigure figure = conditions_figure(comparison, comparison.separate[0]);
  ASSERT_THAT(figure.panels, SizeIs(4));
  EXPECT_THAT(texts_of(figure.panels[1]), ::testing::Contains("alpha 0.1"));
  // The same error in each: the same place.
  EXPECT_EQ(marks_of<DotMark>(figure.panels[0])[0].centre.x,
            marks_of<DotMark>(figure.panels[3])[0].centre.x);
  const Drawing whole = figure.drawing();
  EXPECT_THAT(marks_of<DotMark>(whole), SizeIs(8));
  EXPECT_GT(whole.width_px, 2 * figure.panels[0].width_px);
  EXPECT_GT(whole.height_px, 2 * figure.panels[0].height_px);
}

TEST(PanelFigures, TurnEachPairBothWaysInTheMatrix) {
  FakeResults fake({});
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["comparisons"][0].erase("reference");
  fake.write("plan.json", plan);
  ReportTables tables = made(results_of(fake));
  ComparisonResult& comparison = tables.comparisons.at(0);
  for (PairComparison& pair : comparison.table.pairs) {
    if (pair.b == "broken") continue;
    pair.test.mean = pair.a == "steady" ? -0.5 : 0.5;
    pair.interval = pair.a == "steady" ? Interval{-0.75, -0.25} : Interval{0.25, 0.75};
    pair.p_holm = 0.0078;
    pair.verdict = pair.a == "steady" ? Call::a : Call::b;
  }
  const TextTable matrix = matrix_sheet(comparison);
  ASSERT_THAT(matrix.rows, SizeIs(3));
  EXPECT_EQ(matrix.columns[1].name, "steady");
  EXPECT_EQ(matrix.rows[0].cells[2].shown, "-0.5\n[-0.75, -0.25]\np 0.0078");
  EXPECT_STREQ(matrix.rows[0].cells[2].tint, "better");
  EXPECT_EQ(matrix.rows[1].cells[1].shown, "0.5\n[0.25, 0.75]\np 0.0078");
  EXPECT_STREQ(matrix.rows[1].cells[1].tint, "worse");
  EXPECT_EQ(matrix.rows[1].cells[3].shown, "–");
  EXPECT_EQ(matrix.rows[2].cells[3].shown, "");
  comparison.plan.reference = "steady";
  EXPECT_THAT(matrix_sheet(comparison).rows, IsEmpty());
}

TEST(PanelFigures, ShowAMetricOfThePlanWhereNothingHasTruth) {
  FakeResults fake({});
  nlohmann::json plan = nlohmann::json::parse(fake.read("plan.json"));
  plan["show"] = {"filters.tpr_percent"};
  plan["comparisons"] = nlohmann::json::array();
  fake.write("plan.json", plan);
  const Results results = results_of(fake);
  ReportTables tables = made(results);
  for (Combination& each : tables.combinations) each.mean_mm = kUnknown;
  const PanelFigure figure = ranking_figure(results, tables);
  EXPECT_THAT(texts_of(figure.drawing()),
              ::testing::Contains(HasSubstr("mismatches rejected (TPR)")));
  // The largest rate is the best one.
  const auto dots = marks_of<DotMark>(figure.drawing());
  ASSERT_THAT(dots, SizeIs(8));
  EXPECT_GT(dots.front().centre.x, dots.back().centre.x);
}

TEST(PanelFigures, ShowBothRatesOfEachCombination) {
  ReportTables tables = made(results_of(FakeResults({})));
  const PanelFigure figure = rates_figure(tables, "filters");
  EXPECT_THAT(marks_of<DotMark>(figure.drawing()), SizeIs(16)) << "eight combinations";
  EXPECT_THAT(rates_figure(tables, "other").panels, IsEmpty());
}

TEST(PanelFigures, AreInAPageWithTheCommandThatWritesTheirFiles) {
  const Results results = results_of(FakeResults({}));
  const std::string html =
      to_html(ranking_figure(made(results).comparisons.at(0)), paper_note("results/a b"));
  EXPECT_THAT(html, HasSubstr("<figure id=\"figure-ranking-filter-steady\">"));
  EXPECT_THAT(html, HasSubstr("weft report 'results/a b' --paper"));
  EXPECT_THAT(html, HasSubstr("ranking-filter-steady.*"));
  EXPECT_THAT(html, HasSubstr("var(--series-1)"));
}

TEST(Drawing, HasTheColoursOfThePages) {
  std::ifstream stream(WEFT_WEB "/src/tokens.css");
  const std::string css{std::istreambuf_iterator<char>(stream), {}};
  for (const char* name :
       {"paper", "ink", "muted", "rule", "rule-strong", "series-1", "series-2", "series-3",
        "series-4", "series-5", "series-6", "series-7", "series-8"}) {
    std::smatch found;
    ASSERT_TRUE(std::regex_search(css, found, std::regex(std::string("--") + name + ": #(\\w+);")));
    EXPECT_EQ(rgb_of(name), found[1].str()) << name;
  }
}

TEST(Drawing, EscapesTextsAndCountsUpwardsInPgf) {
  const Drawing drawing{"name", "A <title>", 100, 40, {TextMark{{10, 30}, "50 % <a_b>"}}};
  EXPECT_THAT(to_svg_file(drawing, "origin & more"), HasSubstr("50 % &lt;a_b&gt;"));
  EXPECT_THAT(to_svg_file(drawing, "origin & more"), HasSubstr("<desc>origin &amp; more</desc>"));
  const std::string pgf = to_pgf(drawing, "origin\nsecond line");
  EXPECT_THAT(pgf, HasSubstr("% A <title>\n% origin\n% second line\n"));
  EXPECT_THAT(pgf, HasSubstr("at=\\pgfpoint{7.50pt}{7.50pt}"));
  EXPECT_THAT(pgf, HasSubstr("50 \\% <a\\_b>"));
}

TEST(Drawing, ShortensTextsAtWholeCharacters) {
  EXPECT_EQ(shortened("short", 100.0), "short");
  const std::string text = shortened("−−−−−−−−−−", 40.0);
  EXPECT_LE(text_width_px(text), 40.0);
  EXPECT_EQ(text.size() % 3, 0U) << "each minus and the dots have three bytes";
}

TEST(Scale, HasRoundTicksAndIsLogarithmicWhereValuesDifferMuch) {
  EXPECT_THAT(Scale(domain_of({0.3, 2.1}, true), 0.0, 100.0).ticks(),
              ElementsAre(0, 0.5, 1, 1.5, 2));
  const Domain wide = domain_of({1.0, 1.5, 1.2, 900.0}, true);
  EXPECT_TRUE(wide.log);
  const Scale scale(wide, 0.0, 100.0);
  EXPECT_THAT(scale.ticks(), ElementsAre(1, 10, 100));
  EXPECT_LT(scale.at(1.0), scale.at(10.0));
  EXPECT_FALSE(domain_of({-1.0, 0.5, 900.0}, true).log) << "zero has no logarithm";
}

}  // namespace
}  // namespace weft::lab
