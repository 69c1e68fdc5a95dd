// SPDX-License-Identifier: Apache-2.0
// The same answers however often, in which order and by which threads a component is called.
#include <fmt/format.h>

#include <numeric>
#include <thread>
#include <weft/core/index.hpp>

#include "kit/conformance/check_host_use.hpp"
#include "kit/conformance/groups.hpp"

namespace weft::conformance {
namespace {

constexpr int kAtOnce = 8, kFrames = 6;

void expect_same(Play& play, const std::vector<Answer>& given, const std::vector<Answer>& expected,
                 const char* fix, Page& page) {
  const std::string how = difference(play.subject(), given, expected);
  if (!how.empty()) page.fail(how + "; " + fix);
}

bool has_order(const Play& play) {
  const PipelinePart part = play.subject().rules().part;
  return part == PipelinePart::stage || part == PipelinePart::source;
}

void check_repeated(Play& play, Page& page) {
  Performer performer(play.subject());
  if (!play.begin(performer).is_usable()) return;
  const Answer first = play.frame(performer, 0), second = play.frame(performer, 0);
  expect_same(play, {second}, {first}, "the second call of a frame answers as the first", page);
}

void check_shuffled(Play& play, std::uint64_t seed, Page& page) {
  if (!has_order(play)) return page.skip("its calls have an order");
  std::vector<std::uint64_t> order(kFrames);
  std::iota(order.begin(), order.end(), 0);
  Performer in_turn(play.subject()), shuffled(play.subject());
  if (!play.begin(in_turn).is_usable() || !play.begin(shuffled).is_usable()) return;
  std::vector<Answer> expected, given(order.size());
  for (const std::uint64_t number : order) expected.push_back(play.frame(in_turn, number));
  Rng rng(seed);
  rng.shuffle(order);
  for (const std::uint64_t number : order) given[number] = play.frame(shuffled, number);
  expect_same(play, given, expected,
              "what a frame needs of an earlier one is an input of it, 'previous.*'; keep nothing",
              page);
}

/// Created by one thread, called by another one, destroyed by a third.
void check_any_thread(Play& play, const std::vector<Answer>& expected, Page& page) {
  auto performer = std::make_unique<Performer>(play.subject());
  bool ready = false;
  std::vector<Answer> given;
  const Scene& scene = play.scene();
  std::thread([&] {  // each lives until the end, or the next one could have its id
    ready = static_cast<bool>(performer->begin(scene.templ, scene.camera));
    if (!ready) return;
    std::thread([&] {
      given = play.frames(*performer);
      std::thread([&] { performer.reset(); }).join();
    }).join();
  })
      .join();
  if (!ready) return page.fail("it cannot be created in another thread");
  expect_same(play, given, expected, "keep nothing in thread-local variables", page);
}

void check_at_once(const Setting& setting, const std::vector<Answer>& expected, Page& page) {
  std::vector<std::unique_ptr<Play>> plays;
  for (int i = 0; i < kAtOnce; ++i) {
    auto play = Play::of(setting);
    if (!play) return page.skip("its parameters are refused");
    plays.push_back(*std::move(play));
  }
  std::vector<std::vector<Answer>> given(plays.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < plays.size(); ++i) {
    threads.emplace_back([&, i] { given[i] = plays[i]->whole(); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < plays.size(); ++i) {
    expect_same(*plays[i], given[i], expected,
                "instances share nothing that they write to, or guard it", page);
  }
}

void check_prepared_twice(Play& play, const std::vector<Answer>& expected, Page& page) {
  const PipelinePart part = play.subject().rules().part;
  if (part == PipelinePart::source || part == PipelinePart::templ) {
    return page.skip("it is not prepared");
  }
  Performer performer(play.subject());
  const Scene& scene = play.scene();
  if (!performer.begin(scene.templ, scene.camera)) return;  // reported by another check
  if (const auto again = performer.prepare(scene.templ, scene.camera); !again) {
    return page.fail("the second time, " + again.error().message);
  }
  expect_same(play, play.frames(performer), expected,
              "prepare() puts all that it makes in the place of what was there", page);
}

}  // namespace

void check_calls(const Setting& setting, Notebook& notebook) {
  const auto made = Play::of(setting);
  if (!made) return;  // reported by the check of its parameters
  Play& play = **made;
  Usual usual(play);
  // The first one: it copies this process, which must have one thread.
  notebook.check("calls/exit", [&](Page& page) { check_exit(play, page); });
  notebook.check("calls/repeated", [&](Page& page) { check_repeated(play, page); });
  notebook.check("calls/created_anew", [&](Page& page) {
    expect_same(play, play.whole(), usual.answers(), "keep nothing outside the instance", page);
  });
  notebook.check("calls/shuffled_frames",
                 [&](Page& page) { check_shuffled(play, setting.candidate.seed, page); });
  notebook.check("calls/any_thread",
                 [&](Page& page) { check_any_thread(play, usual.answers(), page); });
  notebook.check("calls/threads", [&](Page& page) {
    expect_same(play, play.whole({.threads = 4}), usual.answers(),
                "add and compare in an order that does not depend on weft_call.threads", page);
  });
  notebook.check("calls/at_once",
                 [&](Page& page) { check_at_once(setting, usual.answers(), page); });
  notebook.check("calls/prepared_twice",
                 [&](Page& page) { check_prepared_twice(play, usual.answers(), page); });
  notebook.check("calls/unprepared", [&](Page& page) {
    Performer performer(play.subject());
    if (const auto created = performer.create(); !created) page.fail(created.error().message);
  });
  notebook.check("calls/structs", [&](Page&) { check_structs(play); });
  notebook.check("calls/log", [&](Page& page) { check_log(play, page); });
  notebook.check("calls/invocations", [&](Page& page) { check_invocations(play, page); });
  notebook.check("calls/sanitized", [&](Page& page) {
    page.skip("data races are seen where plugin and host are built with ThreadSanitizer");
  });
  notebook.check("calls/state", [&](Page& page) {
    page.skip("what an instance keeps cannot be saved in version 1.0 of the contract");
  });
}

}  // namespace weft::conformance
