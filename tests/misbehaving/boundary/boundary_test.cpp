// SPDX-License-Identifier: Apache-2.0
// The host refuses at once what it could not use, and reaches only the components that a caller may
// reach. It turns every exception into an error with an id.
#include <gmock/gmock.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "../misbehaving.hpp"
#include "host/guarding/process_state.hpp"

namespace weft::misbehaving {
namespace {

using host::Outcome;
using host::Record;
using ::testing::HasSubstr;

std::string act(const std::string& name) { return "{act: " + name + "}"; }

/// Components in one execution context that keeps its log.
class Boundary : public ::testing::Test {
 protected:
  host::Instance& make(const std::string& id, const std::string& params = "{}") {
    resolved_.push_back(resolve(registry_, id, params));
    if (!resolved_.back().spec) throw std::runtime_error(resolved_.back().problem());
    const auto made = context_->instantiate(*resolved_.back().spec, id);
    if (!made) throw std::runtime_error(made.error().message);
    return **made;
  }

  Outcome filter(host::Instance& filter, std::uint64_t producer = 0,
                 host::SteadyTime deadline = host::kNoDeadline) {
    const Correspondences matches = make_matches(5);
    const RecordView<Correspondences> view("correspondences", matches);
    weft_record warp = view.raw();
    warp.slot = "warp";
    warp.producer = producer;
    const weft_record inputs[] = {view.raw(), warp};
    return context_->call(filter, 0, inputs, 9, 0, deadline);
  }

  Outcome filter(const std::string& what) { return filter(make("filters/test_bare", act(what))); }

  const host::Registry registry_ = scan();
  std::vector<std::pair<std::string, std::string>> log_;  ///< component and text
  std::vector<Resolved> resolved_;
  std::unique_ptr<host::ExecutionContext> context_ = std::make_unique<host::ExecutionContext>(
      1, [this](const std::string& component, int, const std::string& text, std::uint64_t) {
        log_.emplace_back(component, text);
      });
};

TEST_F(Boundary, AnArrayThatValidationWouldRefuseIsRefusedAtTheCallSoThatThePluginGoesOn) {
  for (const std::string what :
       {"none", "wrong_element_first", "device_first", "vendor_name_first", "second_view"}) {
    SCOPED_TRACE(what);
    const Outcome outcome = filter(what);
    EXPECT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
    ASSERT_NE(outcome.find("inlier_mask"), nullptr);
    EXPECT_EQ(view_as<InlierMask>(*outcome.find("inlier_mask"))->kept.rows(), 5);
  }
}

TEST_F(Boundary, AnOutputHasTheFrameThatItsMakerStatesOrThatOfTheCall) {
  EXPECT_EQ(filter("none").find("inlier_mask")->frame(), 9);
  EXPECT_EQ(filter("older_frame").find("inlier_mask")->frame(), 3);
}

TEST_F(Boundary, MemoryOfAReplacedArrayCanBeWrittenUntilTheCallReturns) {
  const Outcome outcome = filter("writes_replaced");
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
  const auto mask = view_as<InlierMask>(*outcome.find("inlier_mask"));
  for (std::int64_t i = 0; i < 5; ++i) EXPECT_EQ(mask->kept(i), 1) << i;
}

TEST_F(Boundary, AComponentReachesNoOtherOneByAGuessedHandle) {
  make("filters/test_good");  // the warp that is nested in it has the handle 1
  const Outcome outcome = filter("invokes_first");
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_EQ(outcome.error.where, "filters/test_bare");
  EXPECT_THAT(
      outcome.error.message,
      HasSubstr("called 'filters/test_good/warp', which is not nested in it and made none of "
                "its warps"));
}

TEST_F(Boundary, AComponentReachesTheProducerOfItsInput) {
  const std::uint64_t producer = host::handle_of(make("filters/test_good"));
  host::Instance& caller = make("filters/test_bare", act("invokes_its_input"));
  const Outcome outcome = filter(caller, producer);
  EXPECT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
}

TEST_F(Boundary, AnExceptionWithoutATextIsAnError) {
  const Outcome outcome = filter("throws_without_text");
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_THAT(outcome.error.message, HasSubstr("threw: an exception without a text"));
}

TEST_F(Boundary, AnExceptionOfDestroyIsAWarningWithTheNameOfItsStage) {
  make("filters/test_bare", act("throws_in_destroy"));
  context_.reset();
  ASSERT_EQ(log_.size(), 1U);
  EXPECT_EQ(log_[0].first, "filters/test_bare");
  EXPECT_THAT(log_[0].second, HasSubstr("its destroy() threw: the floor gave way"));
}

TEST_F(Boundary, AnExceptionOfGetExtensionIsAnErrorOfItsComponent) {
  const Resolved bare = resolve(registry_, "filters/test_bare");
  ASSERT_TRUE(bare.spec);
  setenv("WEFT_TEST_EXTENSIONS_THROW", "1", 1);
  const auto made = context_->instantiate(*bare.spec, "filters");
  unsetenv("WEFT_TEST_EXTENSIONS_THROW");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().where, "filters/test_bare");
  EXPECT_THAT(made.error().message, HasSubstr("the shelf is empty"));
}

TEST_F(Boundary, AnExceptionOfASteeringSinkIsAnErrorOfIt) {
  host::Instance& sink = make("sinks/test_bare");
  ASSERT_TRUE(host::ExecutionContext::steers(sink));
  const auto requests = host::ExecutionContext::take_change_requests(sink);
  ASSERT_FALSE(requests);
  EXPECT_EQ(requests.error().where, "sinks/test_bare");
  EXPECT_THAT(requests.error().message, HasSubstr("no hand is free"));
  const auto answered = host::ExecutionContext::answer(sink, {1, 0, ""});
  ASSERT_FALSE(answered);
  EXPECT_THAT(answered.error().message, HasSubstr("no ear is open"));
}

TEST_F(Boundary, LoggedTextsAreEscapedAndCut) {
  ASSERT_EQ(filter("logs_escapes").status, WEFT_OK);
  ASSERT_EQ(log_.size(), 2U);
  EXPECT_EQ(log_[0].second, "red \\x1B[31m\\nfake: line \\xFF");
  EXPECT_EQ(log_[1].second, std::string(4096, 'x') + "... (cut at 4096 bytes)");
}

TEST_F(Boundary, AFloodOfTextsInOneCallIsCutShort) {
  ASSERT_EQ(filter("logs_without_end").status, WEFT_OK);
  ASSERT_EQ(log_.size(), 101U);
  EXPECT_EQ(log_.back().second, "further messages are dropped");
}

TEST_F(Boundary, AComponentIsToldHowLongItIsUntilTheDeadlineOfItsFrame) {
  constexpr std::chrono::hours kHour{1};
  const auto left_ms = [&](host::SteadyTime deadline) {
    log_.clear();
    filter(make("filters/test_bare", act("asks_for_its_time")), 0, deadline);
    return log_.empty() ? std::nan("") : std::stod(log_[0].second);
  };
  const double hour_ms = 3.6e6;
  EXPECT_EQ(left_ms(host::kNoDeadline), std::numeric_limits<double>::infinity());
  const double later_ms = left_ms(host::SteadyTime::clock::now() + kHour);
  EXPECT_GT(later_ms, 0.5 * hour_ms);
  EXPECT_LE(later_ms, hour_ms);
  EXPECT_LE(left_ms(host::SteadyTime::clock::now() - kHour), -hour_ms);
}

TEST_F(Boundary, ACopyOfTheProcessThatReturnsIsEndedAndItsMakerIsNamed) {
  ASSERT_EQ(filter("forks").status, WEFT_OK);
  ASSERT_EQ(log_.size(), 1U);
  EXPECT_EQ(log_[0].first, "filters/test_bare");
  EXPECT_THAT(log_[0].second, HasSubstr("made a copy of the process with fork()"));
  ASSERT_EQ(filter("none").status, WEFT_OK);
  EXPECT_EQ(log_.size(), 1U) << "told once";
}

TEST_F(Boundary, WhatACreatedComponentChangedInTheProcessIsRestoredAndNamed) {
  const std::vector<std::pair<std::string, std::string>> changes{{"limit", "resource limits"},
                                                                 {"timer", "timers"},
                                                                 {"handler", "signals"},
                                                                 {"mask", "signals"},
                                                                 {"affinity", "affinity"},
                                                                 {"priority", "priority"},
                                                                 {"locale", "locale"},
                                                                 {"folder", "working directory"},
                                                                 {"terminate", "terminate handler"},
                                                                 {"environment", "environment"}};
  for (const auto& [what, part] : changes) {
    if (what == "affinity" && sysconf(_SC_NPROCESSORS_ONLN) < 2) continue;  // nothing to change
    SCOPED_TRACE(what);
    log_.clear();
    const host::ProcessState before;
    make("filters/test_bare", act(what));
    EXPECT_TRUE(before.changes().empty());
    before.restore("in this test");
    ASSERT_EQ(log_.size(), 1U);
    EXPECT_EQ(log_[0].first, "filters/test_bare");
    EXPECT_THAT(log_[0].second,
                ::testing::AllOf(HasSubstr("the process state changed while it was created: "),
                                 HasSubstr(part)));
  }
}

}  // namespace
}  // namespace weft::misbehaving
