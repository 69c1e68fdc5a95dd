// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/device.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/sdk/matcher.hpp>

namespace weft {
namespace {

using ::testing::HasSubstr;

/// A host that records requests and may refuse them.
struct FakeHost {
  FakeHost() {
    table = {sizeof(table), WEFT_ABI_MAJOR, WEFT_ABI_MINOR, "",     "",     &alloc,
             &is_cancelled, &keep_log,      nullptr,        &adopt, nullptr};
    call = {sizeof(call), 0, &table, this, 42, 9, 3, 0};
  }
  FakeHost(const FakeHost&) = delete;

  static FakeHost& of(const weft_call* raw) { return *static_cast<FakeHost*>(raw->context); }
  static void* alloc(const weft_call* raw, const weft_output* output) {
    FakeHost& self = of(raw);
    if (self.refuses) return nullptr;
    std::int64_t bytes = dtype_size(output->dtype);
    for (int axis = 0; axis < output->ndim; ++axis) bytes *= output->shape[axis];
    self.asked.push_back(std::string(output->slot) + " " + output->type + " " + output->array);
    const auto words = to_index(bytes) / 8 + 1;
    return self.memory.emplace_back(std::make_unique<std::vector<double>>(words))->data();
  }
  static std::int32_t adopt(const weft_call* raw, const weft_output* output) {
    FakeHost& self = of(raw);
    self.asked.push_back(std::string(output->slot) + " " + output->type + " " + output->array +
                         " there");
    self.handles.push_back(output->handle);
    return self.refuses ? 0 : 1;
  }
  static std::int32_t is_cancelled(const weft_call* raw) { return of(raw).stop ? 1 : 0; }
  static void keep_log(const weft_call* raw, std::int32_t level, const char* text) {
    of(raw).log = std::to_string(level) + text;
  }

  weft_host table{};
  weft_call call{};
  bool refuses = false, stop = false;
  std::string log;
  std::vector<std::string> asked;
  std::vector<std::uint64_t> handles;
  std::vector<std::unique_ptr<std::vector<double>>> memory;
};

Correspondences make_matches(std::int64_t n) {
  Correspondences matches;
  matches.template_px = matches.image_px = Array<double>({n, 2}, 0.0);
  matches.face = Array<std::int32_t>({n}, 0);
  matches.barycentrics = Array<double>({n, 3}, 0.0);
  matches.kept = Array<std::uint8_t>({n}, 0);
  matches.score = Array<double>({n}, 0.0);
  return matches;
}

InlierMask make_mask(std::int64_t n) {
  return {Array<std::uint8_t>({n}, 0), Array<double>({n}, 0.0), {}};
}

/// A filter that runs the script of its test.
struct Scripted : Filter {
  Result<InlierMask> filter(const FilterInput& in) override { return script(in); }
  std::function<Result<InlierMask>(const FilterInput&)> script;
};

class ProcessCallTest : public ::testing::Test {
 protected:
  /// Calls a filter that runs `script` on three matches.
  std::int32_t run(std::function<Result<InlierMask>(const FilterInput&)> script) {
    Scripted filter;
    filter.script = std::move(script);
    const Correspondences matches = make_matches(3);
    const RecordView<Correspondences> view("correspondences", matches);
    ProcessCall process(host_.call, &view.raw(), 1, &error_);
    return filter.process(process);
  }

  FakeHost host_;
  weft_error error_{};
};

TEST_F(ProcessCallTest, GivesTheInputsAndWritesTheOutput) {
  const std::int32_t status = run([](const FilterInput& in) {
    EXPECT_EQ(in.correspondences.count(), 3);
    EXPECT_FALSE(in.templ.has_value());
    EXPECT_EQ(in.call.seed(), 42U);
    EXPECT_EQ(in.call.frame(), 9U);
    EXPECT_EQ(in.call.threads(), 3);
    EXPECT_FALSE(in.call.cancelled());
    in.call.log_warning("careful");
    return make_mask(3);
  });
  EXPECT_EQ(status, WEFT_OK);
  EXPECT_EQ(host_.log, "2careful");
  EXPECT_THAT(host_.asked, ::testing::ElementsAre("inlier_mask inlier_mask/1 kept",
                                                  "inlier_mask inlier_mask/1 score"));
}

TEST_F(ProcessCallTest, SeesThatTheHostWantsToStop) {
  host_.stop = true;
  EXPECT_EQ(run([](const FilterInput& in) -> Result<InlierMask> {
              if (in.call.cancelled()) return Error{Errc::cancelled, "stopped"};
              return make_mask(3);
            }),
            WEFT_CANCELLED);
}

TEST_F(ProcessCallTest, AFlaggedValueIsWrittenAndItsReasonGiven) {
  EXPECT_EQ(run([](const auto&) { return degenerate(make_mask(3), "few matches"); }),
            WEFT_DEGENERATE);
  EXPECT_STREQ(error_.message, "few matches");
  EXPECT_EQ(host_.asked.size(), 2U);
}

TEST_F(ProcessCallTest, ErrorsBecomeTheStatusThatBelongsToThem) {
  EXPECT_EQ(run([](const auto&) { return no_result("too few matches"); }), WEFT_NO_RESULT);
  EXPECT_STREQ(error_.message, "too few matches");
  EXPECT_EQ(error_.code, static_cast<std::int32_t>(Errc::no_result));
  EXPECT_EQ(run([](const auto&) { return Error{Errc::cancelled, "stopped", ""}; }), WEFT_CANCELLED);
  EXPECT_EQ(run([](const auto&) { return Error{Errc::io, "disk full", "file.txt"}; }), WEFT_ERROR);
  EXPECT_STREQ(error_.where, "file.txt");
  EXPECT_TRUE(host_.asked.empty());
}

TEST_F(ProcessCallTest, AHostThatRefusesAnArrayMakesItAnError) {
  host_.refuses = true;
  EXPECT_EQ(run([](const auto&) { return make_mask(3); }), WEFT_ERROR);
  EXPECT_THAT(error_.message, HasSubstr("'kept' of inlier_mask/1"));
}

TEST_F(ProcessCallTest, AnArrayOnADeviceIsHandedOverByItsHandle) {
  const auto mask = [](const auto&) -> Result<InlierMask> {
    InlierMask there = make_mask(3);
    there.kept = Array<std::uint8_t>::on_device(5, 1, {3}, nullptr);
    return there;
  };
  EXPECT_EQ(run(mask), WEFT_OK);
  EXPECT_THAT(host_.asked, ::testing::ElementsAre("inlier_mask inlier_mask/1 kept there",
                                                  "inlier_mask inlier_mask/1 score"));
  EXPECT_THAT(host_.handles, ::testing::ElementsAre(5U));
  host_.refuses = true;
  EXPECT_EQ(run(mask), WEFT_ERROR);
  EXPECT_THAT(error_.message, HasSubstr("'kept' of inlier_mask/1"));
}

TEST_F(ProcessCallTest,
       ANestedComponentIsGivenTheArraysOfOthersAndTheRevisionOnlyOfWhatWasNotChanged) {
  struct Seen {
    std::uint64_t revision;
    std::vector<std::string> arrays;
  };
  static std::vector<Seen> seen;
  seen.clear();
  host_.table.invoke = [](const weft_call*, weft_invocation* asked, weft_error*) -> std::int32_t {
    const weft_record& matches = asked->inputs[0];
    Seen& now = seen.emplace_back(Seen{matches.revision, {}});
    for (std::uint64_t i = 0; i < matches.count; ++i) {
      now.arrays.emplace_back(matches.arrays[i].name);
    }
    return WEFT_NO_RESULT;
  };
  Correspondences matches = make_matches(3);
  matches.others.set("x.acme.weight", Array<std::uint16_t>({3}, 7));
  const RecordView<Correspondences> view("correspondences", matches);
  weft_record given = view.raw();
  given.revision = 31;
  Scripted filter;
  filter.script = [](const FilterInput& in) {
    WarpComponent warp("warps/any");
    Correspondences edited = in.correspondences;
    EXPECT_FALSE(warp.fit(in.call, edited, Template{}));
    edited.kept = Array<std::uint8_t>({3}, 1);
    EXPECT_FALSE(warp.fit(in.call, edited, Template{}));
    EXPECT_FALSE(warp.fit(in.call, make_matches(2), Template{}));
    return make_mask(3);
  };
  ProcessCall process(host_.call, &given, 1, &error_);
  EXPECT_EQ(filter.process(process), WEFT_OK);
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[0].revision, 31U);
  EXPECT_THAT(seen[0].arrays, ::testing::Contains("x.acme.weight"));
  EXPECT_EQ(seen[1].revision, 0U);
  EXPECT_THAT(seen[1].arrays, ::testing::Contains("x.acme.weight"));
  EXPECT_EQ(seen[2].revision, 0U);
  EXPECT_THAT(seen[2].arrays, ::testing::Not(::testing::Contains("x.acme.weight")));
}

TEST_F(ProcessCallTest, AnAbsentRequiredInputIsAnError) {
  Scripted filter;
  ProcessCall process(host_.call, nullptr, 0, &error_);
  EXPECT_EQ(filter.process(process), WEFT_ERROR);
  EXPECT_STREQ(error_.message, "required input 'correspondences' is absent");
}

TEST_F(ProcessCallTest, AnInputOfAnotherTypeIsAnError) {
  Scripted filter;
  const Time time;
  const RecordView<Time> view("correspondences", time);
  ProcessCall process(host_.call, &view.raw(), 1, &error_);
  EXPECT_EQ(filter.process(process), WEFT_ERROR);
  EXPECT_THAT(error_.message, HasSubstr("expected a record correspondences/1, got time/1"));
}

TEST_F(ProcessCallTest, RepeatedInputsAreAllGivenInOrder) {
  const Correspondences first = make_matches(1), second = make_matches(2);
  const RecordView<Correspondences> one("correspondences", first), two("correspondences", second);
  const weft_record inputs[] = {one.raw(), two.raw()};
  ProcessCall process(host_.call, inputs, 2, &error_);
  MatcherInput input{Call(host_.call)};
  ASSERT_TRUE(process.read_slots(input));
  ASSERT_EQ(input.correspondences.size(), 2U);
  EXPECT_EQ(input.correspondences[0].count(), 1);
  EXPECT_EQ(input.correspondences[1].count(), 2);
  EXPECT_FALSE(input.keypoints.has_value());
}

TEST_F(ProcessCallTest, InputsThatAreNotThereAreNamedWhenTheyAreUsed) {
  ProcessCall process(host_.call, nullptr, 0, &error_);
  MatcherInput input{Call(host_.call)};
  ASSERT_TRUE(process.read_slots(input));
  const auto refusal = [](const auto& use) -> std::string {
    try {
      use();
    } catch (const NotDelivered& missing) {
      return missing.what();
    }
    return {};
  };
  EXPECT_THAT(refusal([&] { return input.templ->vertices_m.rows(); }),
              HasSubstr("add \"template\" to kAbout.needs"));
  EXPECT_THAT(refusal([&] { return (*input.previous_shape).state; }),
              HasSubstr("add \"previous.shape\" to kAbout.needs"));
  EXPECT_THAT(refusal([&] { return input.correspondences.front().count(); }),
              HasSubstr("add \"correspondences\" to kAbout.needs"));
  input.previous_shape = Shape{};
  EXPECT_EQ(refusal([&] { return (*input.previous_shape).state; }), "");
}

TEST(CopyText, CutsBetweenCharactersAndAlwaysEnds) {
  char buffer[8];
  copy_text(buffer, "short");
  EXPECT_STREQ(buffer, "short");
  copy_text(buffer, "exactly");
  EXPECT_STREQ(buffer, "exactly");
  copy_text(buffer, "too long by far");
  EXPECT_STREQ(buffer, "too lon");
  copy_text(buffer, "sixsix\xc3\xa9");  // the last character would be cut in two
  EXPECT_STREQ(buffer, "sixsix");
  copy_text(buffer, "five5\xf0\x9f\xa7\xb6!");
  EXPECT_STREQ(buffer, "five5");
  copy_text(buffer, "");
  EXPECT_STREQ(buffer, "");
}

/// A component of the contract made from a class, as a library holds it.
struct Simple final : Filter {
  static constexpr About kAbout{.reference = "a paper",
                                .licence = "MIT",
                                .needs = "camera",
                                .random = true,
                                .uses_truth = true};
  explicit Simple(Params& p) { p.read("value", value, "", {0, 1}, "a number"); }
  ~Simple() override { ++destroyed; }
  Result<void> prepare(const PrepareInput& in) override {
    if (in.templ.vertices_m.rows() == 3) return {};
    return Error{Errc::unsupported, "wants a triangle"};
  }
  Result<InlierMask> filter(const FilterInput& in) override {
    return make_mask(in.correspondences.count());
  }
  double value = 0.5;
  static inline int destroyed = 0;
};

constexpr weft_component kSimple =
    WEFT_COMPONENT(Simple, "filters/simple", "2.0.1", "Does little.");

TEST(Component, SaysWhatItsClassSays) {
  EXPECT_EQ(kSimple.struct_size, sizeof(weft_component));
  EXPECT_EQ(kSimple.flags, WEFT_FLAG_RANDOM | WEFT_FLAG_USES_TRUTH);
  EXPECT_STREQ(kSimple.id, "filters/simple");
  EXPECT_STREQ(kSimple.version, "2.0.1");
  EXPECT_STREQ(kSimple.reference, "a paper");
  EXPECT_STREQ(kSimple.licence, "MIT");
  EXPECT_STREQ(kSimple.determinism, "exact");
  EXPECT_STREQ(kSimple.needs, "camera");
  EXPECT_EQ(kSimple.get_extension(&kSimple, "weft.unknown/1"), nullptr);
}

/// A component with a device.
struct Remote {
  Result<void> download(std::span<std::byte>, const std::function<bool()>&) const { return {}; }
};
struct WithDevices final : Filter {
  static constexpr About kAbout{.device_memory = &kDeviceMemory<Remote>};
  explicit WithDevices(Params&) {}
  static std::vector<std::string> devices() {
    if (is_broken) throw std::runtime_error("the driver is gone");
    return {"first", "second"};
  }
  Result<InlierMask> filter(const FilterInput&) override { return make_mask(0); }
  static inline bool is_broken = false;
};

/// A component with a threshold.
struct WithSweep final : Filter {
  static constexpr Sweep kSweep{"alpha", {0.5, 1}};
  explicit WithSweep(Params&) {}
  Result<InlierMask> filter(const FilterInput&) override { return make_mask(0); }
};

TEST(Component, TellsTheSweepOfItsClass) {
  constexpr weft_component kSwept =
      WEFT_COMPONENT(WithSweep, "filters/swept", "1.0.0", "Has a threshold.");
  EXPECT_EQ(kSimple.get_extension(&kSimple, WEFT_SWEEP), nullptr);
  const auto* sweep = static_cast<const weft_sweep*>(kSwept.get_extension(&kSwept, WEFT_SWEEP));
  ASSERT_NE(sweep, nullptr);
  EXPECT_STREQ(sweep->parameter, "alpha");
  EXPECT_THAT(std::vector<double>(sweep->values, sweep->values + sweep->count),
              ::testing::ElementsAre(0.5, 1.0));
}

TEST(Component, HasTheExtensionsThatItsClassHas) {
  constexpr weft_component kWithDevices =
      WEFT_COMPONENT(WithDevices, "filters/remote", "1.0.0", "Has devices.");
  EXPECT_EQ(kSimple.get_extension(&kSimple, WEFT_DEVICE_MEMORY), nullptr);
  EXPECT_EQ(kSimple.get_extension(&kSimple, WEFT_DEVICES), nullptr);
  EXPECT_EQ(kWithDevices.get_extension(&kWithDevices, WEFT_DEVICE_MEMORY), &kDeviceMemory<Remote>);
  const auto* listing =
      static_cast<const weft_devices*>(kWithDevices.get_extension(&kWithDevices, WEFT_DEVICES));
  ASSERT_NE(listing, nullptr);
  std::vector<std::string> names;
  const auto add = [](void* context, const char* name) {
    static_cast<std::vector<std::string>*>(context)->emplace_back(name);
  };
  weft_error error = kNoError;
  EXPECT_EQ(listing->list(&names, add, &error), WEFT_OK);
  EXPECT_THAT(names, ::testing::ElementsAre("first", "second"));
  WithDevices::is_broken = true;
  EXPECT_EQ(listing->list(&names, add, &error), WEFT_ERROR);
  EXPECT_STREQ(error.message, "threw: the driver is gone");
}

TEST(Component, RefusesIllegalParametersAndDestroysWhatItMade) {
  Simple::destroyed = 0;
  const double illegal = 2.0, legal = 1.0;
  weft_value value{"value", WEFT_VALUE_F64, 0, 1, &illegal, {}};
  weft_error error = kNoError;
  void* self = nullptr;
  const weft_create with{sizeof(weft_create), 0, nullptr, &value, 1, nullptr};
  EXPECT_EQ(kSimple.create(&with, &self, &error), WEFT_ERROR);
  EXPECT_EQ(self, nullptr);
  EXPECT_THAT(error.message, HasSubstr("'value' is outside its range"));
  EXPECT_STREQ(error.subject, "value");
  EXPECT_EQ(Simple::destroyed, 1);
  value.data = &legal;
  ASSERT_EQ(kSimple.create(&with, &self, &error), WEFT_OK);
  kSimple.destroy(self);
  EXPECT_EQ(Simple::destroyed, 2);
}

TEST(Component, PreparesWithTemplateAndCamera) {
  FakeHost host;
  weft_error error = kNoError;
  void* self = nullptr;
  const weft_create with{sizeof(weft_create), 0, nullptr, nullptr, 0, nullptr};
  ASSERT_EQ(kSimple.create(&with, &self, &error), WEFT_OK);
  Template templ;
  templ.vertices_m = Array<double>({3, 3}, 0.0);
  templ.flat_px = Array<double>({3, 2}, 0.0);
  templ.faces = Array<std::int32_t>({1, 3}, 0);
  templ.texture = templ.mask = Array<std::uint8_t>({2, 2}, 0);
  const Camera camera;
  const auto prepare = [&] {
    const RecordView<Template> first("template", templ);
    const RecordView<Camera> second("camera", camera);
    const weft_record inputs[] = {first.raw(), second.raw()};
    return kSimple.prepare(self, &host.call, inputs, 2, &error);
  };
  EXPECT_EQ(prepare(), WEFT_OK) << error.message;
  templ.vertices_m = Array<double>({4, 3}, 0.0);
  templ.flat_px = Array<double>({4, 2}, 0.0);
  EXPECT_EQ(prepare(), WEFT_ERROR);
  EXPECT_STREQ(error.message, "wants a triangle");
  kSimple.destroy(self);
}

}  // namespace
}  // namespace weft
