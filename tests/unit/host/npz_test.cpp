// SPDX-License-Identifier: Apache-2.0
#include "host/records/npz.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zip.h>

#include <iostream>
#include <weft/core/index.hpp>
#include <weft/data/npy.hpp>

#include "misbehaving/misbehaving.hpp"
#include "unit/data/random_record.hpp"

namespace weft::host {
namespace {

namespace fs = std::filesystem;
using misbehaving::read_file;
using misbehaving::TemporaryFolder;
using misbehaving::write_file;
using ::testing::HasSubstr;
using testing_data::content_of;
using testing_data::random_record;

constexpr std::uint64_t kSeed = 301;

/// One record of every type, by its name.
NamedRecords make_records(std::uint64_t seed) {
  Rng rng(seed);
  NamedRecords records;
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    const std::string type = RecordType::kType;
    records.emplace_back(type.substr(0, type.find('/')),
                         Record::copy_of(random_record<RecordType>(rng)));
  });
  return records;
}

TEST(Npz, EveryRecordTypeSurvivesTheFile) {
  std::cout << "seeds from " << kSeed << "\n";
  const TemporaryFolder folder;
  for (std::uint64_t round = 0; round < 10; ++round) {
    const NamedRecords written = make_records(kSeed + round);
    ASSERT_TRUE(write_npz(folder / "frame.npz", written));
    const auto read = read_npz(folder / "frame.npz");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), written.size());
    for (std::size_t i = 0; i < written.size(); ++i) {
      EXPECT_EQ((*read)[i].first, written[i].first);
      EXPECT_EQ((*read)[i].second->type(), written[i].second->type());
      EXPECT_EQ(content_of((*read)[i].second->view("")), content_of(written[i].second->view("")));
    }
  }
}

TEST(Npz, ArraysOfThirdPartiesSurviveTheFile) {
  const TemporaryFolder folder;
  Camera camera;
  Array<std::uint16_t> weight({1, 2, 1, 1, 3, 1});
  for (std::int64_t i = 0; i < 6; ++i) weight.data()[i] = static_cast<std::uint16_t>(65530 + i);
  camera.others.set("x.acme.weight", weight);
  ASSERT_TRUE(write_npz(folder / "camera.npz", {{"camera", Record::copy_of(camera)}}));
  const auto read = read_npz(folder / "camera.npz");
  ASSERT_TRUE(read) << read.error().message;
  const auto typed = view_as<Camera>(*read->front().second);
  ASSERT_TRUE(typed);
  const auto* kept = typed->others.find<std::uint16_t>("x.acme.weight");
  ASSERT_NE(kept, nullptr);
  EXPECT_EQ(kept->shape(), weight.shape());
  EXPECT_TRUE(std::equal(kept->data(), kept->data() + 6, weight.data()));
}

TEST(Npz, EqualRecordsGiveEqualBytes) {
  std::cout << "seed " << kSeed << "\n";
  const TemporaryFolder folder;
  ASSERT_TRUE(write_npz(folder / "one.npz", make_records(kSeed)));
  ASSERT_TRUE(write_npz(folder / "two.npz", make_records(kSeed)));
  ASSERT_TRUE(write_npz(folder / "other.npz", make_records(kSeed + 1)));
  EXPECT_EQ(read_file(folder / "one.npz"), read_file(folder / "two.npz"));
  EXPECT_NE(read_file(folder / "one.npz"), read_file(folder / "other.npz"));
}

TEST(Npz, SlotsMayHaveDots) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_npz(folder / "x.npz", {{"previous.shape", Record::copy_of(Time{2.5})}}));
  const auto read = read_npz(folder / "x.npz");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 1U);
  EXPECT_EQ((*read)[0].first, "previous.shape");
  EXPECT_EQ(view_as<Time>(*(*read)[0].second)->t_s, 2.5);
}

TEST(Npz, MembersAreInNumpysFormat) {
  const TemporaryFolder folder;
  KnownPoints points;
  points.vertex = Array<std::int32_t>({2}, 0);
  points.points_m = Array<double>({2, 3}, 0.0);
  points.radius_m = Array<double>({2}, 0.0);
  ASSERT_TRUE(write_npz(folder / "x.npz", {{"known_points", Record::copy_of(points)},
                                           {"time", Record::copy_of(Time{1.0})}}));
  const std::string file = read_file(folder / "x.npz");
  const auto header_of = [&](const std::string& member) {
    const std::size_t name = file.find(member + ".npy");
    EXPECT_NE(name, std::string::npos);
    const std::size_t magic = file.find(std::string("\x93NUMPY\x01\x00", 8), name);
    const auto length = to_index(static_cast<unsigned char>(file[magic + 8]) +
                                 256 * static_cast<unsigned char>(file[magic + 9]));
    EXPECT_EQ((10 + length) % 64, 0U);
    EXPECT_EQ(file[magic + 9 + length], '\n');
    return file.substr(magic + 10, length);
  };
  EXPECT_THAT(header_of("known_points/vertex"),
              HasSubstr("{'descr': '<i4', 'fortran_order': False, 'shape': (2,), }"));
  EXPECT_THAT(header_of("known_points/points_m"),
              HasSubstr("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }"));
  EXPECT_THAT(header_of("time/t_s"),
              HasSubstr("{'descr': '<f8', 'fortran_order': False, 'shape': (), }"));
  EXPECT_THAT(header_of("time/record_type"), HasSubstr("'|u1'"));
}

TEST(Npz, TheFileAppearsWholeAndLeavesNothingElseButWhatWasThere) {
  const TemporaryFolder folder;
  write_file(folder / "x.npz.part", "a file of the user");
  ASSERT_TRUE(write_npz(folder / "x.npz", {{"time", Record::copy_of(Time{1.0})}}));
  ASSERT_TRUE(write_npz(folder / "x.npz", {{"time", Record::copy_of(Time{2.0})}}));
  const auto entries = std::distance(fs::directory_iterator(folder.path()), {});
  EXPECT_EQ(entries, 2);
  EXPECT_EQ(read_file(folder / "x.npz.part"), "a file of the user");
  EXPECT_EQ(view_as<Time>(*read_npz(folder / "x.npz")->at(0).second)->t_s, 2.0);
}

TEST(Npz, AFolderThatIsNotThereIsAnErrorWithItsPlace) {
  const auto written = write_npz("/nowhere/at/all/x.npz", {{"time", Record::copy_of(Time{1.0})}});
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Errc::io);
  EXPECT_THAT(written.error().where, HasSubstr("/nowhere/at/all/x.npz"));
  const auto read = read_npz("/nowhere/at/all/x.npz");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().where, "/nowhere/at/all/x.npz");
}

TEST(Npz, NothingCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_npz(folder / "x.npz", {}).error().code, Errc::invalid_value);
}

TEST(Npz, WhatIsNoNpzFileIsAnError) {
  const TemporaryFolder folder;
  for (const std::string& content : {std::string(), std::string("text"), std::string(1000, '\0')}) {
    write_file(folder / "x.npz", content);
    const auto read = read_npz(folder / "x.npz");
    EXPECT_TRUE(!read || read->empty());
  }
}

TEST(Npz, OneChangedByteOfAnArrayIsNoticed) {
  const TemporaryFolder folder;
  Region region;
  region.mask = Array<std::uint8_t>({20, 20}, 0);
  std::fill_n(region.mask.data(), 400, std::uint8_t{'m'});
  ASSERT_TRUE(write_npz(folder / "x.npz", {{"region", Record::copy_of(region)}}));
  std::string file = read_file(folder / "x.npz");
  const std::size_t at = file.find(std::string(400, 'm'));
  ASSERT_NE(at, std::string::npos);
  file[at + 123] = 'n';
  write_file(folder / "x.npz", file);
  const auto read = read_npz(folder / "x.npz");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("damaged at the member 'region/mask.npy'"));
}

TEST(Npz, ARecordThatTheCatalogueForbidsIsNotRead) {
  const TemporaryFolder folder;
  const auto record = Record::copy_of(Time{1.0});
  *static_cast<double*>(record->view("").arrays[0].data) = std::nan("");
  ASSERT_TRUE(write_npz(folder / "x.npz", {{"time", record}}));
  const auto read = read_npz(folder / "x.npz");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message, "slot 'time': time/1: array 't_s' holds NaN or infinity");
  EXPECT_TRUE(read_npz(folder / "x.npz", NpzCheck::none));
  ASSERT_TRUE(write_npz(folder / "x.npz", {{"x", std::make_shared<Record>("surprise/1")}}));
  EXPECT_THAT(read_npz(folder / "x.npz").error().message, HasSubstr("surprise/1"));
}

TEST(Npz, DamageAnywhereIsAnErrorOrHarmless) {
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const TemporaryFolder folder;
  ASSERT_TRUE(write_npz(folder / "x.npz", make_records(kSeed)));
  const std::string whole = read_file(folder / "x.npz");
  int errors = 0;
  for (int round = 0; round < 600; ++round) {
    std::string file = whole;
    const auto size = static_cast<std::uint32_t>(file.size());
    for (std::uint32_t i = 0; i < 1 + rng.below(3); ++i) {
      file[rng.below(size)] = static_cast<char>(rng.below(256));
    }
    if (round % 5 == 0) file.resize(rng.below(size));
    write_file(folder / "x.npz", file);
    const auto read = read_npz(folder / "x.npz");
    if (!read) {
      ++errors;
      continue;
    }
    for (const auto& [slot, record] : *read) EXPECT_TRUE(validate(record->view("")));
  }
  EXPECT_GT(errors, 300);
}

/// A deflated archive of these members, as another program may write it.
void zip(const std::string& file, const std::vector<std::pair<std::string, std::string>>& members) {
  int code = 0;
  zip_t* archive = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code);
  ASSERT_NE(archive, nullptr);
  for (const auto& [name, bytes] : members) {
    zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    ASSERT_GE(zip_file_add(archive, name.c_str(), source, 0), 0);
  }
  ASSERT_EQ(zip_close(archive), 0);
}

TEST(Npz, AnArchiveThatHoldsFarMoreThanItsSizeIsNotRead) {
  const TemporaryFolder folder;
  const std::string file = folder / "bomb.npz";
  zip(file, {{"image/pixels.npy", std::string(std::size_t{80} << 20U, '\0')}});
  const auto read = read_npz(file);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("far more than its size"));
  EXPECT_EQ(read.error().where, file);
}

TEST(Npz, APipeIsNotWaitedFor) {
  const TemporaryFolder folder;
  const std::string file = folder / "pipe.npz";
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_EQ(read_npz(file).error().message, "is no regular file");
  EXPECT_EQ(read_npz(folder / "absent.npz").error().message, "there is no such file");
}

TEST(Npz, AShapeWhoseStridesOverflowIsNoArray) {
  std::string header =
      "{'descr': '<f8', 'fortran_order': False, 'shape': (0, 4611686018427387904, "
      "4611686018427387904), }";
  header.resize(118, ' ');
  const std::string bytes =
      std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(118) + '\0' + header;
  EXPECT_FALSE(parse_npy(bytes));
}

}  // namespace
}  // namespace weft::host
