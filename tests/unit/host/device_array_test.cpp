// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstring>
#include <limits>
#include <map>
#include <weft/data/keypoints.hpp>
#include <weft/sdk/device.hpp>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

using ::testing::HasSubstr;

/// Numbers that a library stores by handle, with their reference counts.
struct Kept {
  std::vector<float> numbers;
  int references = 0;
  int downloads = 0;
  std::int32_t status = WEFT_OK;
};
std::map<std::uint64_t, Kept>& all_kept() {
  static std::map<std::uint64_t, Kept> kept;
  return kept;
}

constexpr weft_device_memory kLibrary{
    sizeof(weft_device_memory), 0, [](std::uint64_t handle) { ++all_kept()[handle].references; },
    [](std::uint64_t handle) { --all_kept()[handle].references; },
    [](const weft_call*, std::uint64_t handle, void* to, std::uint64_t bytes,
       weft_error* error) -> std::int32_t {
      Kept& kept = all_kept()[handle];
      ++kept.downloads;
      if (kept.status != WEFT_OK) {
        return report({Errc::io, "the cable is out", {}}, error), kept.status;
      }
      std::memcpy(to, kept.numbers.data(), bytes);
      return WEFT_OK;
    }};
constexpr weft_device_memory kOther = kLibrary;

class DeviceArrays : public ::testing::Test {
 protected:
  DeviceArrays() {
    all_kept().clear();
    all_kept()[7].numbers = {1, 2, 3, 4, 5, 6};
    Keypoints points;
    points.xy_px = Array<double>({2, 2}, 0.0);
    points.scale_px = points.angle_rad = points.response = Array<double>({2}, 0.0);
    points.octave = Array<std::int32_t>({2}, 0);
    points.metric = "l2";
    record_ = Record::copy_of(points);
  }

  bool adopt(std::uint64_t handle = 7) {
    const std::int64_t shape[] = {2, 3};
    return record_->adopt("descriptors", WEFT_F32, 2, shape, kLibrary, handle, "detectors/a");
  }
  static const Kept& kept() { return all_kept()[7]; }

  std::shared_ptr<Record> record_;
  weft_call call_{};
};

TEST_F(DeviceArrays, LiveAsLongAsTheirRecord) {
  ASSERT_TRUE(adopt());
  EXPECT_EQ(kept().references, 1);
  auto copy = record_->alias();
  record_.reset();
  EXPECT_EQ(kept().references, 1);
  copy.reset();
  EXPECT_EQ(kept().references, 0);
}

TEST_F(DeviceArrays, AreReplacedByAnArrayOfTheSameName) {
  ASSERT_TRUE(adopt());
  const std::int64_t shape[] = {2, 3};
  ASSERT_NE(record_->allocate("descriptors", WEFT_F32, 2, shape), nullptr);
  EXPECT_EQ(kept().references, 1) << "its maker may use it until its call returns";
  record_->forget_replaced();
  EXPECT_EQ(kept().references, 0);
  EXPECT_FALSE(view_as<Keypoints>(*record_)->descriptors.is_on_device());
}

TEST_F(DeviceArrays, WithoutAHandleOrALegalShapeAreRefused) {
  EXPECT_FALSE(adopt(0));
  const std::int64_t shape[] = {2, -3};
  EXPECT_FALSE(record_->adopt("descriptors", WEFT_F32, 2, shape, kLibrary, 7, "detectors/a"));
  EXPECT_EQ(kept().references, 0);
}

/// A library whose functions throw.
constexpr weft_device_memory kThrowing{
    sizeof(weft_device_memory), 0,
    [](std::uint64_t handle) {
      if (handle == 8) throw std::runtime_error("no more references");
    },
    [](std::uint64_t) { throw std::runtime_error("released twice"); },
    [](const weft_call*, std::uint64_t, void*, std::uint64_t, weft_error*) -> std::int32_t {
      throw std::runtime_error("the cable broke");
    }};

TEST_F(DeviceArrays, OfALibraryThatThrowsAreErrorsOfTheirMakerAndEndNoProcess) {
  const std::int64_t shape[] = {2, 3};
  EXPECT_ANY_THROW(
      record_->adopt("descriptors", WEFT_F32, 2, shape, kThrowing, 8, "detectors/thrower"));
  ASSERT_TRUE(record_->adopt("descriptors", WEFT_F32, 2, shape, kThrowing, 9, "detectors/thrower"));
  const auto copy = record_->in_host_memory();
  ASSERT_FALSE(copy);
  EXPECT_EQ(copy.error().where, "detectors/thrower");
  EXPECT_THAT(copy.error().message, ::testing::HasSubstr("the cable broke"));
  record_.reset();  // an exception that left release() would end this process
}

TEST_F(DeviceArrays, HaveAShapeAndNoElementsForWhoReadsTheRecord) {
  ASSERT_TRUE(adopt());
  EXPECT_TRUE(validate(record_->view("")));
  const auto points = view_as<Keypoints>(*record_);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_TRUE(points->descriptors.present());
  EXPECT_TRUE(points->descriptors.is_on_device());
  EXPECT_EQ(points->descriptors.rows(), 2);
  EXPECT_EQ(points->descriptors.dim(1), 3);
  EXPECT_EQ(points->descriptors.data(), nullptr);
  const RecordView<Keypoints> again("keypoints", *points);
  const weft_array* array = find_array(again.raw(), "descriptors");
  EXPECT_EQ(array->memory, WEFT_DEVICE);
  EXPECT_EQ(array->handle, 7U);
  EXPECT_EQ(array->data, find_array(record_->view(""), "descriptors")->data);
}

TEST_F(DeviceArrays, ArraysOfThirdPartiesGoWithTheCopyOfARecord) {
  ASSERT_TRUE(adopt());
  const std::int64_t shape[] = {2};
  auto* weight =
      static_cast<std::uint16_t*>(record_->allocate("x.acme.weight", WEFT_U16, 1, shape));
  weight[0] = 65535;
  weight[1] = 7;
  const auto here = record_->in_host_memory();
  ASSERT_TRUE(here) << here.error().message;
  const weft_record view = record_->view("keypoints");
  ReachableInputs reachable;
  const auto reached = reachable.reach({&view, 1}, &kOther, call_);
  ASSERT_TRUE(reached) << reached.error().message;
  for (const weft_record& record : {(*here)->view("keypoints"), reached->front()}) {
    const auto points = read_record<Keypoints>(record);
    ASSERT_TRUE(points) << points.error().message;
    EXPECT_FALSE(points->descriptors.is_on_device());
    const auto* copied = points->others.find<std::uint16_t>("x.acme.weight");
    ASSERT_NE(copied, nullptr);
    EXPECT_EQ((*copied)(0), 65535);
    EXPECT_EQ((*copied)(1), 7);
  }
}

TEST_F(DeviceArrays, ComeHereOnceForAllWhoCannotReadThere) {
  ASSERT_TRUE(adopt());
  const weft_record inputs[] = {record_->view("keypoints")};
  for (const std::uint64_t fetched : {24U, 0U}) {
    ReachableInputs reachable;
    const auto reached = reachable.reach(inputs, &kOther, call_);
    ASSERT_TRUE(reached) << reached.error().message;
    EXPECT_EQ(reachable.downloaded_bytes(), fetched);
    const auto points = read_record<Keypoints>((*reached)[0]);
    ASSERT_TRUE(points);
    EXPECT_EQ(points->descriptors(1, 2), 6.0F);
  }
  const auto here = record_->in_host_memory();
  ASSERT_TRUE(here);
  EXPECT_EQ(view_as<Keypoints>(**here)->descriptors(0, 1), 2.0F);
  EXPECT_EQ(kept().downloads, 1);
}

TEST_F(DeviceArrays, StayWhereTheyAreForTheirOwnLibrary) {
  ASSERT_TRUE(adopt());
  const weft_record inputs[] = {record_->view("keypoints")};
  ReachableInputs reachable;
  const auto reached = reachable.reach(inputs, &kLibrary, call_);
  ASSERT_TRUE(reached);
  EXPECT_EQ(reached->data(), inputs);
  EXPECT_EQ(kept().downloads, 0);
}

TEST_F(DeviceArrays, ThatCannotBeFetchedAreErrorsOfTheirMaker) {
  ASSERT_TRUE(adopt());
  all_kept()[7].status = WEFT_ERROR;
  const auto lost = record_->in_host_memory();
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().where, "detectors/a");
  EXPECT_THAT(lost.error().message, HasSubstr("its array 'descriptors', which lies on a device, "
                                              "cannot be copied: the cable is out"));
  all_kept()[7].status = WEFT_CANCELLED;
  EXPECT_EQ(record_->in_host_memory().error().code, Errc::cancelled);
  all_kept()[7].status = WEFT_OK;
  EXPECT_TRUE(record_->in_host_memory()) << "a failure is not kept";
}

TEST_F(DeviceArrays, AreCheckedOnceTheyAreHere) {
  ASSERT_TRUE(adopt());
  all_kept()[7].numbers[4] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(validate(record_->view("")));
  const auto here = record_->in_host_memory();
  ASSERT_FALSE(here);
  EXPECT_EQ(here.error().where, "detectors/a");
  EXPECT_THAT(here.error().message, HasSubstr("holds NaN or infinity"));
  ReachableInputs reachable;
  const weft_record inputs[] = {record_->view("keypoints")};
  EXPECT_FALSE(reachable.reach(inputs, &kOther, call_)) << "nobody is given them";
}

TEST_F(DeviceArrays, ThatAreInNoCatalogueAreIllegal) {
  const std::int64_t shape[] = {6};
  for (const char* name : {"diag.residual", "extra"}) {
    Record record(record_->type());
    const weft_record all = record_->view("");
    for (std::uint64_t i = 0; i < all.count; ++i) record.share(*record_, all.arrays[i].name);
    ASSERT_TRUE(record.adopt(name, WEFT_F32, 1, shape, kLibrary, 7, "detectors/a"));
    const auto valid = validate(record.view(""));
    ASSERT_FALSE(valid) << name;
    EXPECT_THAT(valid.error().message,
                HasSubstr("is not in the catalogue, but lies in device memory"));
  }
}

/// A class from which the SDK makes a table of device memory.
struct Rows {
  int* destroyed;
  ~Rows() { ++*destroyed; }
  Result<void> download(std::span<std::byte> to, const std::function<bool()>& cancelled) const {
    if (cancelled()) return Error{Errc::cancelled, "told to stop"};
    std::fill(to.begin(), to.end(), std::byte{0});
    if (to.size() > 100) throw std::runtime_error("too much");
    return {};
  }
};

TEST(OnDevice, KeepsTheContentsUntilTheLastReferenceIsGone) {
  int destroyed = 0;
  const auto& table = kDeviceMemory<Rows>;
  auto array = on_device<float>(std::make_shared<const Rows>(Rows{&destroyed}), {2, 3});
  destroyed = 0;  // the temporary
  EXPECT_NE(device_contents<Rows>(array), nullptr);
  EXPECT_EQ(device_contents<Rows>(Array<float>({2, 3}, 0.0F)), nullptr);
  const std::uint64_t handle = array.handle();
  table.retain(handle);
  array = {};
  EXPECT_EQ(destroyed, 0);
  table.release(handle);
  EXPECT_EQ(destroyed, 1);
}

TEST(OnDevice, LetsNoExceptionAcross) {
  int destroyed = 0;
  const auto array = on_device<float>(std::make_shared<const Rows>(Rows{&destroyed}), {2, 3});
  std::vector<float> to(100);
  weft_error error = kNoError;
  const auto download = [&](std::uint64_t bytes) {
    return kDeviceMemory<Rows>.download(nullptr, array.handle(), to.data(), bytes, &error);
  };
  EXPECT_EQ(download(24), WEFT_OK);
  EXPECT_EQ(download(400), WEFT_ERROR);
  EXPECT_STREQ(error.message, "threw: too much");
}

}  // namespace
}  // namespace weft::host
