// SPDX-License-Identifier: Apache-2.0
// Components that can be loaded and then misbehave: each violation is an error with the component's
// id, for this call only.
#include <gmock/gmock.h>

#include "misbehaving.hpp"

namespace weft::misbehaving {
namespace {

using host::Outcome;
using host::Registry;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Misbehaviour : public ::testing::Test {
 protected:
  /// Runs the good component in the same process: whatever came before must not have hurt it.
  void TearDown() override {
    Subject good(registry_, "filters/test_good");
    ASSERT_TRUE(good.created());
    EXPECT_EQ(good.filter().status, WEFT_OK);
  }

  static void expect_error(const Outcome& outcome, const std::string& id,
                           const std::string& message) {
    EXPECT_EQ(outcome.status, WEFT_ERROR);
    EXPECT_EQ(outcome.error.where, id);
    EXPECT_THAT(outcome.error.message, HasSubstr(message));
    EXPECT_TRUE(outcome.outputs.empty());
  }

  const Registry registry_ = scan();
};

TEST_F(Misbehaviour, ThrowingInTheConstructorIsAnErrorWithTheId) {
  Subject thrower(registry_, "filters/test_throws", "{in: constructor}");
  ASSERT_FALSE(thrower.created());
  EXPECT_EQ(thrower.created().error().code, Errc::plugin_failure);
  EXPECT_EQ(thrower.created().error().where, "filters/test_throws");
  EXPECT_THAT(thrower.created().error().message, HasSubstr("the sky fell down"));
}

TEST_F(Misbehaviour, ThrowingANumberInTheConstructorIsAnErrorToo) {
  Subject thrower(registry_, "filters/test_throws", "{in: constructor, what: number}");
  ASSERT_FALSE(thrower.created());
  EXPECT_THAT(thrower.created().error().message, HasSubstr("no std::exception"));
}

TEST_F(Misbehaviour, ThrowingInPrepareIsAnErrorWithTheId) {
  Subject thrower(registry_, "filters/test_throws", "{in: prepare}");
  ASSERT_TRUE(thrower.created());
  Template templ;
  templ.vertices_m = Array<double>({3, 3}, 0.0);
  templ.flat_px = Array<double>({3, 2}, 0.0);
  templ.faces = Array<std::int32_t>({1, 3}, 0);
  templ.texture = Array<std::uint8_t>({4, 4}, 0);
  templ.mask = Array<std::uint8_t>({4, 4}, 0);
  const auto ready = thrower.context().prepare(**thrower.created(), *host::Record::copy_of(templ),
                                               *host::Record::copy_of(Camera{}));
  ASSERT_FALSE(ready);
  EXPECT_EQ(ready.error().where, "filters/test_throws");
  EXPECT_THAT(ready.error().message, HasSubstr("the sky fell down"));
}

TEST_F(Misbehaviour, ThrowingInProcessIsAnErrorOfThatCallOnly) {
  Subject thrower(registry_, "filters/test_throws", "{in: process}");
  expect_error(thrower.filter(), "filters/test_throws", "the sky fell down");
  expect_error(thrower.filter(), "filters/test_throws", "the sky fell down");
}

TEST_F(Misbehaviour, ThrowingWhatIsNoExceptionIsNamedAsSuch) {
  Subject number(registry_, "filters/test_throws", "{in: process, what: number}");
  expect_error(number.filter(), "filters/test_throws", "no std::exception");
  Subject memory(registry_, "filters/test_throws", "{in: process, what: memory}");
  expect_error(memory.filter(), "filters/test_throws", "out of memory");
  EXPECT_EQ(memory.filter().error.code, Errc::no_memory);
}

TEST_F(Misbehaviour, ALongMessageIsCutBetweenCharacters) {
  Subject thrower(registry_, "filters/test_throws", "{in: process, what: long_text}");
  const std::string message = thrower.filter().error.message;
  EXPECT_THAT(message, HasSubstr("the sky fell down"));
  EXPECT_GE(message.size(), 1020U);
  EXPECT_LE(message.size(), 1023U);
  EXPECT_EQ(message.substr(message.size() - 2), "\xc3\xa9");
}

TEST_F(Misbehaviour, OutputsThatNoReaderCouldUseAreErrors) {
  const std::vector<std::pair<std::string, std::string>> mistakes{
      {"shorter", "4 entries for 5"},
      {"disagree", "'score' has length 7 on axis 0 where N = 5 is expected"},
      {"two_columns", "'score' of inlier_mask/1: it has 2 axes where [N] is expected"},
      {"nan", "'score' holds NaN or infinity"},
      {"infinity", "'score' holds NaN or infinity"},
      {"absent", "'kept' is missing"},
      {"bad_name", "refused its array 'diag.../../escape'"},
      {"negative", "negative length"},
      {"no_flag", "array 'kept' holds 255 at [4] where 0 or 1 is expected"},
      {"too_sure", "array 'confidence' is 1.500000 where 0 to 1 is expected"}};
  for (const auto& [mistake, message] : mistakes) {
    SCOPED_TRACE(mistake);
    Subject subject(registry_, "filters/test_wrong_output", "{mistake: " + mistake + "}");
    expect_error(subject.filter(), "filters/test_wrong_output", message);
  }
  Subject right(registry_, "filters/test_wrong_output");
  EXPECT_EQ(right.filter().status, WEFT_OK);
}

TEST_F(Misbehaviour, AnOutputThatAPassPromisedAndForgotIsAnError) {
  Template templ;
  templ.vertices_m = Array<double>({4, 3}, 0.0);
  templ.flat_px = Array<double>({4, 2}, 0.0);
  templ.faces = Array<std::int32_t>({1, 3}, 0);
  templ.texture = Array<std::uint8_t>({4, 4}, 0);
  templ.mask = Array<std::uint8_t>({4, 4}, 0);
  const Camera camera;
  const RecordView<Template> template_view("template", templ);
  const RecordView<Camera> camera_view("camera", camera);
  const weft_record inputs[] = {template_view.raw(), camera_view.raw()};
  Subject pass(registry_, "passes/test_forgets");
  expect_error(pass.context().call(**pass.created(), 0, inputs, 0), "passes/test_forgets",
               "did not produce its output 'sightlines'");
  Subject wrong(registry_, "passes/test_forgets", "{vertices: 3}");
  expect_error(wrong.context().call(**wrong.created(), 0, inputs, 0), "passes/test_forgets",
               "3 entries for 4 of the input 'template'");
}

TEST_F(Misbehaviour, AnInputThatItDidNotAskForIsNamedWhenItIsUsed) {
  const std::vector<std::pair<std::string, std::string>> wanted{
      {"template", "template"}, {"camera", "camera"}, {"previous_shape", "previous.shape"}};
  for (const auto& [choice, input] : wanted) {
    SCOPED_TRACE(choice);
    Subject subject(registry_, "filters/test_undeclared", "{wanted: " + choice + "}");
    const std::string name = '"' + input + '"';
    expect_error(subject.filter(), "filters/test_undeclared",
                 "input " + name + " is not delivered: add " + name + " to kAbout.needs");
  }
}

TEST_F(Misbehaviour, CreatingNothingIsAnError) {
  Subject raw(registry_, "filters/test_raw", "{mistake: created_nothing}");
  ASSERT_FALSE(raw.created());
  EXPECT_EQ(raw.created().error().where, "filters/test_raw");
}

TEST_F(Misbehaviour, BreakingTheBareContractIsAnErrorWithTheId) {
  const std::vector<std::pair<std::string, std::string>> mistakes{
      {"no_output", "did not produce its output 'inlier_mask'"},
      {"no_reason", "gave no reason"},
      {"unknown_status", "status 77"},
      {"unknown_code", "gave no reason"},
      {"unknown_handle", "no component has the handle 999"}};
  for (const auto& [mistake, message] : mistakes) {
    SCOPED_TRACE(mistake);
    Subject subject(registry_, "filters/test_raw", "{mistake: " + mistake + "}");
    expect_error(subject.filter(), "filters/test_raw", message);
  }
}

TEST_F(Misbehaviour, ErrorsWithoutACodeOrWithAnUnknownOneAreThePlugins) {
  for (const std::string mistake : {"no_reason", "unknown_status", "unknown_code"}) {
    Subject subject(registry_, "filters/test_raw", "{mistake: " + mistake + "}");
    EXPECT_EQ(subject.filter().error.code, Errc::plugin_failure) << mistake;
  }
}

TEST_F(Misbehaviour, AMessageWithoutItsEndIsCut) {
  Subject subject(registry_, "filters/test_raw", "{mistake: no_terminator}");
  const Outcome outcome = subject.filter();
  EXPECT_EQ(outcome.status, WEFT_NO_RESULT);
  EXPECT_EQ(outcome.error.code, Errc::no_result);
  EXPECT_EQ(outcome.error.message, std::string(1023, 'x'));
  EXPECT_EQ(outcome.error.where, std::string(127, 'y'));
}

TEST_F(Misbehaviour, IllegalArraysAreRefusedAndTheCallGoesOn) {
  for (const std::string mistake :
       {"none", "unknown_slot", "wrong_type", "no_array_name", "no_shape", "unknown_dtype",
        "seven_axes", "negative", "too_large", "overflow", "null_log"}) {
    SCOPED_TRACE(mistake);
    Subject subject(registry_, "filters/test_raw", "{mistake: " + mistake + "}");
    const Outcome outcome = subject.filter();
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
  }
}

TEST_F(Misbehaviour, AComponentThatHoldsItselfByDefaultCannotBeResolved) {
  const Resolved resolved = resolve(registry_, "filters/test_recursive");
  EXPECT_FALSE(resolved.spec);
  ASSERT_EQ(resolved.problems.size(), 2U);
  EXPECT_THAT(resolved.problem(), AllOf(HasSubstr("1:6: 'left'"), HasSubstr("give another one")));
}

TEST_F(Misbehaviour, AMethodThatTheRoleLacksIsAnError) {
  Subject good(registry_, "filters/test_good");
  for (const int method : {-1, 1, 1000}) {
    expect_error(good.context().call(**good.created(), method, {}, 0), "filters/test_good",
                 "no method");
  }
}

TEST_F(Misbehaviour, AMissingInputIsAnError) {
  Subject good(registry_, "filters/test_good");
  expect_error(good.context().call(**good.created(), 0, {}, 0), "filters/test_good",
               "required input 'correspondences' is absent");
}

}  // namespace
}  // namespace weft::misbehaving
