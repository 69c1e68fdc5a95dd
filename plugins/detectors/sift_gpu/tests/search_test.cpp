// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <weft/core/index.hpp>

#include "common/tests/keypoints_of.hpp"
#include "common/tests/scenes.hpp"
#include "session.hpp"

namespace weft::sift_gpu {
namespace {

using detectors::texture;
using matchers::l2_keypoints;
using matchers::random_descriptors;
using ::testing::HasSubstr;

/// Descriptors that the test's own event completes, or fails.
class AwaitedDescriptors : public ::testing::Test {
 protected:
  static bool never() { return false; }

  std::shared_ptr<Device> device_ = *Device::open("");
  cl::UserEvent ready_{device_->context()};
  std::shared_ptr<const cl::Buffer> rows_ = std::make_shared<const cl::Buffer>(
      device_->context(), CL_MEM_READ_WRITE, cl::size_type{2 * kDescriptorLength});
  std::shared_ptr<const KeptDescriptors> kept_ =
      std::make_shared<const KeptDescriptors>(device_, rows_, ready_, 2);
  Array<float> array_ = on_device<float>(kept_, {2, kDescriptorLength});
  std::vector<float> places_ = std::vector<float>(4, 0.0F);
};

TEST_F(AwaitedDescriptors, ThatHaveFailedAreAnErrorForTheSearchAndForACopy) {
  ready_.setStatus(CL_OUT_OF_RESOURCES);
  Search search(device_);
  EXPECT_THROW(search.load_queries(array_, true, never), cl::Error);
  std::vector<std::byte> bytes(2 * kDescriptorLength * sizeof(float));
  const auto copied = kept_->download(bytes, never);
  ASSERT_FALSE(copied);
  EXPECT_THAT(copied.error().message, HasSubstr("while copying 2 descriptors from"));
}

TEST_F(AwaitedDescriptors, ThatNeverComeCanBeGivenUpAtOnce) {
  std::vector<std::byte> bytes(2 * kDescriptorLength * sizeof(float));
  const auto start = std::chrono::steady_clock::now();
  const auto copied = kept_->download(bytes, [] { return true; });
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  ASSERT_FALSE(copied);
  EXPECT_EQ(copied.error().code, Errc::cancelled);
  ready_.setStatus(CL_COMPLETE);
}

TEST_F(AwaitedDescriptors, OfAnotherDeviceThatAreLostCostThisDeviceNothing) {
  ready_.setStatus(CL_OUT_OF_RESOURCES);
  device_->retire();
  const auto other = *Device::open("");
  Search search(other);
  EXPECT_THROW(search.load_queries(array_, true, never), OutOfReach);
  EXPECT_FALSE(other->is_retired());
  Rng rng(37);
  const Keypoints here = l2_keypoints(random_descriptors(2, kDescriptorLength, rng));
  search.load_queries(here.descriptors, true, never);
  search.load_trains(here.descriptors, true, never);
  EXPECT_EQ(search.run(places_, {}, never).pairs.at(1).best, 1);
}

/// Descriptors that are kept on the device, where the test changes them without the search. The
/// result then shows whether the search has loaded them again.
class DescriptorsKeptOnTheDevice : public ::testing::Test {
 protected:
  static constexpr int kCount = 40;
  static bool never() { return false; }
  DescriptorsKeptOnTheDevice() {
    std::printf("descriptors from seed %d\n", static_cast<int>(kSeed));
  }

  void write(const Array<std::uint8_t>& rows) {
    cl::CommandQueue(device_->context(), device_->handle())
        .enqueueWriteBuffer(*rows_, CL_TRUE, 0, to_index(rows.size()), rows.data());
  }
  static Array<float> floats(const Array<std::uint8_t>& rows) {
    Array<float> numbers({rows.dim(0), rows.dim(1)}, 0.0F);
    std::copy(rows.data(), rows.data() + rows.size(), numbers.data());
    return numbers;
  }
  /// In `rows`, or lost, depending on `status`.
  static std::shared_ptr<const KeptDescriptors> kept_on(
      const std::shared_ptr<Device>& device, const std::shared_ptr<const cl::Buffer>& rows,
      int count, cl_int status) {
    cl::UserEvent ready(device->context());
    ready.setStatus(status);
    return std::make_shared<const KeptDescriptors>(device, rows, ready, count);
  }
  /// True if its trains, or its queries, are `these`: each finds itself from the other side.
  bool search_has(const Array<std::uint8_t>& these, bool as_trains, bool root) {
    if (as_trains) {
      search_.load_queries(floats(these), root, never);
    } else {
      search_.load_trains(floats(these), root, never);
    }
    const std::vector<Pair> pairs = search_.run(std::vector<float>(2 * kCount), {}, never).pairs;
    EXPECT_EQ(pairs.size(), std::size_t{kCount});
    int same = 0;
    for (int i = 0; i < static_cast<int>(pairs.size()); ++i) {
      const Pair& pair = pairs[to_index(i)];
      same += pair.best == i && pair.best_square < 1e-6F ? 1 : 0;
    }
    EXPECT_TRUE(same == 0 || same == kCount);
    return same == kCount;
  }
  void load(const Array<float>& descriptors, bool as_trains, bool root) {
    if (as_trains) {
      search_.load_trains(descriptors, root, never);
    } else {
      search_.load_queries(descriptors, root, never);
    }
  }

  static constexpr std::uint64_t kSeed = 39;
  Rng rng_{kSeed};
  const Array<std::uint8_t> before_ = matchers::random_bytes(kCount, kDescriptorLength, rng_),
                            after_ = matchers::random_bytes(kCount, kDescriptorLength, rng_);
  std::shared_ptr<Device> device_ = *Device::open("");
  std::shared_ptr<const cl::Buffer> rows_ = std::make_shared<const cl::Buffer>(
      device_->context(), CL_MEM_READ_WRITE, cl::size_type{kCount * kDescriptorLength});
  Array<float> array_ =
      on_device<float>(kept_on(device_, rows_, kCount, CL_COMPLETE), {kCount, kDescriptorLength});
  Search search_{device_};
};

TEST_F(DescriptorsKeptOnTheDevice, AreLoadedOnceAndAgainWhenRootsAreAskedForOrNoLonger) {
  for (const bool as_trains : {true, false}) {
    bool root = true;
    write(before_);
    load(array_, as_trains, root);
    ASSERT_TRUE(search_has(before_, as_trains, root));
    write(after_);
    for (int i = 0; i < 3; ++i) {
      load(array_, as_trains, root);
      EXPECT_TRUE(search_has(before_, as_trains, root)) << as_trains;
    }
    for (const Array<std::uint8_t>* now : {&after_, &before_}) {
      root = !root;
      write(*now);
      load(array_, as_trains, root);
      EXPECT_TRUE(search_has(*now, as_trains, root)) << as_trains;
    }
  }
}

TEST_F(DescriptorsKeptOnTheDevice, AreLoadedAgainAfterOthersReplacedThem) {
  const auto other_device = std::make_shared<Device>(device_->handle());
  const auto unreachable = on_device<float>(
      kept_on(other_device,
              std::make_shared<const cl::Buffer>(other_device->context(), CL_MEM_READ_WRITE, 128),
              1, CL_OUT_OF_RESOURCES),
      {1, kDescriptorLength});
  const auto same_elsewhere =
      on_device<float>(kept_on(device_, rows_, kCount, CL_COMPLETE), {kCount, kDescriptorLength});
  write(before_);
  load(array_, true, true);
  ASSERT_TRUE(search_has(before_, true, true));
  write(after_);
  load(same_elsewhere, true, true);
  EXPECT_TRUE(search_has(after_, true, true)) << "another's are others";
  write(before_);
  load(floats(after_), true, true);
  EXPECT_TRUE(search_has(after_, true, true));
  load(array_, true, true);
  EXPECT_TRUE(search_has(before_, true, true)) << "after some of the host";
  EXPECT_THROW(load(unreachable, true, true), OutOfReach);
  load(array_, true, true);
  EXPECT_TRUE(search_has(before_, true, true)) << "after some that could not be had";
}

TEST(Search, ReadsDescriptorsOfADeviceThatWasGivenUpThroughTheHost) {
  const auto never = [] { return false; };
  const auto before = *Device::open("");
  Session session(before, 160, 120, 1, Settings{});
  const auto spots = session.find(texture(160, 120, 38).pixels, never);
  const auto count = static_cast<std::int64_t>(spots.size());
  const auto rows = on_device<float>(session.describe(spots), {count, kDescriptorLength});
  before->retire();
  const auto after = *Device::open("");
  ASSERT_NE(after, before);

  const std::vector<float> places(2 * spots.size(), 0.0F);
  std::vector<std::vector<Pair>> found;
  for (const auto& device : {before, after}) {
    Search search(device);
    search.load_queries(rows, true, never);
    search.load_trains(rows, true, never);
    found.push_back(search.run(places, {}, never).pairs);
  }
  ASSERT_GT(found[0].size(), 50U);
  for (std::size_t i = 0; i < found[0].size(); ++i) {
    EXPECT_EQ(found[0][i].best_square, 0.0F);
    EXPECT_EQ(found[1][i].best, found[0][i].best);
    EXPECT_EQ(found[1][i].second_square, found[0][i].second_square);
  }
}

}  // namespace
}  // namespace weft::sift_gpu
