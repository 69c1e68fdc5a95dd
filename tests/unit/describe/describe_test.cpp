// SPDX-License-Identifier: Apache-2.0
#include "host/describe/describe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <weft/sdk/filter.hpp>

namespace weft::host {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Base : Filter {
  Result<InlierMask> filter(const FilterInput&) override { return no_result("nothing"); }
};
struct OutsideRange final : Base {
  explicit OutsideRange(Params& p) { p.read("alpha", alpha, "s", {0, 1}, "too large"); }
  double alpha = 1.5;
};
struct InvertedRange final : Base {
  explicit InvertedRange(Params& p) { p.read("alpha", alpha, "s", {1, 0}, "upside down"); }
  double alpha = 0.5;
};
struct NotFinite final : Base {
  explicit NotFinite(Params& p) { p.read("alpha", alpha, "s", {}, "no bound"); }
  double alpha = std::numeric_limits<double>::infinity();
};
struct VectorOutside final : Base {
  explicit VectorOutside(Params& p) { p.read("alphas", alphas, "s", {0, 1}, "one too large"); }
  std::vector<double> alphas{0.5, 2.0};
};
struct IntegerOutside final : Base {
  explicit IntegerOutside(Params& p) { p.read("count", count, "", {1, 5}, "too small"); }
  int count = 0;
};
struct Twice final : Base {
  explicit Twice(Params& p) {
    p.read("alpha", alpha, "s", {0, 1}, "once");
    p.read("alpha", alpha, "s", {0, 1}, "again");
  }
  double alpha = 0.5;
};
struct NoChoice final : Base {
  explicit NoChoice(Params& p) { p.choice("mode", mode, {{"a", 1}, {"b", 2}}, "neither"); }
  int mode = 3;
};
struct Failing final : Base {
  explicit Failing(Params& p) {
    p.text("file", file, "opened too early");
    throw std::runtime_error("no such file");
  }
  std::string file;
};
struct ThrowingOnly final : Base {
  explicit ThrowingOnly(Params&) { throw 1; }
};
template <const char* kNeeds, const char* kReads, const char* kProduces>
struct Asking final : Base {
  static constexpr About kAbout{.needs = kNeeds, .reads = kReads, .produces = kProduces};
  explicit Asking(Params&) {}
};
struct Flagged final : Base {
  explicit Flagged(Params& p) {
    p.prominent().read("alpha", alpha, "s", {0, 1}, "changed most");
    p.deprecated().read("beta", beta, "s", {0, 1}, "no effect: use alpha");
    p.read("gamma", beta, "s", {0, 1}, "neither");
  }
  double alpha = 0.5, beta = 0.5;
};
struct Required final : Base {
  explicit Required(Params& p) { p.read("alpha", alpha, "s", {1, 2}, "given", Need::required); }
  double alpha = 0.0;  // never used, so it need not be legal
};

struct Sweeping : Base {
  explicit Sweeping(Params& p) {
    p.read("alpha", alpha, "s", {0, 1}, "kept up to this");
    p.read("alphas", alphas, "s", {0, 1}, "several");
  }
  double alpha = 0.5;
  std::vector<double> alphas;
};
struct Swept final : Sweeping {
  using Sweeping::Sweeping;
  static constexpr weft::Sweep kSweep{"alpha", {0, 1e-6, 1}};
};
struct SweptOutside final : Sweeping {
  using Sweeping::Sweeping;
  static constexpr weft::Sweep kSweep{"alpha", {0.5, 2}};
};
struct SweptBackwards final : Sweeping {
  using Sweeping::Sweeping;
  static constexpr weft::Sweep kSweep{"alpha", {0.5, 0.1}};
};
struct SweptUnknown final : Sweeping {
  using Sweeping::Sweeping;
  static constexpr weft::Sweep kSweep{"beta", {0, 1}};
};
struct SweptVector final : Sweeping {
  using Sweeping::Sweeping;
  static constexpr weft::Sweep kSweep{"alphas", {0, 1}};
};

Result<std::string> description_of(const weft_component& component) {
  const weft_component* const pointer = &component;
  const weft_library_table table{WEFT_ABI_MAGIC,
                                 WEFT_ABI_MAJOR,
                                 WEFT_ABI_MINOR,
                                 sizeof(weft_library_table),
                                 1,
                                 WEFT_ABI_NAME,
                                 &pointer,
                                 "",
                                 "none",
                                 0,
                                 0,
                                 0,
                                 {}};
  return describe_library(table, "abc");
}

template <class T>
Result<std::string> description() {
  static constexpr weft_component kComponent =
      WEFT_COMPONENT(T, "filters/local", "1.0.0", "A local class.");
  return description_of(kComponent);
}

template <class T>
std::string mistake() {
  const auto text = description<T>();
  EXPECT_FALSE(text);
  if (text) return *text;
  EXPECT_EQ(text.error().where, "filters/local");
  return text.error().message;
}

TEST(Describe, StatesHowAComponentFollowsItsReference) {
  const auto manifest_of = [](const char* reference) {
    weft_component component = WEFT_COMPONENT(Sweeping, "filters/local", "1.0.0", "A local class.");
    component.reference = reference;
    return *description_of(component);
  };
  EXPECT_THAT(manifest_of("reconstruction: A 2012"),
              HasSubstr("reference: \"A 2012\"\n    implements: \"reconstruction\"\n"));
  EXPECT_THAT(manifest_of("paper: A: b"),
              HasSubstr("reference: \"A: b\"\n    implements: \"paper\"\n"));
  for (const char* plain : {"", "A 2012", "paper", "own:A", "newspaper: A"}) {
    EXPECT_THAT(manifest_of(plain), Not(HasSubstr("implements"))) << plain;
    EXPECT_THAT(manifest_of(plain), HasSubstr(std::string("reference: \"") + plain + "\"\n"));
  }
}

TEST(Describe, StatesWhichParametersAreShownFirstAndWhichAreDeprecated) {
  const std::string manifest = *description<Flagged>();
  const std::string of_alpha = manifest.substr(manifest.find("name: \"alpha\""));
  EXPECT_THAT(of_alpha.substr(0, of_alpha.find("name: \"beta\"")),
              AllOf(HasSubstr("prominent: true"), Not(HasSubstr("deprecated"))));
  const std::string of_beta = manifest.substr(manifest.find("name: \"beta\""));
  EXPECT_THAT(of_beta.substr(0, of_beta.find("name: \"gamma\"")),
              AllOf(HasSubstr("deprecated: true"), Not(HasSubstr("prominent"))));
  EXPECT_THAT(manifest.substr(manifest.find("name: \"gamma\"")),
              AllOf(Not(HasSubstr("deprecated")), Not(HasSubstr("prominent"))));
}

TEST(Describe, RefusesDefaultsThatNoPipelineCouldUse) {
  EXPECT_EQ(mistake<OutsideRange>(), "parameter 'alpha' has a default outside its range");
  EXPECT_EQ(mistake<VectorOutside>(), "parameter 'alphas' has a default outside its range");
  EXPECT_EQ(mistake<NotFinite>(), "parameter 'alpha' has a default that is not finite");
  EXPECT_EQ(mistake<IntegerOutside>(), "parameter 'count' has a default outside its range");
  EXPECT_EQ(mistake<NoChoice>(), "parameter 'mode' has a default that is none of its choices");
}

TEST(Describe, RefusesDeclarationsThatContradictThemselves) {
  EXPECT_THAT(mistake<InvertedRange>(), HasSubstr("minimum is the larger end"));
  EXPECT_EQ(mistake<Twice>(), "parameter 'alpha' is declared twice");
}

TEST(Describe, RefusesAConstructorThatDoesMoreThanRead) {
  EXPECT_THAT(mistake<Failing>(),
              ::testing::AllOf(HasSubstr("no such file"), HasSubstr("belong in prepare()")));
}

TEST(Describe, SaysWhatAConstructorThrew) {
  EXPECT_THAT(mistake<Failing>(), HasSubstr("(threw: no such file)"));
  EXPECT_THAT(mistake<ThrowingOnly>(), HasSubstr("(threw something that is no std::exception)"));
}

constexpr char kNothing[] = "", kTemplate[] = "template", kTemplat[] = "camera templat",
               kPrevious[] = "previous_shape", kShape[] = "shape", kMask[] = "inlier_mask";

TEST(Describe, RefusesInputsAndOutputsThatTheRoleDoesNotHave) {
  EXPECT_EQ((mistake<Asking<kTemplat, kNothing, kNothing>>()),
            "kAbout.needs names 'templat', which is no input of filters; did you mean 'template'?");
  EXPECT_EQ((mistake<Asking<kTemplate, kPrevious, kNothing>>()),
            "kAbout.reads names 'previous_shape', which is no input of filters; did you mean "
            "'previous.shape'?");
  EXPECT_EQ((mistake<Asking<kTemplate, kNothing, kShape>>()),
            "kAbout.produces names 'shape', which is no output of filters; there are: "
            "inlier_mask");
  EXPECT_TRUE((description<Asking<kTemplate, kNothing, kMask>>()));
}

TEST(Describe, WritesTheSweepOfAComponentThatHasOne) {
  const auto text = description<Swept>();
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_THAT(*text,
              HasSubstr("    sweep:\n      parameter: \"alpha\"\n      values: [0, 1e-06, 1]\n"));
  EXPECT_THAT(*text, HasSubstr("extensions: [\"weft.sweep/1\"]"));
  const auto without = description<Required>();
  ASSERT_TRUE(without);
  EXPECT_THAT(*without, ::testing::Not(HasSubstr("sweep")));
}

TEST(Describe, RefusesASweepThatNoPlanCouldRun) {
  const char* wrong = "its sweep of 'alpha' is not at least two ascending values in its range";
  EXPECT_EQ(mistake<SweptOutside>(), wrong);
  EXPECT_EQ(mistake<SweptBackwards>(), wrong);
  EXPECT_EQ(mistake<SweptUnknown>(), "its sweep names 'beta', which is no number of it");
  EXPECT_EQ(mistake<SweptVector>(), "its sweep names 'alphas', which is no number of it");
}

TEST(Describe, WritesNoDefaultForWhatIsRequired) {
  const auto text = description<Required>();
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_THAT(*text, HasSubstr("required: true"));
  EXPECT_THAT(*text, ::testing::Not(HasSubstr("default:")));
}

}  // namespace
}  // namespace weft::host
