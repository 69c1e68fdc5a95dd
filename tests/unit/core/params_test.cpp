// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>
#include <weft/core/params.hpp>

namespace weft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

enum class Metric { l2, hamming };

/// A component that reads a parameter of every kind.
struct Everything {
  explicit Everything(Params& p) {
    p.read("radius_px", radius_px, "px", {1, 1000}, "a radius");
    p.read("rounds", rounds, "", {1, 10}, "how often");
    p.read("big", big, "bytes", {0, 1e15}, "a large number");
    p.read("fast", fast, "whether to hurry");
    p.read("levels", levels, "m", {0, 1}, "some numbers");
    p.text("title", title, "a name");
    p.input_path("table", table, "a file", Need::required);
    p.output_path("report", report, "another file");
    p.labels("apart", labels, "names and texts");
    p.choice("metric", metric, {{"l2", Metric::l2}, {"hamming", Metric::hamming}}, "a word");
    p.component("warp", warp, "a component");
    p.read("cuts", cuts, "frames", {0, 1e15}, "some whole numbers");
    p.read("threads", threads, "", {1, 1e12}, "more of them");
    p.read("parts", parts, "some texts");
  }

  double radius_px = 60.5;
  int rounds = 3;
  std::int64_t big = 5000000000;
  bool fast = true;
  std::vector<double> levels{0.25, 0.5};
  std::string title = "none";
  std::string table;
  std::string report;
  std::vector<std::pair<std::string, std::string>> labels;
  Metric metric = Metric::hamming;
  ComponentHandle warp{"warps", "warps/bbs"};
  std::vector<std::int64_t> cuts{5000000000, 7};
  std::vector<int> threads{2};
  std::vector<std::string> parts{"left", "right"};
};

/// A copy of one parameter that describe() declared.
struct Declared {
  std::string name, unit, help, role, text;
  int type = 0;
  bool is_vector = false, required = false;
  double minimum = 0.0, maximum = 0.0;
  std::vector<double> numbers;
  std::vector<std::string> choices, texts;
};

template <class Component>
std::vector<Declared> declared_by() {
  std::vector<Declared> all;
  const auto keep_type = [](void*, const char*) {};
  const weft_describe sink{
      sizeof(weft_describe),
      0,
      &all,
      [](void* context, const weft_parameter* p) {
        const weft_value& value = p->default_value;
        Declared declared;
        declared.name = value.name;
        declared.unit = p->unit;
        declared.help = p->help;
        declared.role = p->role;
        declared.type = value.type;
        declared.is_vector = value.is_vector != 0;
        declared.required = p->required != 0;
        declared.minimum = p->minimum;
        declared.maximum = p->maximum;
        for (std::uint64_t i = 0; i < value.count; ++i) {
          if (value.type == WEFT_VALUE_F64) {
            declared.numbers.push_back(static_cast<const double*>(value.data)[i]);
          } else if (value.type == WEFT_VALUE_I64) {
            declared.numbers.push_back(
                static_cast<double>(static_cast<const std::int64_t*>(value.data)[i]));
          } else if (value.type == WEFT_VALUE_BOOL) {
            declared.numbers.push_back(static_cast<const std::uint8_t*>(value.data)[i]);
          } else {
            declared.text = static_cast<const char* const*>(value.data)[i];
            declared.texts.push_back(declared.text);
          }
        }
        declared.choices.assign(p->choices, p->choices + p->choice_count);
        static_cast<std::vector<Declared>*>(context)->push_back(declared);
      },
      keep_type,
      nullptr};
  Params params(&sink);
  Component component(params);
  return all;
}

/// A component with what it reads from `values`, and the first thing that was wrong.
template <class Component>
std::pair<Component, std::string> read_with(const std::vector<weft_value>& values) {
  Params params(values.data(), values.size());
  Component component(params);
  return {component, params.status() ? "" : params.status().error().message};
}

TEST(Params, DescribesEveryKindWithItsDefault) {
  const std::vector<Declared> all = declared_by<Everything>();
  ASSERT_EQ(all.size(), 14U);
  const int types[] = {WEFT_VALUE_F64,        WEFT_VALUE_I64,         WEFT_VALUE_I64,
                       WEFT_VALUE_BOOL,       WEFT_VALUE_F64,         WEFT_VALUE_TEXT,
                       WEFT_VALUE_INPUT_PATH, WEFT_VALUE_OUTPUT_PATH, WEFT_VALUE_LABELS,
                       WEFT_VALUE_CHOICE,     WEFT_VALUE_COMPONENT,   WEFT_VALUE_I64,
                       WEFT_VALUE_I64,        WEFT_VALUE_TEXT};
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].type, types[i]) << all[i].name;
  EXPECT_EQ(all[0].name, "radius_px");
  EXPECT_EQ(all[0].unit, "px");
  EXPECT_EQ(all[0].help, "a radius");
  EXPECT_EQ(all[0].minimum, 1.0);
  EXPECT_EQ(all[0].maximum, 1000.0);
  EXPECT_THAT(all[0].numbers, ElementsAre(60.5));
  EXPECT_THAT(all[1].numbers, ElementsAre(3.0));
  EXPECT_THAT(all[2].numbers, ElementsAre(5e9));
  EXPECT_THAT(all[3].numbers, ElementsAre(1.0));
  EXPECT_TRUE(all[4].is_vector);
  EXPECT_THAT(all[4].numbers, ElementsAre(0.25, 0.5));
  EXPECT_EQ(all[5].text, "none");
  EXPECT_TRUE(all[6].required);
  EXPECT_FALSE(all[5].required);
  EXPECT_THAT(all[9].choices, ElementsAre("l2", "hamming"));
  EXPECT_EQ(all[9].text, "hamming");
  EXPECT_EQ(all[10].role, "warps");
  EXPECT_EQ(all[10].text, "warps/bbs");
  for (const std::size_t list : {11, 12, 13}) EXPECT_TRUE(all[list].is_vector);
  EXPECT_THAT(all[11].numbers, ElementsAre(5e9, 7.0));
  EXPECT_EQ(all[11].maximum, 1e15);
  EXPECT_THAT(all[12].numbers, ElementsAre(2.0));
  EXPECT_EQ(all[12].maximum, std::numeric_limits<int>::max());
  EXPECT_THAT(all[13].texts, ElementsAre("left", "right"));
}

TEST(Params, BindsEveryKind) {
  const double radius = 2.5, levels[] = {0.1, 0.2, 0.3};
  const std::int64_t rounds = 7, big = 1;
  const std::uint8_t fast = 0;
  const char *title = "a title", *table = "/t", *report = "/r", *metric = "l2";
  const char* labels[] = {"009", "texture source", "010", ""};
  const std::uint64_t warp = 17;
  const std::int64_t cuts[] = {0, 900000000000001}, threads[] = {4, 5, 6};
  const char* parts[] = {"", "front side"};
  const auto [read, problem] =
      read_with<Everything>({{"warp", WEFT_VALUE_COMPONENT, 0, 1, &warp, {}},
                             {"radius_px", WEFT_VALUE_F64, 0, 1, &radius, {}},
                             {"rounds", WEFT_VALUE_I64, 0, 1, &rounds, {}},
                             {"big", WEFT_VALUE_I64, 0, 1, &big, {}},
                             {"fast", WEFT_VALUE_BOOL, 0, 1, &fast, {}},
                             {"levels", WEFT_VALUE_F64, 1, 3, levels, {}},
                             {"title", WEFT_VALUE_TEXT, 0, 1, &title, {}},
                             {"table", WEFT_VALUE_INPUT_PATH, 0, 1, &table, {}},
                             {"report", WEFT_VALUE_OUTPUT_PATH, 0, 1, &report, {}},
                             {"apart", WEFT_VALUE_LABELS, 0, 4, labels, {}},
                             {"cuts", WEFT_VALUE_I64, 1, 2, cuts, {}},
                             {"threads", WEFT_VALUE_I64, 1, 3, threads, {}},
                             {"parts", WEFT_VALUE_TEXT, 1, 2, parts, {}},
                             {"metric", WEFT_VALUE_CHOICE, 0, 1, &metric, {}}});
  EXPECT_EQ(problem, "");
  EXPECT_THAT(read.cuts, ElementsAre(0, 900000000000001));
  EXPECT_THAT(read.threads, ElementsAre(4, 5, 6));
  EXPECT_THAT(read.parts, ElementsAre("", "front side"));
  EXPECT_EQ(read.radius_px, 2.5);
  EXPECT_EQ(read.rounds, 7);
  EXPECT_EQ(read.big, 1);
  EXPECT_FALSE(read.fast);
  EXPECT_THAT(read.levels, ElementsAre(0.1, 0.2, 0.3));
  EXPECT_EQ(read.title, "a title");
  EXPECT_EQ(read.table, "/t");
  EXPECT_EQ(read.report, "/r");
  ASSERT_EQ(read.labels.size(), 2U);
  EXPECT_EQ(read.labels[0], std::make_pair(std::string("009"), std::string("texture source")));
  EXPECT_EQ(read.metric, Metric::l2);
  EXPECT_EQ(read.warp.handle, 17U);
}

TEST(Params, WhatIsNotGivenKeepsItsDefault) {
  const char* table = "/t";
  const auto [read, problem] =
      read_with<Everything>({{"table", WEFT_VALUE_INPUT_PATH, 0, 1, &table, {}}});
  EXPECT_EQ(problem, "");
  EXPECT_EQ(read.radius_px, 60.5);
  EXPECT_EQ(read.rounds, 3);
  EXPECT_THAT(read.levels, ElementsAre(0.25, 0.5));
  EXPECT_EQ(read.metric, Metric::hamming);
  EXPECT_THAT(read.labels, IsEmpty());
}

TEST(Params, ARequiredTextThatIsAbsentIsAProblem) {
  EXPECT_EQ(read_with<Everything>({}).second, "parameter 'table' is required");
}

struct Demanding {
  explicit Demanding(Params& p) {
    p.read("ratio", ratio, "", {0, 1}, "", Need::required);
    p.read("rounds", rounds, "", {1, 10}, "", Need::required);
    p.read("bytes", bytes, "", {0, 10}, "", Need::required);
    p.read("levels", levels, "", {0, 1}, "", Need::required);
  }
  double ratio = 0.5;
  int rounds = 1;
  std::int64_t bytes = 1;
  std::vector<double> levels;
};

TEST(Params, NumbersCanBeRequired) {
  for (const Declared& declared : declared_by<Demanding>()) {
    EXPECT_TRUE(declared.required) << declared.name;
  }
  const double ratio = 0.25, level = 0.5;
  const std::int64_t rounds = 2, bytes = 3;
  const std::vector<weft_value> all{{"ratio", WEFT_VALUE_F64, 0, 1, &ratio, {}},
                                    {"rounds", WEFT_VALUE_I64, 0, 1, &rounds, {}},
                                    {"bytes", WEFT_VALUE_I64, 0, 1, &bytes, {}},
                                    {"levels", WEFT_VALUE_F64, 1, 1, &level, {}}};
  EXPECT_EQ(read_with<Demanding>(all).second, "");
  EXPECT_EQ(read_with<Demanding>(all).first.rounds, 2);
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<weft_value> some = all;
    some.erase(some.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_EQ(read_with<Demanding>(some).second,
              "parameter '" + std::string(all[i].name) + "' is required");
  }
}

struct Bounded {
  explicit Bounded(Params& p) {
    p.read("share", share, "", {0, 1}, "");
    p.read("free", free, "", {}, "");
    p.read("number", number, "", {-1e12, 1e12}, "");
    p.read("any", any, "", {}, "");
    p.read("list", list, "", {0, 1}, "");
  }
  double share = 0.5, free = 0.0;
  int number = 0, any = 0;
  std::vector<double> list;
};

TEST(Params, RefusesNumbersOutsideTheirRange) {
  const double nan = std::nan(""), low = -0.001, high = 1.001, zero = 0.0, one = 1.0;
  for (const double* illegal : {&nan, &low, &high}) {
    EXPECT_THAT(read_with<Bounded>({{"share", WEFT_VALUE_F64, 0, 1, illegal, {}}}).second,
                HasSubstr("'share' is outside its range"));
    EXPECT_THAT(read_with<Bounded>({{"list", WEFT_VALUE_F64, 1, 1, illegal, {}}}).second,
                HasSubstr("'list' has a value outside"));
  }
  for (const double* end : {&zero, &one}) {
    EXPECT_EQ(read_with<Bounded>({{"share", WEFT_VALUE_F64, 0, 1, end, {}}}).second, "");
  }
  EXPECT_THAT(read_with<Bounded>({{"free", WEFT_VALUE_F64, 0, 1, &nan, {}}}).second,
              HasSubstr("'free'"));
}

TEST(Params, ARangeWithoutEndsTakesAllNumbers) {
  const double far = -1e9;
  const std::int64_t large = std::numeric_limits<int>::max();
  const auto [read, problem] = read_with<Bounded>(
      {{"free", WEFT_VALUE_F64, 0, 1, &far, {}}, {"any", WEFT_VALUE_I64, 0, 1, &large, {}}});
  EXPECT_EQ(problem, "");
  EXPECT_EQ(read.free, far);
  EXPECT_EQ(read.any, std::numeric_limits<int>::max());
}

TEST(Params, AnIntNeverWrapsAround) {
  const std::int64_t large = std::int64_t{1} << 32, small = -(std::int64_t{1} << 32) - 5;
  for (const std::int64_t* value : {&large, &small}) {
    for (const char* name : {"number", "any"}) {
      const auto [read, problem] = read_with<Bounded>({{name, WEFT_VALUE_I64, 0, 1, value, {}}});
      EXPECT_THAT(problem, HasSubstr("outside its range")) << name;
      EXPECT_EQ(read.number, 0);
    }
  }
  EXPECT_EQ(declared_by<Bounded>()[2].maximum, std::numeric_limits<int>::max());
}

/// A number up to 2^53, above which a double has no odd integers.
struct Exact {
  std::int64_t count = 0;

  explicit Exact(Params& p) { p.read("count", count, "", {0, 9007199254740992}, "number"); }
};

TEST(Params, WholeNumbersAreComparedExactlyWithTheEndsOfTheirRange) {
  const std::int64_t end = std::int64_t{1} << 53, beyond = end + 1;
  EXPECT_EQ(read_with<Exact>({{"count", WEFT_VALUE_I64, 0, 1, &end, {}}}).second, "");
  EXPECT_THAT(read_with<Exact>({{"count", WEFT_VALUE_I64, 0, 1, &beyond, {}}}).second,
              HasSubstr("outside its range"));
}

TEST(Params, ListsOfWholeNumbersAndTextsAreCheckedAsListsOfNumbersAre) {
  const char* table = "/t";
  const std::int64_t negative = -1, large = std::int64_t{1} << 32;
  const double number = 1.0;
  const auto problem_with = [&](const weft_value& value) {
    return read_with<Everything>({{"table", WEFT_VALUE_INPUT_PATH, 0, 1, &table, {}}, value})
        .second;
  };
  EXPECT_THAT(problem_with({"cuts", WEFT_VALUE_I64, 1, 1, &negative, {}}),
              HasSubstr("'cuts' has a value outside its range"));
  EXPECT_THAT(problem_with({"threads", WEFT_VALUE_I64, 1, 1, &large, {}}),
              HasSubstr("'threads' has a value outside its range"));
  EXPECT_EQ(problem_with({"cuts", WEFT_VALUE_I64, 1, 1, &large, {}}), "");
  EXPECT_THAT(problem_with({"cuts", WEFT_VALUE_F64, 1, 1, &number, {}}), HasSubstr("wrong type"));
  EXPECT_THAT(problem_with({"cuts", WEFT_VALUE_I64, 0, 1, &large, {}}), HasSubstr("wrong type"));
  EXPECT_THAT(problem_with({"parts", WEFT_VALUE_TEXT, 0, 1, &table, {}}), HasSubstr("wrong type"));
  EXPECT_THAT(problem_with({"table", WEFT_VALUE_INPUT_PATH, 0, 1, &table, {}}), "");
}

TEST(Params, RefusesAValueOfAnotherType) {
  const std::int64_t integer = 1;
  const double number = 0.5;
  const char* word = "minkowski";
  EXPECT_THAT(read_with<Bounded>({{"share", WEFT_VALUE_I64, 0, 1, &integer, {}}}).second,
              HasSubstr("'share' has the wrong type"));
  EXPECT_THAT(read_with<Bounded>({{"share", WEFT_VALUE_F64, 1, 1, &number, {}}}).second,
              HasSubstr("wrong type"));
  EXPECT_THAT(read_with<Everything>({{"metric", WEFT_VALUE_CHOICE, 0, 1, &word, {}}}).second,
              HasSubstr("'table' is required"));  // the first problem wins
  const char* table = "/t";
  EXPECT_THAT(read_with<Everything>({{"metric", WEFT_VALUE_CHOICE, 0, 1, &word, {}},
                                     {"table", WEFT_VALUE_INPUT_PATH, 0, 1, &table, {}}})
                  .second,
              HasSubstr("'metric' is none of its choices"));
}

}  // namespace
}  // namespace weft
