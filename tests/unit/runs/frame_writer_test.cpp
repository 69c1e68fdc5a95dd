// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/frame_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <future>
#include <stdexcept>
#include <string>

namespace weft {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

FrameOnItsWay numbered(std::uint64_t index) {
  FrameOnItsWay frame{{{index, {}, {}}, {}}, {}};
  frame.result.index = index;
  return frame;
}

/// Events of any thread, in their order.
class Notes {
 public:
  void write(const std::string& note) {
    const std::lock_guard lock(mutex_);
    notes_.push_back(note);
  }
  std::vector<std::string> all() {
    const std::lock_guard lock(mutex_);
    return notes_;
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> notes_;
};

TEST(FrameWriter, WritesFramesInTheirOrderInAThreadOfItsOwn) {
  std::vector<std::uint64_t> written;
  std::thread::id where;
  FrameWriter writer(2, [&](FrameOnItsWay& frame) {
    where = std::this_thread::get_id();
    written.push_back(frame.result.index);
  });
  for (std::uint64_t i = 0; i < 20; ++i) EXPECT_TRUE(writer.put(numbered(i)));
  writer.close();
  std::vector<std::uint64_t> expected(20);
  for (std::uint64_t i = 0; i < 20; ++i) expected[i] = i;
  EXPECT_EQ(written, expected);
  EXPECT_NE(where, std::this_thread::get_id());
}

TEST(FrameWriter, AFrameThatHasRoomDoesNotBlock) {
  std::promise<void> both_put;
  FrameWriter writer(2, [wait = both_put.get_future().share()](FrameOnItsWay&) { wait.wait(); });
  EXPECT_TRUE(writer.put(numbered(0)));
  EXPECT_TRUE(writer.put(numbered(1)));  // returns although frame 0 is not written
  both_put.set_value();
  writer.close();
}

TEST(FrameWriter, AFrameWithoutRoomWaits) {
  Notes notes;
  std::array<std::promise<void>, 3> put;
  FrameWriter writer(1, [&](FrameOnItsWay& frame) {
    put.at(frame.result.index).get_future().wait();
    // Long enough for a `put` that does not wait to be noted first.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    notes.write("written " + std::to_string(frame.result.index));
  });
  for (std::uint64_t i = 0; i < 3; ++i) {
    writer.put(numbered(i));
    notes.write("put " + std::to_string(i));
    if (i < 2) put.at(i).set_value();
  }
  EXPECT_THAT(notes.all(), ElementsAre("put 0", "written 0", "put 1", "written 1", "put 2"));
  put[2].set_value();
  writer.close();
}

TEST(FrameWriter, WhatIsThrownEndsItAndDropsTheFramesBehind) {
  std::vector<std::uint64_t> written;
  FrameWriter writer(2, [&](FrameOnItsWay& frame) {
    if (frame.result.index == 1) throw std::runtime_error("full");
    written.push_back(frame.result.index);
  });
  std::uint64_t index = 0;
  while (index < 1000 && writer.put(numbered(index))) ++index;
  EXPECT_LE(index, 4U) << "frame 1 fails before frames 2 and 3 have made room for frame 4";
  try {
    writer.close();
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& failure) {
    EXPECT_STREQ(failure.what(), "full");
  }
  EXPECT_THAT(written, ElementsAre(0));
  EXPECT_NO_THROW(writer.close());
}

TEST(FrameWriter, NeedsNoFrames) {
  std::vector<std::uint64_t> written;
  FrameWriter writer(0, [&](FrameOnItsWay& frame) { written.push_back(frame.result.index); });
  writer.close();
  EXPECT_THAT(written, IsEmpty());
}

}  // namespace
}  // namespace weft
