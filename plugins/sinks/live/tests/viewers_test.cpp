// SPDX-License-Identifier: Apache-2.0
#include "live_fixture.hpp"

namespace weft::live {
namespace {

using ::testing::HasSubstr;

using LiveViewers = LiveServer;

TEST_F(LiveViewers, AreGreetedAndThenGetFramesWhenTheyAreReady) {
  start();
  Viewer viewer(port_);
  ASSERT_TRUE(viewer.is_open());
  EXPECT_EQ(viewer.response()[http::field::sec_websocket_protocol], "weft.live.1");
  const json hello = viewer.text();
  EXPECT_EQ(hello["type"], "hello");
  EXPECT_EQ(hello["camera"]["width_px"], 640);
  EXPECT_TRUE(hello["settings"].is_null());
  for (std::uint64_t number = 0; number < 5; ++number) {
    run_channel_.put_frame(frame(number));
    viewer.ready();
    const Decoded decoded = viewer.frame();
    EXPECT_EQ(decoded.head["frame"], number);
    EXPECT_EQ(decoded.head["time_s"], 0.25 * static_cast<double>(number));
    EXPECT_EQ(decoded.head["report"]["frame"], number);
    EXPECT_EQ(decoded.parts.at("image").substr(0, 3), "\xFF\xD8\xFF");
    EXPECT_EQ(decoded.parts.at("vertices_m").size(), 4U * 12U);
    EXPECT_EQ(decoded.parts.at("visible"), std::string("\x01\x01\x00\x01", 4));
  }
}

TEST_F(LiveViewers, AreNotifiedWhenFramesStopAndWhenTheyContinue) {
  Limits limits;
  limits.still = std::chrono::milliseconds(50);
  start("", "", limits);
  Viewer viewer(port_);
  viewer.text();
  EXPECT_EQ(viewer.text(), json::parse(R"({"type":"still","still":true})"));
  Viewer late(port_);
  EXPECT_EQ(late.text()["type"], "hello");
  EXPECT_EQ(late.text(), json::parse(R"({"type":"still","still":true})"));
  run_channel_.put_frame(frame(1));
  EXPECT_EQ(viewer.text(), json::parse(R"({"type":"still","still":false})"));
}

TEST_F(LiveViewers, WaitForTheNextFrameWhereTheyHaveHadTheNewest) {
  start();
  Viewer viewer(port_);
  viewer.text();
  viewer.ready();
  run_channel_.put_frame(frame(1));
  EXPECT_EQ(viewer.frame().head["frame"], 1);
  viewer.ready();
  viewer.ready();  // two have the effect of one
  let_server_read(viewer);
  run_channel_.put_frame(frame(2));
  EXPECT_EQ(viewer.frame().head["frame"], 2);
  run_channel_.put_frame(frame(3));
  run_channel_.put_settings("{}");
  EXPECT_EQ(viewer.text()["type"], "settings") << "and no frame that it is not ready for";
}

TEST_F(LiveViewers, GetTheNewestFrameAfterAPause) {
  start();
  Viewer viewer(port_), late(port_);
  viewer.text();
  for (std::uint64_t number = 0; number < 50; ++number) run_channel_.put_frame(frame(number));
  viewer.ready();
  EXPECT_EQ(viewer.frame().head["frame"], 49);
  late.text();
  late.ready();
  EXPECT_EQ(late.frame().head["frame"], 49);
}

TEST_F(LiveViewers, WhoComeLaterAreNotShownAFrameThatHasPassed) {
  start();
  {
    Viewer first(port_);
    first.text();
    run_channel_.put_frame(frame(1));
    first.ready();
    EXPECT_EQ(first.frame().head["frame"], 1);
  }
  wait_until([&] { return !run_channel_.is_watched(); });
  Viewer next(port_);  // the run pauses: its newest frame is still that one
  next.text();
  next.ready();
  EXPECT_EQ(next.frame().head["frame"], 1);
  run_channel_.pass_frame();
  Viewer later(port_);
  later.text();
  later.ready();
  let_server_read(later);
  run_channel_.put_frame(frame(9));
  EXPECT_EQ(later.frame().head["frame"], 9);
}

TEST_F(LiveViewers, GetFramesWithoutAShapeAndWithoutAnImageToo) {
  start();
  Viewer viewer(port_);
  viewer.text();
  FrameCopy lost;
  lost.frame = 3;
  lost.report = R"({"state":"none"})";
  viewer.ready();
  run_channel_.put_frame(lost);
  const Decoded decoded = viewer.frame();
  EXPECT_EQ(decoded.head["report"]["state"], "none");
  EXPECT_TRUE(decoded.parts.empty());
}

TEST_F(LiveViewers, ReceiveTheSettingsAtFirstAndWhenTheyChange) {
  start();
  Viewer first(port_);
  EXPECT_TRUE(first.text()["settings"].is_null());
  run_channel_.put_settings(R"({"a":1})");
  EXPECT_EQ(first.text()["settings"]["a"], 1);
  Viewer second(port_);
  EXPECT_EQ(second.text()["settings"]["a"], 1);
  run_channel_.put_settings(R"({"a":2})");
  for (Viewer* viewer : {&first, &second}) {
    const json received = viewer->text();
    EXPECT_EQ(received["type"], "settings");
    EXPECT_EQ(received["settings"]["a"], 2);
  }
}

TEST_F(LiveViewers, ThatSendAnInvalidMessageAreClosedWithTheReason) {
  start();
  for (const auto& [message, why] :
       {std::pair("hello", "no JSON object"), std::pair(R"({"type":"go"})", "another type")}) {
    Viewer viewer(port_);
    viewer.text();
    viewer.say(message);
    viewer.read();
    EXPECT_EQ(viewer.error(), websocket::error::closed);
    EXPECT_EQ(viewer.close_code(), websocket::close_code::policy_error);
    EXPECT_THAT(viewer.reason(), HasSubstr(why));
  }
  Viewer viewer(port_);
  viewer.text();
  viewer.say("bytes", false);
  viewer.read();
  EXPECT_THAT(viewer.reason(), HasSubstr("no text"));
}

TEST_F(LiveViewers, ThatSayTooMuchAtOnceAreClosed) {
  start();
  Viewer viewer(port_);
  viewer.text();
  viewer.say(std::string(64 * 1024 + 1, ' '));
  viewer.read();
  EXPECT_TRUE(viewer.error());
  EXPECT_EQ(viewer.close_code(), websocket::close_code::too_big);
  EXPECT_TRUE(Viewer(port_).is_open()) << "others are served as before";
}

TEST_F(LiveViewers, WhoseBytesAreNoWebSocketAreClosed) {
  start();
  const std::string mask(4, '\0');
  for (const std::string& bytes : {"\x83\x80" + mask, std::string("\x01\x05hello"),
                                   "\xF1\x80" + mask, "\x81\xFF" + std::string(8, '\xFF') + mask}) {
    Viewer viewer(port_);
    viewer.text();
    asio::write(viewer.connection(), asio::buffer(bytes));
    viewer.read();
    EXPECT_TRUE(viewer.error());
  }
  wait_until([&] { return !run_channel_.is_watched(); });
}

TEST_F(LiveViewers, MustNameAProtocol) {
  start();
  const Viewer none(port_, "");
  EXPECT_FALSE(none.is_open());
  EXPECT_EQ(none.response().result(), http::status::bad_request);
  EXPECT_FALSE(Viewer(port_, "chat, weft.live.0").is_open());
  EXPECT_TRUE(Viewer(port_, "chat, weft.live.1").is_open());
}

TEST_F(LiveViewers, ReceiveTheLastFrameAndTheEndOfTheRun) {
  start();
  Viewer viewer(port_);
  viewer.text();
  viewer.ready();
  let_server_read(viewer);
  run_channel_.put_frame(frame(8));
  server_->finish();
  server_.reset();
  EXPECT_EQ(viewer.frame().head["frame"], 8);
  viewer.read();
  EXPECT_EQ(viewer.close_code(), websocket::close_code::going_away);
  EXPECT_EQ(viewer.reason(), "the run has ended");
}

TEST_F(LiveViewers, AreWorthCopyingFramesForWhileTheyAreThere) {
  start();
  EXPECT_FALSE(run_channel_.is_watched());
  {
    Viewer viewer(port_);
    viewer.text();
    EXPECT_TRUE(run_channel_.is_watched());
  }
  wait_until([&] { return !run_channel_.is_watched(); });
}

}  // namespace
}  // namespace weft::live
