// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <weft/testing/mistakes.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "live_fixture.hpp"

namespace weft::live {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::input;
using ::testing::IsEmpty;
using testing::PluginAnswer;
using testing::PluginUnderTest;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;

/// The sink as a run has it.
class LiveSink : public ::testing::Test {
 protected:
  LiveSink() {
    asio::io_context context;
    const tcp::acceptor taken(context, {asio::ip::address_v4::loopback(), 0});
    port_ = taken.local_endpoint().port();
    shape_.vertices_m = Array<double>({4, 3}, 0.5);
    shape_.source = Array<std::uint8_t>({4}, 1);
    image_.pixels = Array<std::uint8_t>({30, 40, 3}, 120);
    report_.json = R"({"frame":0,"state":"estimated"})";
    settings_.json = R"({"stages":[]})";
    visibility_.visible = Array<std::uint8_t>({4}, 1);
    visibility_.score = Array<double>({4}, 1.0);
    visibility_.reason = Array<std::uint8_t>({4}, 0);
  }

  std::string params() const { return "{address: '127.0.0.1:" + std::to_string(port_) + "'}"; }

  PluginAnswer open(PluginUnderTest& sink) const {
    EXPECT_TRUE(sink.prepare(templ_, testing::make_camera()));
    return sink.process(kOpen, {});
  }

  PluginAnswer write(PluginUnderTest& sink, std::uint64_t frame) const {
    const PluginAnswer answer =
        sink.process(kWrite,
                     {input("image", image_), input("shape", shape_), input("time", Time{1.5}),
                      input("visibility", visibility_), input("frame_report", report_),
                      input("run_settings", settings_)},
                     frame);
    sink.forget();
    return answer;
  }

  std::uint16_t port_ = 0;
  Template templ_ = testing::make_template({2, 2, 0.2, 0.15, 40, 30});
  Shape shape_;
  Image image_;
  FrameReport report_;
  RunSettings settings_;
  Visibility visibility_;
};

TEST_F(LiveSink, ShowsFramesToWhoIsThere) {
  PluginUnderTest sink("sinks/live", params());
  ASSERT_EQ(open(sink).status, WEFT_OK);
  ASSERT_EQ(write(sink, 0).status, WEFT_OK);
  Viewer viewer(port_);
  ASSERT_TRUE(viewer.is_open());
  const json hello = viewer.text();
  EXPECT_TRUE(hello["settings"]["stages"].is_array());
  viewer.ready();
  ASSERT_EQ(write(sink, 1).status, WEFT_OK);
  const Decoded decoded = viewer.frame();
  EXPECT_EQ(decoded.head["frame"], 1);
  EXPECT_EQ(decoded.head["time_s"], 1.5);
  EXPECT_EQ(decoded.head["written"], 1);
  EXPECT_EQ(decoded.head["report"]["state"], "estimated");
  EXPECT_EQ(decoded.parts.at("image").substr(0, 3), "\xFF\xD8\xFF");
  EXPECT_EQ(decoded.parts.at("vertices_m").size(), 48U);
  EXPECT_EQ(decoded.parts.at("visible").size(), 4U);
  settings_.revision = 5;
  settings_.json = R"({"stages":[{"stage":"filters"}]})";
  ASSERT_EQ(write(sink, 2).status, WEFT_OK);
  EXPECT_EQ(viewer.text()["settings"]["stages"][0]["stage"], "filters");
  // A later client can compare them with those of the beginning.
  Viewer later(port_);
  const json greeting = later.text();
  EXPECT_EQ(greeting["settings"]["stages"].size(), 1U);
  EXPECT_EQ(greeting["started_with"]["stages"].size(), 0U);
  EXPECT_EQ(sink.process(kFinish, {}).status, WEFT_OK);
}

TEST_F(LiveSink, ShowsFramesOfWhichLittleIsKnown) {
  PluginUnderTest sink("sinks/live", params());
  ASSERT_EQ(open(sink).status, WEFT_OK);
  Viewer viewer(port_);
  viewer.text();
  viewer.ready();
  ASSERT_EQ(sink.process(kWrite, {}, 6).status, WEFT_OK);
  const Decoded decoded = viewer.frame();
  EXPECT_EQ(decoded.head["frame"], 6);
  EXPECT_TRUE(decoded.head["report"].is_null());
  EXPECT_TRUE(decoded.parts.empty());
}

TEST_F(LiveSink, CountsTheTimesOfFoxgloveFromItsOpeningOn) {
  PluginUnderTest sink("sinks/live", params());
  ASSERT_EQ(open(sink).status, WEFT_OK);
  Viewer viewer(port_, kFoxgloveProtocol);
  viewer.text();
  viewer.text();
  viewer.say(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":4}]})");
  viewer.say(R"({"op":"fetchAsset"})");
  EXPECT_EQ(viewer.text()["op"], "status") << "what was said before has been read";
  const auto latest_ns = static_cast<std::uint64_t>(std::chrono::nanoseconds(kPatience).count());
  std::uint64_t before_ns = 0;
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    ASSERT_EQ(write(sink, frame).status, WEFT_OK);
    const std::string bytes = viewer.read().bytes;
    ASSERT_GT(bytes.size(), 13U);
    std::uint64_t time_ns = 0;
    std::memcpy(&time_ns, bytes.data() + 5, sizeof time_ns);
    EXPECT_GT(time_ns, before_ns);
    EXPECT_LT(time_ns, latest_ns) << "it is no time of day";
    before_ns = time_ns;
  }
}

TEST_F(LiveSink, FindsThePortTakenByOneRunOnly) {
  PluginUnderTest first("sinks/live", params());
  ASSERT_EQ(open(first).status, WEFT_OK);
  PluginUnderTest second("sinks/live", params());
  const PluginAnswer refused = open(second);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, HasSubstr("another program has this port, choose another"));
  EXPECT_EQ(status_of(answer_to(port_, request_for("/", port_))), "200");
  ASSERT_EQ(first.process(kFinish, {}).status, WEFT_OK);
  PluginUnderTest later("sinks/live", params());
  EXPECT_EQ(open(later).status, WEFT_OK);
  EXPECT_EQ(status_of(answer_to(port_, request_for("/", port_))), "200");
}

TEST_F(LiveSink, SendsTheShapeOfAnotherStageBesideThatOfTheFrame) {
  PluginUnderTest sink("sinks/live", params());
  ASSERT_EQ(open(sink).status, WEFT_OK);
  Viewer viewer(port_);
  viewer.text();
  viewer.ready();
  Shape other = shape_;
  other.vertices_m = Array<double>({4, 3}, 0.75);
  const auto written =
      sink.process(kWrite, {input("shape", shape_), input("other_shape", other)}, 0);
  ASSERT_EQ(written.status, WEFT_OK) << written.message;
  const Decoded decoded = viewer.frame();
  const auto first_of = [&](const char* part) {
    float number = 0;
    std::memcpy(&number, decoded.parts.at(part).data(), sizeof(number));
    return number;
  };
  EXPECT_EQ(decoded.parts.at("other_m").size(), 48U);
  EXPECT_EQ(first_of("vertices_m"), 0.5F);
  EXPECT_EQ(first_of("other_m"), 0.75F);
  other.vertices_m = Array<double>({3, 3}, 0.75);
  other.source = Array<std::uint8_t>({3}, 0);
  EXPECT_THAT(sink.process(kWrite, {input("other_shape", other)}, 1).message,
              HasSubstr("3 vertices, the template 4"));
}

TEST_F(LiveSink, RefusesAShapeThatIsNoShapeOfThisTemplate) {
  PluginUnderTest sink("sinks/live", params());
  ASSERT_EQ(open(sink).status, WEFT_OK);
  shape_.vertices_m = Array<double>({2, 3}, 0.5);
  shape_.source = Array<std::uint8_t>({2}, 0);
  EXPECT_THAT(write(sink, 0).message, HasSubstr("2 vertices, the template 4"));
}

TEST_F(LiveSink, NamesWhatIsWrongWithItsParametersBeforeAnythingRuns) {
  const auto mistakes = [](const std::string& params) {
    return testing::mistakes_of("sinks/live", params);
  };
  EXPECT_THAT(mistakes("{}"), IsEmpty());
  EXPECT_THAT(mistakes("{address: 'localhost:0', token: 0123456789abcdef}"), IsEmpty());
  EXPECT_THAT(mistakes("{address: somewhere}"),
              ElementsAre(HasSubstr("address: 'somewhere' has no port")));
  EXPECT_THAT(mistakes("{address: 'robot.local:80'}"),
              ElementsAre(HasSubstr("write 127.0.0.1:8090")));
  EXPECT_THAT(mistakes("{address: '0.0.0.0:8090'}"), ElementsAre(HasSubstr("a token is needed")));
  EXPECT_THAT(mistakes("{token: short}"), ElementsAre(HasSubstr("at least 16 characters")));
  EXPECT_THAT(mistakes("{origin: nowhere}"), ElementsAre(HasSubstr("origin: the origin must be")));
}

TEST_F(LiveSink, RefusesWhenItRunsWhatItRefusesBefore) {
  PluginUnderTest sink("sinks/live", "{address: '0.0.0.0:0'}");
  const PluginAnswer refused = open(sink);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, HasSubstr("a token is needed"));
  // From a block that is reserved for documentation: no machine has it.
  PluginUnderTest elsewhere("sinks/live", "{address: '192.0.2.1:0', token: 0123456789abcdef}");
  EXPECT_THAT(open(elsewhere).message, HasSubstr("choose one that it has"));
}

}  // namespace
}  // namespace weft::live
