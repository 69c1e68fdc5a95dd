// SPDX-License-Identifier: Apache-2.0
#include <new>

#include "live_fixture.hpp"

namespace weft::live {
namespace {

using ::testing::HasSubstr;

std::string request_text(std::uint64_t number, const std::string& text) {
  return json{{"type", "change_request"}, {"number", number}, {"text", text}}.dump();
}

class LiveChangeRequests : public LiveServer {
 protected:
  /// Waits for `count` requests; a run takes requests repeatedly.
  std::vector<ChangeRequest> taken(std::size_t count) {
    std::vector<ChangeRequest> all;
    wait_until([&] {
      for (ChangeRequest& request : run_channel_.take_change_requests())
        all.push_back(std::move(request));
      return all.size() >= count;
    });
    return all;
  }
};

TEST_F(LiveChangeRequests, ReachTheRunAndAreAnsweredToTheirClient) {
  start();
  Viewer one(port_), other(port_);
  one.text();
  other.text();
  one.say(request_text(7, "set filters.alpha_s=0.2"));
  const std::vector<ChangeRequest> first = taken(1);
  other.say(request_text(7, "stop"));
  const std::vector<ChangeRequest> second = taken(1);
  ASSERT_EQ(first.size(), 1U);
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(first[0].text, "set filters.alpha_s=0.2");
  EXPECT_EQ(second[0].text, "stop");
  EXPECT_NE(first[0].number, second[0].number);
  run_channel_.answer({second[0].number, 12, ""});
  run_channel_.answer({first[0].number, 0, "there is no stage 'filters'"});
  const json refused = one.text(), granted = other.text();
  EXPECT_EQ(refused, json::parse(R"({"type":"answer","number":7,"frame":0,
                                     "refusal":"there is no stage 'filters'"})"));
  EXPECT_EQ(granted, json::parse(R"({"type":"answer","number":7,"frame":12,"refusal":""})"));
}

TEST_F(LiveChangeRequests, ThatPauseTheRunAreReportedToAllClients) {
  const auto decide = [this](Viewer& viewer, const std::string& text, std::uint64_t frame,
                             const std::string& refusal = "") {
    viewer.say(request_text(1, text));
    run_channel_.answer({taken(1).at(0).number, frame, refusal});
    EXPECT_EQ(viewer.text()["type"], "answer");
  };
  start();
  Viewer one(port_), other(port_);
  one.text();
  other.text();
  decide(one, "pause", 4, "nobody may");
  decide(one, "pause", 5);
  const json paused = json::parse(R"({"type":"pause","paused":true,"frame":5})");
  EXPECT_EQ(one.text(), paused);
  EXPECT_EQ(other.text(), paused);
  Viewer late(port_);
  EXPECT_EQ(late.text()["type"], "hello");
  EXPECT_EQ(late.text(), paused);
  decide(other, "resume", 6);
  const json goes_on = json::parse(R"({"type":"pause","paused":false,"frame":6})");
  for (Viewer* viewer : {&one, &other, &late}) EXPECT_EQ(viewer->text(), goes_on);
}

TEST_F(LiveChangeRequests, ForAPauseEndWhenTheLastClientThatMadeOneHasLeft) {
  start();
  Viewer watching(port_);
  watching.text();
  auto one = std::make_unique<Viewer>(port_), other = std::make_unique<Viewer>(port_);
  one->say(request_text(1, "pause"));
  EXPECT_EQ(taken(1).at(0).text, "pause");
  other->say(request_text(1, "step"));
  EXPECT_EQ(taken(1).at(0).text, "step");
  one.reset();
  wait_until([&] { return run_channel_.viewers() == 2; });
  EXPECT_TRUE(run_channel_.take_change_requests().empty())
      << "the other one has paused the run too";
  other.reset();
  const ChangeRequest resume = taken(1).at(0);
  EXPECT_EQ(resume.text, "resume");
  run_channel_.answer({resume.number, 8, ""});
  EXPECT_EQ(watching.text(),
            json::parse(R"({"type":"pause","paused":false,"frame":8,"left":true})"));
  // From then on nothing is paused, and a client that leaves resumes nothing.
  watching.say(request_text(1, "pause"));
  watching.say(request_text(2, "resume"));
  EXPECT_EQ(taken(2).size(), 2U);
  Viewer last(port_);
  watching.connection().close();
  wait_until([&] { return run_channel_.viewers() == 1; });
  EXPECT_TRUE(run_channel_.take_change_requests().empty());
}

TEST_F(LiveChangeRequests, ForAPauseEndWithAClientThatVanishes) {
  Limits limits = patient();
  limits.silence = std::chrono::milliseconds(100);
  start("", "", limits);
  Viewer vanished(port_);  // it answers no ping, and its connection stays
  vanished.say(request_text(1, "pause"));
  const std::vector<ChangeRequest> requests = taken(2);
  EXPECT_EQ(requests.at(0).text, "pause");
  EXPECT_EQ(requests.at(1).text, "resume");
}

TEST(LiveRunChannel, KeepsThePauseOfAClientThatCameAfterAnotherHadLeft) {
  RunChannel run_channel;
  ASSERT_EQ(run_channel.ask(1, 1, "pause"), "");
  EXPECT_EQ(run_channel.take_change_requests().size(), 1U);
  run_channel.leave(1);
  ASSERT_EQ(run_channel.ask(2, 1, "pause"), "");
  const std::vector<ChangeRequest> requests = run_channel.take_change_requests();
  ASSERT_EQ(requests.size(), 1U) << "the run would resume behind it";
  EXPECT_EQ(requests[0].text, "pause");
  run_channel.leave(2);
  EXPECT_EQ(run_channel.take_change_requests().size(), 1U);
  EXPECT_TRUE(run_channel.take_change_requests().empty());
}

TEST_F(LiveChangeRequests, BeyondThoseThatMayWaitAreRefusedAtOnce) {
  start();
  Viewer viewer(port_);
  viewer.text();
  for (std::uint64_t number = 0; number < 66; ++number) viewer.say(request_text(number, "step"));
  for (const std::uint64_t number : {64U, 65U}) {
    const json answer = viewer.text();
    EXPECT_EQ(answer["number"], number);
    EXPECT_THAT(answer["refusal"].get<std::string>(), HasSubstr("64 change requests wait already"));
  }
  EXPECT_EQ(taken(64).size(), 64U);
  viewer.say(request_text(66, "step"));
  EXPECT_EQ(taken(1).size(), 1U);
}

TEST_F(LiveChangeRequests, OfClosedClientsAreNotAnswered) {
  start();
  {
    Viewer viewer(port_);
    viewer.text();
    viewer.say(request_text(1, "pause"));
    wait_until([&] {
      const auto requests = run_channel_.take_change_requests();
      for (const ChangeRequest& request : requests) run_channel_.answer({request.number, 0, ""});
      return !requests.empty();
    });
  }
  run_channel_.answer({999, 0, ""});  // that no client requested
  Viewer viewer(port_);
  EXPECT_EQ(viewer.text()["type"], "hello");
}

TEST_F(LiveChangeRequests, BeyondThoseThatMayLackAnAnswerAreRefusedAtOnce) {
  for (std::uint64_t number = 0; number < 256; ++number) {
    ASSERT_EQ(run_channel_.ask(1, number, "set a.b=1"), "");
    ASSERT_EQ(run_channel_.take_change_requests().size(), 1U);
  }
  EXPECT_THAT(run_channel_.ask(1, 256, "set a.b=1"),
              HasSubstr("256 change requests have no answer yet"));
  EXPECT_TRUE(run_channel_.take_change_requests().empty());
  run_channel_.answer({1, 0, ""});
  EXPECT_EQ(run_channel_.take().answers.size(), 1U);
  EXPECT_EQ(run_channel_.ask(1, 257, "set a.b=1"), "");
}

TEST(LiveRunChannel, WakesTheServerAgainWhereThatFailed) {
  RunChannel run_channel;
  int woken = 0;
  run_channel.attach([&woken] {
    if (++woken == 1) throw std::bad_alloc();
  });
  EXPECT_THROW(run_channel.put_settings("{}"), std::bad_alloc);
  run_channel.put_settings("{}");
  EXPECT_EQ(woken, 2);
  run_channel.put_settings("{}");
  EXPECT_EQ(woken, 2) << "it has not looked yet";
}

TEST_F(LiveChangeRequests, AreNotReadFromWhoDoesNotReadTheAnswers) {
  Hub hub({AccessPolicy(asio::ip::address_v4::loopback(), "", "")}, run_channel_);
  const auto protocol = speak_live(hub, 1);
  for (std::uint64_t number = 0; number < 64 + 64; ++number) {
    EXPECT_TRUE(protocol->takes_more()) << number;
    ASSERT_EQ(protocol->receive(request_text(number, "step"), true), "");
  }
  EXPECT_FALSE(protocol->takes_more());
  EXPECT_THAT(*protocol->next()->body, HasSubstr("hello"));
  EXPECT_FALSE(protocol->takes_more());
  EXPECT_THAT(*protocol->next()->body, HasSubstr("\"number\":64"));
  EXPECT_TRUE(protocol->takes_more());
}

}  // namespace
}  // namespace weft::live
